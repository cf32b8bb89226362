"""The judge: equal pictures lose nothing, worse ones more."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

import cv2
import numpy as np
import pytest
import torch

from tests.recordings import clip
from vcage.base.errors import MissingDependency, UnknownName, UsageError
from vcage.video.jod import JodMetric, require_display


@pytest.fixture(scope="module")
def metric():
    return JodMetric()


def noisy(pictures: np.ndarray, sigma: float) -> np.ndarray:
    noise = np.random.default_rng(0).normal(0, sigma, pictures.shape)
    return (pictures + noise).clip(0, 255).round().astype(np.uint8)


def test_equal_pictures_lose_nothing(metric):
    losses = metric.loss(clip(3), clip(3))
    assert losses.tolist() == [0.0, 0.0, 0.0] and not np.signbit(losses).any()


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


def test_displays_of_a_folder_of_ones_own_are_known(monkeypatch, tmp_path):
    (tmp_path / "display_models.json").write_text('{"cinema": {}}')
    monkeypatch.setenv("CVVDP_PATH", str(tmp_path))
    require_display("cinema")
    with pytest.raises(UnknownName, match="cinema"):
        require_display("standard_fhd")


def test_another_form_of_the_metric_is_refused(monkeypatch, tmp_path):
    own = Path(find_spec("pycvvdp").origin).parent / "vvdp_data/cvvdp_parameters.json"
    other = json.loads(own.read_text()) | {"masking_model": "add-transducer"}
    (tmp_path / "cvvdp_parameters.json").write_text(json.dumps(other))
    monkeypatch.setenv("CVVDP_PATH", str(tmp_path))
    with pytest.raises(MissingDependency, match="masking_model is 'add-transducer', not 'mult-mutual'"):
        JodMetric()


def test_a_missing_cvvdp_error_names_the_package(monkeypatch):
    monkeypatch.setitem(sys.modules, "pycvvdp", None)
    with pytest.raises(MissingDependency, match="ColorVideoVDP") as missing:
        JodMetric()
    assert missing.value.command.endswith("vcage setup cvvdp")


@pytest.mark.parametrize(
    "display", ["standard_fhd", "standard_4k", "standard_phone", "htc_vive_pro", "lg_oled_2017_sdr"]
)
@pytest.mark.parametrize("size", [(240, 320), (98, 134), (97, 134), (99, 77), (16, 20)])
def test_losses_match_the_package(display, size):
    height, width = size
    frames = np.stack([cv2.resize(picture, (width, height)) for picture in clip(2)])
    worse = np.stack([frames[0] // 16 * 16, noisy(frames[1], 4)])
    assert JodMetric(display).loss(worse, frames) == pytest.approx(package_losses(display, worse, frames), abs=2e-5)


def package_losses(display: str, test: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """Return the losses that the package itself computes."""
    with torchvision_names():
        from pycvvdp import cvvdp
    jod, _ = cvvdp(display_name=display, device=torch.device("cpu"), quiet=True).predict(test, reference, "BHWC")
    return 10 - jod.numpy()


@contextmanager
def torchvision_names() -> Iterator[None]:
    """Let ``import pycvvdp`` find inside what it takes from torchvision, where that is missing."""
    names = {"torchvision.transforms": {"GaussianBlur": Blur}, "torchvision.ops": {"MLP": None}}
    made = {}
    for name, members in names.items():
        made[name] = ModuleType(name)
        vars(made[name]).update(members)
    with pytest.MonkeyPatch.context() as patch:
        for name, module in {"torchvision": ModuleType("torchvision"), **made}.items():
            patch.setitem(sys.modules, name, module)
        yield


class Blur:
    """``torchvision.transforms.GaussianBlur`` for one sigma."""

    def __init__(self, kernel_size: int, sigma: float):
        places = torch.linspace(-(kernel_size - 1) / 2, (kernel_size - 1) / 2, kernel_size)
        weights = torch.exp(-0.5 * (places / sigma) ** 2)
        self.weights = weights / weights.sum()

    def forward(self, image: torch.Tensor) -> torch.Tensor:
        """Blur (N, 1, H, W)."""
        half = len(self.weights) // 2
        padded = torch.nn.functional.pad(image, (half,) * 4, mode="reflect")
        rows = torch.nn.functional.conv2d(padded, self.weights.view(1, 1, 1, -1))
        return torch.nn.functional.conv2d(rows, self.weights.view(1, 1, -1, 1))
