# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The command line: arguments in, exit status out. 0 done, 1 coverage too low, 2 bad input; 130, 143 interrupted."""

import errno
import signal
import sys
from collections.abc import Sequence
from types import FrameType
from typing import Annotated

import tyro
from tyro.conf import subcommand

from fairlead.config import Config, DemoConfig, EvaluateConfig, RefineConfig, TrackConfig, UsageError
from fairlead.io.errors import InputError, one_line

_DESCRIPTION = "Monocular 6D pose of a rigid target whose 3D model is only roughly known."

_Command = (
    Annotated[DemoConfig, subcommand("demo")]
    | Annotated[TrackConfig, subcommand("track")]
    | Annotated[RefineConfig, subcommand("refine")]
    | Annotated[EvaluateConfig, subcommand("evaluate")]
)


class Stopped(KeyboardInterrupt):
    """A signal asked for an end."""

    def __init__(self, number: int) -> None:
        self.number = number
        super().__init__(signal.Signals(number).name)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit status."""
    before = {number: signal.signal(number, _stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        config: Config = tyro.cli(_Command, prog="fairlead", description=_DESCRIPTION, args=arguments)
        return _run(config)
    except (InputError, UsageError) as error:
        return _complain(str(error), 2)
    except OSError as error:
        if error.errno is None:
            raise
        place = f"{error.filename}: " if error.filename else ""
        full = " (what was written stays readable)" if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG) else ""
        return _complain(f"{place}{error.strerror}{full}", 2)
    except Stopped as stop:
        return _complain("stopped; what was written stays readable", 128 + stop.number)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _stop(number: int, frame: FrameType | None) -> None:
    """Raise once; closing the files is not to be disturbed."""
    del frame
    for each in (signal.SIGINT, signal.SIGTERM):
        signal.signal(each, signal.SIG_IGN)
    raise Stopped(number)


def _complain(message: str, status: int) -> int:
    sys.stderr.write(f"fairlead: {one_line(message)}\n")
    return status


def _run(config: Config) -> int:
    from fairlead import run
    from fairlead.progress import progress_bar

    if isinstance(config, DemoConfig):
        from fairlead.demo import demo

        demo(config)
        return 0
    if isinstance(config, EvaluateConfig):
        sys.stdout.write(f"{run.evaluate(config)}\n")
        return 0
    verb = run.track(config, progress_bar) if isinstance(config, TrackConfig) else run.refine(config, progress_bar)
    counts = f"{verb.frames} frames, {verb.frames_with_pose} with a pose ({verb.coverage:.1%})"
    sys.stdout.write(f"{verb.output}: {counts}\n")
    if verb.coverage < config.min_coverage:
        return _complain(f"coverage {verb.coverage:.1%} is below --min-coverage {config.min_coverage:.1%}", 1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
