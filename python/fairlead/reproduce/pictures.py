# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""One image of a sequence."""

import numpy as np

from fairlead.io.errors import InputError
from fairlead.reproduce.measured import PAIRED_NS
from fairlead.reproduce.sequences import Sequence
from fairlead.sources.opening import open_images


def picture_of(sequence: Sequence, stamp_ns: int) -> np.ndarray:
    """(h, w, 3) red, green, blue of a moment: from its folder or its clip. Raises InputError where there is none."""
    if sequence.images is None:
        raise InputError(sequence.folder, "the sequence has no images")
    for image in open_images(sequence.images, sequence.camera, fps=None, topic=None):
        if abs(image.stamp_ns - stamp_ns) <= PAIRED_NS:
            return np.ascontiguousarray(image.image[..., ::-1])
    raise InputError(sequence.images, f"has no image with the stamp {stamp_ns}")
