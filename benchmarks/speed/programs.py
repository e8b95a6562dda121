# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The C++ programs of the benchmark: built on the spot, asked line by line (serve.hpp)."""

import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.speed.problem import WindowProblem
from benchmarks.speed.solver import Answer, Settings

HERE = Path(__file__).resolve().parent
BUILD = HERE.parents[1] / "build" / "speed"
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}


class BuildError(RuntimeError):
    """A program could not be built; says which and why."""


def _cmake(*arguments: str | Path, log: Path) -> bool:
    """Run cmake, the environment's own if there is one; its output goes to the log."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    command = [shutil.which("cmake", path=path) or "cmake", *map(str, arguments)]
    with log.open("a", encoding="utf-8") as out:
        return (
            subprocess.run(command, stdout=out, stderr=out, env={**os.environ, "PATH": path}, check=False).returncode
            == 0
        )


def build(name: str, source: Path, *options: str, jobs: int = 1) -> Path:
    """Configure and build a folder of programs under build/speed/NAME, or bring it up to date."""
    folder = BUILD / name
    folder.mkdir(parents=True, exist_ok=True)
    log = folder / "build.log"
    log.unlink(missing_ok=True)
    if not _cmake("-S", source, "-B", folder, "-DCMAKE_BUILD_TYPE=Release", *options, log=log):
        raise BuildError(f"{name}: cmake refused, see {log}")
    if not _cmake("--build", folder, "--parallel", str(jobs), log=log):
        raise BuildError(f"{name}: compiler refused, see {log}")
    return folder


def build_core(*, native: bool, jobs: int = 1) -> Path:
    """The core and its two timing programs, portable or for this machine's instruction set."""
    prefix = Path(sysconfig.get_path("purelib")) / "cmeel.prefix"
    options = (f"-DCMAKE_PREFIX_PATH={prefix}", f"-DFAIRLEAD_NATIVE={'ON' if native else 'OFF'}")
    return build("native" if native else "portable", HERE, *options, jobs=jobs)


def build_ceres(jobs: int = 1) -> Path | None:
    """The Ceres program; None where Ceres is not installed."""
    try:
        return build("ceres", HERE / "ceres", jobs=jobs)
    except BuildError:
        if "Ceres is not installed" in (BUILD / "ceres" / "build.log").read_text(encoding="utf-8"):
            return None
        raise


class Program:
    """A solver in a process of its own, one thread."""

    def __init__(self, path: Path) -> None:
        self._process = subprocess.Popen(
            [path],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            bufsize=1,
            env={**os.environ, **ONE_THREAD},
        )
        self._folder = tempfile.TemporaryDirectory()

    def _ask(self, line: str) -> str:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(line + "\n")
        self._process.stdin.flush()
        answer = self._process.stdout.readline().strip()
        if not answer:
            raise RuntimeError(f"{self._process.args}: no answer to {line!r}")
        return answer

    def prepare(self, problem: WindowProblem) -> None:
        self._shape = (problem.landmarks, problem.views)
        path = Path(self._folder.name) / "problem.bin"
        problem.write(path)
        self._ask(f"problem {path}")

    def solve(self, settings: Settings, seconds: float) -> tuple[float, int]:
        s = settings
        words = self._ask(f"solve {s.variant} {s.max_iterations} {s.damping!r} {s.tolerance!r} {seconds!r}").split()
        return float(words[1]), int(words[2])

    def answer(self) -> Answer:
        n, k = self._shape
        path = Path(self._folder.name) / "answer.bin"
        self._ask(f"write {path}")
        values = np.fromfile(path, dtype="<f8")
        poses = values[3 * n :].reshape(k, 12)
        T = np.tile(np.eye(4), (k, 1, 1))
        T[:, :3, :3], T[:, :3, 3] = poses[:, :9].reshape(k, 3, 3), poses[:, 9:]
        return Answer(X=values[: 3 * n].reshape(n, 3), T=T)

    def close(self) -> None:
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait(timeout=60)
        self._folder.cleanup()
