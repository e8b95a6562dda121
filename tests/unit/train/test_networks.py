# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The networks are the published ones, and find the middle of a heat where it is, to a fraction of a pixel."""

import numpy as np
import pytest
import torch
from torch import Tensor, nn

from fairlead.train.networks.catalogue import NAMES, make_network
from fairlead.train.networks.heat import expectation, gaussian_rows
from fairlead.train.networks.layers import FAINT, even_contrast
from fairlead.train.networks.pooling import Presence, seen_if_present
from fairlead.train.networks.rtmpose import SIGMA_BINS, RtmPose, row_expectation
from fairlead.train.networks.tinypose import SIGMA, Blur, TinyPose, dark

PLACES = torch.tensor([[[101.5, 61.5], [33.0, 90.25], [64.7, 40.9], [95.2, 93.0]]])
"""[px] of a 128 px crop; the first is the centre of cell (25, 15), by hand: 4 * 25 + 1.5."""


def own_parameters(network: nn.Module) -> int:
    """Of what is published: without the heads for covariance, visibility and presence."""
    ours = ("landmark.", "presence.")
    return sum(p.numel() for name, p in network.named_parameters() if not name.startswith(ours))


@pytest.mark.parametrize(("size", "published_million"), [("t", 3.34), ("s", 5.47), ("m", 13.59)])
def test_rtmpose_has_as_many_parameters_as_published(size: str, published_million: float) -> None:
    """Jiang et al. 2023, table 8: 17 points, 256 x 192."""
    assert own_parameters(RtmPose(17, size, (192, 256))) / 1e6 == pytest.approx(published_million, abs=0.005)


def test_tinypose_has_as_many_parameters_as_published() -> None:
    """PaddleDetection's table of PP-TinyPose: 1.32 M at 17 points."""
    assert own_parameters(TinyPose(17)) / 1e6 == pytest.approx(1.32, abs=0.005)


@pytest.mark.parametrize("name", NAMES)
def test_every_network_answers_for_every_landmark(name: str) -> None:
    network = make_network(name, 5, 64).eval()
    with torch.inference_mode():
        found = network(torch.randn(2, 3, 64, 64))
    assert found.pixels.shape == (2, 5, 2)
    assert found.cholesky.shape == (2, 5, 3)
    assert found.visible.shape == (2, 5)
    assert found.present.shape == (2,)
    parts = (found.pixels, found.cholesky, found.visible, found.present)
    assert all(torch.isfinite(part).all() for part in parts)
    assert (found.visible < found.present[:, None]).all()


@pytest.mark.parametrize("name", ["heat-t", "rtmpose-t", "tinypose"])
def test_no_network_minds_haze_or_exposure(name: str) -> None:
    """Of a scene seen through haze a quarter of the contrast is left, about a grey that is not the scene's."""
    network, scene = make_network(name, 5, 64).eval(), torch.randn(2, 3, 64, 64)
    with torch.inference_mode():
        clear, hazy = network(scene), network(0.25 * scene + 1.5)
    assert all(torch.allclose(a, b, rtol=0.03, atol=1e-4) for a, b in zip(clear.maps, hazy.maps, strict=True))


def test_contrast_is_evened_picture_by_picture_and_not_made_of_nothing() -> None:
    scene = torch.randn(2, 3, 32, 32) * torch.tensor([2.0, 0.5])[:, None, None, None] + 1.0
    evened = even_contrast(scene)
    assert evened.mean((1, 2, 3)).abs().max() < 1e-5
    assert torch.allclose(evened.std((1, 2, 3)), torch.ones(2), atol=1e-3)
    faint = even_contrast(0.1 * FAINT * torch.randn(1, 3, 32, 32) + 0.3)
    assert faint.std().item() == pytest.approx(0.1, rel=0.05)
    assert even_contrast(torch.full((1, 3, 32, 32), 0.7)).abs().max() < 1e-3


