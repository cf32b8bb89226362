"""The judge: equal pictures lose nothing, worse ones more."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import cv2
import numpy as np
import pytest

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


DISPLAYS = ("standard_fhd", "standard_4k", "standard_phone", "htc_vive_pro", "lg_oled_2017_sdr")

SIZES = ((240, 320), (98, 134), (97, 134), (99, 77), (16, 20))


def pair_of(size: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Worse pictures, and pictures."""
    frames = np.stack([cv2.resize(picture, size[::-1]) for picture in clip(2)])
    return np.stack([frames[0] // 16 * 16, noisy(frames[1], 4)]), frames


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, list[float]]]:
    """Display → size → losses that the package itself computes, in a process of its own: it patches what it imports."""
    folder = tmp_path_factory.mktemp("pairs")
    for size in SIZES:
        np.savez(folder / f"{size}.npz", *pair_of(size))
    command = [sys.executable, "-W", "ignore", "-m", "tests.video.package_losses", str(folder), *DISPLAYS]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.slow
@pytest.mark.parametrize("display", DISPLAYS)
@pytest.mark.parametrize("size", SIZES)
def test_losses_match_the_package(display, size, package):
    assert JodMetric(display).loss(*pair_of(size)) == pytest.approx(package[display][str(size)], abs=2e-5)
