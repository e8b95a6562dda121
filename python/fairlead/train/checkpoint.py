# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What `fairlead train` has written, read again."""

from pathlib import Path
from typing import Any

import torch

from fairlead.io.errors import InputError
from fairlead.train.lesson import Lesson


def read_checkpoint(path: Path) -> dict[str, Any]:
    """What train has written: weights and what network they belong to; nothing in it is executed. Raises InputError."""
    try:
        found = torch.load(path, map_location="cpu", weights_only=True)
        if not isinstance(found, dict) or not {"state_dict", "hyper_parameters"} <= found.keys():
            raise InputError(path, "expected a checkpoint of `fairlead train`")
        return found
    except InputError:
        raise
    except Exception as error:  # a damaged archive fails in many ways
        raise InputError(path, f"expected a checkpoint of `fairlead train`, got {type(error).__name__}") from error


def load_lesson(path: Path) -> Lesson:
    """The network of a checkpoint, for use: averaged weights, nothing is learned. Raises InputError."""
    found = read_checkpoint(path)
    try:
        lesson = Lesson(**found["hyper_parameters"])
        lesson.load_state_dict(found["state_dict"])
    except (TypeError, RuntimeError, ValueError, KeyError) as error:
        raise InputError(path, f"expected a checkpoint of `fairlead train`: {error}") from error
    return lesson.eval()
