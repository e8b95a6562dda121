# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Progress of long work: a bar with rate and time left on a terminal, nothing elsewhere."""

import sys
from collections.abc import Callable, Generator
from contextlib import AbstractContextManager, contextmanager
from typing import Protocol, runtime_checkable


@runtime_checkable
class Progress(Protocol):
    """Is told how much work was done."""

    def __call__(self, amount: int) -> None:
        """`amount` more units are done."""
        ...


ProgressFactory = Callable[[str, Callable[[], int | None]], AbstractContextManager[Progress]]


def _ignore(amount: int) -> None:
    del amount


@contextmanager
def silent(title: str, count: Callable[[], int | None]) -> Generator[Progress]:
    """Tells nobody."""
    del title, count
    yield _ignore


@contextmanager
def progress_bar(title: str, count: Callable[[], int | None]) -> Generator[Progress]:
    """A bar on stderr if that is a terminal; `count` gives the amount of work, None if unknown."""
    if not sys.stderr.isatty():
        with silent(title, count) as advance:
            yield advance
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (TextColumn(title), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[rate]}"))
    with Bar(*columns, TimeElapsedColumn(), TimeRemainingColumn(), console=Console(stderr=True)) as bar:
        task = bar.add_task(title, total=count(), rate="")

        def advance_bar(amount: int) -> None:
            speed = bar.tasks[0].speed
            bar.update(task, advance=amount, rate="" if speed is None else f"{speed:.0f}/s")

        yield advance_bar
