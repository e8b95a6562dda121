# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""PyYAML's safe loader for calibration files: OpenCV's matrices are understood, tricks are not."""

import importlib
import re
from typing import Any

import numpy as np

yaml: Any = importlib.import_module("yaml")  # PyYAML carries no types

MAX_NESTING = 32
"""Deepest nesting of a YAML document."""


class YamlProblem(ValueError):
    """What is wrong, and the line where the parser knows it."""

    def __init__(self, message: str, line: int | None = None) -> None:
        self.line = line
        super().__init__(message)


def parse_yaml(text: str) -> object:
    """The document as plain lists, dicts, numbers, texts and (OpenCV) float64 arrays. Raises YamlProblem."""
    if text.startswith("%YAML:"):  # OpenCV's header is no valid YAML directive
        text = "#" + text
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        raise YamlProblem(error.problem or error.context, None if mark is None else mark.line + 1) from error
    except (
        *(yaml.YAMLError, RecursionError, ValueError, OverflowError),
        *(TypeError, AttributeError, KeyError, IndexError),
    ) as error:  # PyYAML's constructors let these through
        raise YamlProblem(str(error)) from error


def _problem(message: str, mark: Any) -> Exception:
    return yaml.constructor.ConstructorError(None, None, message, mark)


class _Loader(yaml.SafeLoader):
    """SafeLoader that refuses aliases, deep nesting and a key that comes twice."""

    _depth = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        event = self.peek_event()
        if isinstance(event, yaml.AliasEvent):
            raise _problem("aliases are not allowed here", event.start_mark)
        self._depth += 1
        if self._depth > MAX_NESTING:
            raise _problem(f"nested deeper than {MAX_NESTING}", event.start_mark)
        node: Any = yaml.SafeLoader.compose_node(self, parent, index)
        self._depth -= 1
        return node

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:  # noqa: FBT001, FBT002 - PyYAML's signature
        seen: set[str] = set()
        for key, _ in node.value if isinstance(node, yaml.MappingNode) else ():
            if isinstance(key.value, str) and key.value in seen:
                raise _problem(f"key {key.value!r} comes twice", key.start_mark)
            seen.add(str(key.value))
        return yaml.SafeLoader.construct_mapping(self, node, deep)


def _opencv_matrix(loader: Any, node: Any) -> np.ndarray:
    """OpenCV's matrix {rows, cols, dt, data} or {sizes, dt, data} as float64, reshaped."""
    if not isinstance(node, yaml.MappingNode):
        raise _problem("expected an OpenCV matrix", node.start_mark)
    fields = loader.construct_mapping(node, deep=True)
    try:
        shape = tuple(int(size) for size in fields.get("sizes", (fields.get("rows"), fields.get("cols"))))
        return np.array([float(value) for value in fields["data"]], dtype=np.float64).reshape(shape)
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise _problem(f"malformed OpenCV matrix: {error}", node.start_mark) from error


# YAML 1.1 takes 1e-3 for text, because it has no point; calibration files mean a number
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float", re.compile(r"[-+]?[0-9]+(\.[0-9]*)?[eE][-+]?[0-9]+$"), list("-+0123456789")
)
for _tag in ("opencv-matrix", "opencv-nd-matrix"):
    _Loader.add_constructor(f"tag:yaml.org,2002:{_tag}", _opencv_matrix)
