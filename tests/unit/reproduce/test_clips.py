# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What comes along is enough: pictures out of a clip, and what the network's card says of its errors."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from fairlead.io.errors import InputError
from fairlead.io.shipped import shipped_data
from fairlead.progress import silent
from fairlead.reproduce import detections
from fairlead.reproduce.detections import Network, detect
from fairlead.reproduce.pictures import picture_of
from fairlead.reproduce.sequences import Sequence, load_sequence
from fairlead.sources.opening import open_images
from fairlead.tracker import TrackerOptions


@pytest.fixture(scope="module")
def shipped(tmp_path_factory: pytest.TempPathFactory) -> Sequence:
    folder = shipped_data("clips/orbit-2.0")
    return load_sequence(folder, shipped_data("frigate") / "target.toml", tmp_path_factory.mktemp("scratch"))


def test_a_picture_is_found_by_its_stamp(shipped):
    images = open_images(shipped.images, shipped.camera, fps=None, topic=None)
    third = list(islice(iter(images), 3))[2]
    np.testing.assert_array_equal(picture_of(shipped, shipped.truth[2].stamp_ns), third.image[..., ::-1])
    with pytest.raises(InputError, match="no image with the stamp"):
        picture_of(replace(shipped, truth=shipped.truth[:1]), -(10**12))


def test_ours_is_told_what_the_card_says_of_errors(shipped, tmp_path, monkeypatch):
    def track(config, _):
        config.output.mkdir(parents=True)
        (config.output / "observations.csv").write_text(
            "frame,stamp_ns,landmark,u_px,v_px,var_u,cov_uv,var_v\n0,0,bow,1.0,2.0,1.0,0.0,1.0\n", encoding="utf-8"
        )
        (config.output / "timing.csv").write_text("frame,stamp_ns,read_ms,detect_ms,update_ms\n", encoding="utf-8")

    monkeypatch.setattr(detections.run, "track", track)
    found = detect(shipped, Network(name="heat-t", path=shipped_data("frigate") / "heat-t.onnx"), tmp_path, silent)
    assert found is not None
    assert found.options != TrackerOptions()
