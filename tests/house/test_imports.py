# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Which folder may use which, where import-linter and CMake cannot see it; what `import fairlead` costs."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

CPP_LAYERS = ["geometry", "robust", "dense", "pnp", "window", "motion", "tracker"]
CORE_DOORS = {"tracker", "pnp.py", "baselines/free_window.py", "study/methods.py", "study/recorded.py", "__init__.py"}


def layer(name: str) -> int:
    """Position in CPP_LAYERS of a folder; a file at the top belongs to the facade, the highest layer."""
    return CPP_LAYERS.index(name) if name in CPP_LAYERS else len(CPP_LAYERS) - 1


def forbidden_includes(text: str, folder: str) -> list[str]:
    """Headers of this project that a file of this folder must not include."""
    headers = re.findall(r'#include [<"]fairlead/([^">]+)[">]', text)
    return [h for h in headers if layer(h.split("/")[0] if "/" in h else "tracker") > layer(folder)]


def folder_of(source: Path, root: Path) -> str:
    parts = source.relative_to(root).parts
    return parts[0] if len(parts) > 1 else "tracker"


@pytest.mark.parametrize("tree", ["cpp/include/fairlead", "cpp/src", "cpp/tests"])
def test_a_folder_includes_what_its_target_links(tree: str, project_files: list[Path], repository: Path) -> None:
    root = repository / tree
    found = {
        str(f.relative_to(repository)): forbidden_includes(f.read_text(encoding="utf-8"), folder_of(f, root))
        for f in project_files
        if f.is_relative_to(root) and f.suffix in {".cpp", ".hpp"}
    }
    assert found, "no C++ sources: the test looks in the wrong place"
    assert {name: headers for name, headers in found.items() if headers} == {}


def test_a_forbidden_include_is_found() -> None:
    text = '#include "fairlead/pnp/p3p.hpp"\n#include <fairlead/tracker.hpp>\n'
    assert forbidden_includes(text, "robust") == ["pnp/p3p.hpp", "tracker.hpp"]
    assert forbidden_includes(text, "pnp") == ["tracker.hpp"]
    assert forbidden_includes(text, "tracker") == []


def test_the_core_needs_nothing_but_std_and_eigen(project_files: list[Path], repository: Path) -> None:
    allowed = re.compile(r"^(Eigen/|[a-z_0-9]+$)")
    found: list[str] = []
    for f in project_files:
        if f.suffix in {".cpp", ".hpp"} and f.relative_to(repository).parts[:2] in {("cpp", "include"), ("cpp", "src")}:
            headers = re.findall(r"#include <([^>]+)>", f.read_text(encoding="utf-8"))
            found += [f"{f.relative_to(repository)}: {h}" for h in headers if not allowed.match(h)]
    assert found == []


def test_the_core_does_no_input_or_output(code: list[Path], repository: Path) -> None:
    forbidden = re.compile(r"#include <(iostream|fstream|cstdio|print|chrono|random|thread)>|\bgetenv\b|\bstd::exit\b")
    core = [f for f in code if f.relative_to(repository).parts[:2] in {("cpp", "include"), ("cpp", "src")}]
    core = [f for f in core if f.parent != repository / "cpp" / "src" / "study"]  # many estimators, in threads
    assert [str(f.relative_to(repository)) for f in core if forbidden.search(f.read_text(encoding="utf-8"))] == []


def imports_core(text: str) -> bool:
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import) and any(a.name.startswith("fairlead._core") for a in node.names):
            return True
        if isinstance(node, ast.ImportFrom):
            inside = node.module == "fairlead" and any(a.name == "_core" for a in node.names)
            if inside or (node.module or "").startswith("fairlead._core"):
                return True
    return False


def test_the_core_is_private(project_files: list[Path], repository: Path) -> None:
    package = repository / "python" / "fairlead"
    users = [f.relative_to(package) for f in project_files if f.is_relative_to(package) and f.suffix == ".py"]
    users = [f for f in users if imports_core((package / f).read_text(encoding="utf-8"))]
    assert [str(f) for f in users if not {f.as_posix(), f.parts[0]} & CORE_DOORS] == []


def test_an_import_of_the_core_is_found() -> None:
    assert imports_core("from fairlead import _core")
    assert imports_core("import fairlead._core as c")
    assert not imports_core("from fairlead import tracker")


def test_the_oracle_shares_no_code_with_the_core(project_files: list[Path], repository: Path) -> None:
    forbidden = re.compile(
        r"^\s*(?:from|import) fairlead(?:\._core|\.tracker|\.geometry|\.cameras| import)", re.MULTILINE
    )
    oracle = [f for f in project_files if f.is_relative_to(repository / "reference") and f.suffix == ".py"]
    assert oracle
    assert [f.name for f in oracle if forbidden.search(f.read_text(encoding="utf-8"))] == []


def test_import_is_silent_and_light() -> None:
    heavy = "{'cv2', 'matplotlib', 'torch', 'pyarrow', 'scipy', 'trimesh', 'tyro', 'rich', 'jinja2'}"
    program = f"import sys, fairlead, fairlead.types; print(sorted({heavy} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-W", "error", "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
    assert done.stderr == ""


def test_help_needs_no_heavy_module() -> None:
    program = (
        "import sys, contextlib, io\nfrom fairlead.cli import main\n"
        "with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit): main(['--help'])\n"
        "print(sorted({'cv2', 'matplotlib', 'torch', 'pyarrow', 'scipy', 'trimesh'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
