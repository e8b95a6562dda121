# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Who solves the blocks: threads of this process, or the workers of a dask cluster that is there already."""

import importlib
import itertools
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from fairlead.config import UsageError
from fairlead.study.block import Result, Task, finish, prepare, run_block
from fairlead.study.settings import Setting

Block = tuple[Setting, tuple[int, ...]]
"""A setting and the runs to do of it."""

_IN_FLIGHT = 3
"""Blocks that each thread of the cluster has waiting, so that none is idle."""


def with_threads(task: Task, blocks: Sequence[Block], threads: int) -> Iterator[Result]:
    """In order. The core's threads share a block while one of Python draws the next and asks OpenCV."""
    if not blocks:
        return
    with ThreadPoolExecutor(max_workers=1) as pool:
        ahead = pool.submit(prepare, task, *blocks[0])
        for following in (*blocks[1:], None):
            prepared = ahead.result()
            if following is not None:
                ahead = pool.submit(prepare, task, *following)
            yield finish(task, prepared, threads)


def with_dask(task: Task, blocks: Sequence[Block], scheduler: str) -> Iterator[Result]:
    """As they are done, by the cluster whose scheduler is at this address; each worker needs fairlead.

    Raises UsageError if dask is not installed or nobody answers.
    """
    distributed = _distributed()
    try:
        client = distributed.Client(scheduler, timeout="5s")
    except OSError as error:
        raise UsageError(f"--scheduler: no dask scheduler answers at {scheduler} ({error})") from error
    with client:
        shared = client.scatter(task, broadcast=True)
        room = _IN_FLIGHT * max(sum(client.nthreads().values()), 1)
        waiting = iter(blocks)
        futures = [client.submit(run_block, shared, *block, pure=False) for block in itertools.islice(waiting, room)]
        done = distributed.as_completed(futures)
        for future in done:
            result = future.result()
            future.release()
            for block in waiting:
                done.add(client.submit(run_block, shared, *block, pure=False))
                break
            yield result


def _distributed() -> Any:
    try:
        return importlib.import_module("distributed")
    except ImportError as error:
        raise UsageError("--backend dask: needs the extra dask, pip install 'fairlead[dask]'") from error
