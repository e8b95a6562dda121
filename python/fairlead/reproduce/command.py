# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""`fairlead reproduce`: one experiment after the other, each section written as soon as it is done."""

import platform
from dataclasses import dataclass
from pathlib import Path

import fairlead
from fairlead.config import ReproduceConfig, UsageError
from fairlead.io.run_record import git_commit
from fairlead.progress import ProgressFactory, silent
from fairlead.reproduce.context import Context
from fairlead.reproduce.experiments import EXPERIMENTS
from fairlead.reproduce.writing import Made, read_sections, write_pages, write_section


@dataclass(frozen=True, kw_only=True)
class ReproduceSummary:
    """What was done."""

    html: Path
    markdown: Path
    made: tuple[str, ...]
    """Names of the sections that were made this time."""
    missing: tuple[str, ...]
    """What they could not do, a line each."""


def reproduce(config: ReproduceConfig, progress: ProgressFactory = silent) -> ReproduceSummary:
    """Make the chosen sections, then the report of all that the folder holds.

    May be stopped and started again: detections and runs are kept, sections that are there stay. Raises InputError or
    UsageError for what cannot be used.
    """
    unknown = [name for name in config.only if name not in EXPERIMENTS]
    if unknown:
        raise UsageError(f"--only: expected some of {', '.join(EXPERIMENTS)}, got {unknown[0]!r}")
    chosen = [name for name in EXPERIMENTS if not config.only or name in config.only]
    context = Context(config=config, progress=progress)
    config.output.mkdir(parents=True, exist_ok=True)
    made = Made(commit=git_commit(), version=fairlead.__version__, machine=machine(), quick=config.quick)
    missing: list[str] = []
    for name in chosen:
        section = EXPERIMENTS[name](context)
        write_section(config.output, section, made)
        missing += [f"{name}: {line}" for line in section.missing]
    html, markdown = write_pages(config.output, read_sections(config.output, tuple(EXPERIMENTS)))
    return ReproduceSummary(html=html, markdown=markdown, made=tuple(chosen), missing=tuple(missing))


def machine() -> str:
    """The processor, as its maker calls it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return f"{names[0]}, {len(names)} cores" if names else platform.machine()