def test_a_landmark_is_seen_if_the_target_is_there_and_it_is_not_hidden() -> None:
    """The product of two chances, also where one is nearly 0 or 1 in single precision."""
    seen, present = torch.tensor([[0.3, -2.0, 60.0, -60.0]]), torch.tensor([1.2])
    found = seen_if_present(seen, present)
    assert torch.allclose(found[0, :2].sigmoid(), seen[0, :2].sigmoid() * present.sigmoid())
    assert found[0, 2].item() == pytest.approx(1.2)
    assert found[0, 3].item() == pytest.approx(-60.0 - np.log1p(np.exp(-1.2)))


def test_presence_does_not_ask_how_large_the_picture_is() -> None:
    """One cell of many says that the target is there."""
    presence = Presence(3).eval()
    presence.layers = nn.Conv2d(3, 1, 1)
    nn.init.ones_(presence.layers.weight)
    nn.init.constant_(presence.layers.bias, -20.0)
    for side in (8, 32):
        features = torch.zeros(1, 3, side, side)
        features[0, :, 2, 5] = 10.0
        assert presence(features).item() == pytest.approx(10.0, abs=0.1)


def test_an_unknown_network_is_named() -> None:
    with pytest.raises(ValueError, match=r"expected one of heat-t, .* got 'resnet'"):
        make_network("resnet", 5)


def heat_at(places: Tensor, sigma: float, cells: int = 32) -> Tensor:
    across, down = gaussian_rows(places, cells, cells, sigma)
    return down[..., :, None] * across[..., None, :]


def test_the_expectation_of_a_heat_is_its_middle() -> None:
    """A Gaussian of 1 cell in a window of 3 cells to either side is cut off unevenly: 0.01 cells."""
    heat = heat_at(PLACES, 1.0)
    pixels, known = expectation(heat.clamp_min(1e-30).log(), torch.zeros(1, 8, 32, 32))
    assert (pixels - PLACES).abs().max() < 0.06
    assert torch.allclose(known[..., -2], torch.zeros(1, 4), atol=0.01)  # all of the heat lies in the window
    assert torch.allclose(known[..., -1], torch.tensor(2.0).log(), atol=0.02)  # its width: 1 + 1 cells^2


def test_dark_decoding_finds_the_middle_of_a_gaussian() -> None:
    """The log of a blurred Gaussian is a parabola, so one Newton step is exact up to the cut of the blur."""
    assert (dark(heat_at(PLACES, SIGMA), Blur(4)) - PLACES).abs().max() < 0.02


def test_rows_of_bins_are_read_to_a_fraction_of_a_bin() -> None:
    """Bin i lies at i / 2 px; the trained rows are ten times steeper than the label."""
    bins = torch.arange(256)
    rows = [-0.05 * ((bins - 2.0 * PLACES[..., axis, None]) / SIGMA_BINS) ** 2 for axis in (0, 1)]
    found = torch.stack([row_expectation(row)[0] for row in rows], dim=-1)
    inner = (PLACES > 20.0) & (PLACES < 118.0)  # elsewhere the window is cut off by the edge
    assert (found - PLACES)[inner].abs().max() < 0.02


@pytest.mark.parametrize("name", ["heat-t", "rtmpose-t", "tinypose"])
def test_the_loss_is_least_at_the_truth(name: str) -> None:
    network = make_network(name, 4, 128)
    if isinstance(network, RtmPose):
        bins = torch.arange(256)
        maps = tuple(torch.exp(-0.5 * ((bins - 2.0 * PLACES[..., k, None]) / 4.0) ** 2) for k in (0, 1))
    elif isinstance(network, TinyPose):
        maps = (heat_at(PLACES, SIGMA),)
    else:
        maps = (heat_at(PLACES, 1.5).clamp_min(1e-30).log(),)
    there = network.map_loss(maps, PLACES)
    for away in ((2.0, 0.0), (-2.0, 0.0), (0.0, 2.0), (0.0, -2.0)):
        assert (network.map_loss(maps, PLACES + torch.tensor(away)) > there + 1e-4).all()
    if not isinstance(network, RtmPose):
        assert there.abs().max() < 1e-3
