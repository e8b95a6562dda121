# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One image of a sequence."""

import numpy as np

from fairlead.io.errors import InputError
from fairlead.reproduce.sequences import Sequence


def picture_of(sequence: Sequence, frame: int) -> np.ndarray:
    """(h, w, 3) red, green, blue of a frame. Raises InputError where there is none."""
    from fairlead.opencv import read_image

    path = sequence.folder / "rgb" / f"{frame:06d}.png"
    if not path.is_file():
        raise InputError(path, "the sequence has no image of this frame")
    return np.ascontiguousarray(read_image(path)[..., ::-1])
