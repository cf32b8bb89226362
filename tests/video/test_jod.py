"""The judge: equal pictures lose nothing, worse ones more."""

from __future__ import annotations

import sys

import numpy as np
import pytest
import torch

from tests.recordings import clip
from vcage.base.errors import MissingDependency, UnknownName, UsageError
from vcage.video.colorvideovdp import GaussianBlur
from vcage.video.jod import JodMetric, require_display


@pytest.fixture(scope="module")
def metric():
    return JodMetric()


def noisy(pictures: np.ndarray, sigma: float) -> np.ndarray:
    noise = np.random.default_rng(0).normal(0, sigma, pictures.shape)
    return (pictures + noise).clip(0, 255).round().astype(np.uint8)


def test_equal_pictures_lose_nothing(metric):
    assert metric.loss(clip(3), clip(3)).tolist() == [0.0, 0.0, 0.0]


def test_more_noise_loses_more(metric):
    losses = [metric.loss(noisy(clip(1), sigma), clip(1))[0] for sigma in (2, 6, 20)]
    assert 0 < losses[0] < losses[1] < losses[2]


def test_a_batch_scores_like_its_pictures_one_by_one(metric):
    pictures, worse = clip(5), noisy(clip(5), 8)
    single = [metric.loss(worse[i : i + 1], pictures[i : i + 1])[0] for i in range(5)]
    np.testing.assert_allclose(metric.loss(worse, pictures), single, atol=2e-5)


def test_a_sharper_display_changes_the_score(metric):
    other = JodMetric("standard_4k")
    assert other.loss(noisy(clip(1), 8), clip(1)) != metric.loss(noisy(clip(1), 8), clip(1))


def test_an_unknown_display_error_lists_the_known_ones():
    with pytest.raises(UnknownName, match="standard_fhd"):
        JodMetric("cinema")


@pytest.mark.parametrize("name", ["standard_hdr_hlg", "standard_hdr_pq", "standard_hdr_linear"])
def test_a_display_that_takes_no_srgb_is_refused(name):
    with pytest.raises(UsageError, match="sRGB"):
        JodMetric(name)


def test_the_number_of_threads_of_torch_is_left_as_it_was(metric):
    before = torch.get_num_threads()
    metric.loss(clip(1), clip(1))
    assert torch.get_num_threads() == before


def test_displays_of_a_folder_of_ones_own_are_known(monkeypatch, tmp_path):
    (tmp_path / "display_models.json").write_text('{"cinema": {}}')
    monkeypatch.setenv("CVVDP_PATH", str(tmp_path))
    require_display("cinema")
    with pytest.raises(UnknownName, match="cinema"):
        require_display("standard_fhd")


def test_a_missing_cvvdp_error_names_the_package(monkeypatch):
    monkeypatch.setitem(sys.modules, "pycvvdp", None)
    with pytest.raises(MissingDependency, match="ColorVideoVDP") as missing:
        JodMetric()
    assert missing.value.command.endswith("vcage setup cvvdp")


def test_the_stand_in_blur_keeps_a_constant_and_spreads_a_point():
    blur = GaussianBlur(9, 2.0)
    np.testing.assert_allclose(blur(torch.full((1, 2, 20, 20), 3.0)), 3.0, rtol=1e-6)
    point = torch.zeros(1, 1, 21, 21)
    point[0, 0, 10, 10] = 1.0
    spread = blur(point)[0, 0]
    assert spread.sum() == pytest.approx(1.0)
    assert float(spread[10, 12] / spread[10, 10]) == pytest.approx(np.exp(-0.5), rel=1e-5)


def test_no_false_torchvision_is_left_behind(metric):
    assert "torchvision" not in sys.modules or hasattr(sys.modules["torchvision"], "__file__")


def test_losses_match_the_library_with_its_own_reading_and_convolutions(metric):
    frames = clip(4)
    worse = frames // 16 * 16
    jod, _ = metric._metric.predict(worse, frames, dim_order="BHWC")
    assert torch.backends.mkldnn.set_flags()[0] == torch.backends.mkldnn.is_available()
    assert metric.loss(worse, frames) == pytest.approx(10 - jod.numpy(), abs=2e-5)
