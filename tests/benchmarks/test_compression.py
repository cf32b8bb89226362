"""``python -m benchmarks compression``: its rows, its curves, and what it takes from the cache."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from benchmarks import _compression_measures, compression
from benchmarks.__main__ import main
from benchmarks._compression_clips import Clip, Film, clips
from benchmarks._compression_curve import Point, draw
from benchmarks._compression_episodes import VERSION
from benchmarks._compression_formats import JPEG, LEROBOT, OURS, PNG, Found, Made, formats
from benchmarks._compression_measures import Measured, code_hash, measure_clip
from benchmarks._compression_rows import rows
from benchmarks._compression_stored import store_pictures
from benchmarks._efforts import effort_formats, effort_rows
from tests.recordings import FPS
from tests.recordings import clip as pictures
from vcage.base.files import cache_dir, write_json
from vcage.video.encoders import CODECS

ASKED = {
    "format",
    "gop",
    "bytes",
    "vs_raw",
    "vs_png",
    "vs_jpeg_hdf5",
    "vs_lerobot_av1",
    "jod_loss_keyframes_max",
    "jod_loss_heldout_max",
    "encode_ms_per_frame",
    "random_decode_ms",
}


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VCAGE_CACHE", str(tmp_path / "cache"))


def measured(name: str, size: int, clip: str = "a", clips: str = "rendered") -> Measured:
    return Measured(
        clip=clip,
        clips=clips,
        format=name,
        frames=10,
        raw_bytes=10_000,
        bytes=size,
        losses_keyframes=[0.02, 0.05],
        losses_heldout=[0.04, 0.06],
        encode_ms=2.0,
        search_ms=10.0,
        decode_ms=3.0,
        encodes=4,
        gop=10,
        crf=20,
        pixel_format="yuv444p10le",
        limit=0.1,
    )


def a_clip(clips: str = "rendered") -> list[Measured]:
    sizes = {PNG.name: 4000, JPEG.name: 2000, LEROBOT.name: 400, OURS.name: 100}
    return [measured(name, size, clips=clips) for name, size in sizes.items()]


# --- rows ----------------------------------------------------------------------------------------------


def test_rows_state_savings_against_every_other_format() -> None:
    ours = rows(a_clip())[-1]
    assert [ours[f"vs_{name}"] for name in ("raw", "png", "jpeg_hdf5", "lerobot_av1")] == [0.99, 0.975, 0.95, 0.75]


def test_rows_have_every_requested_figure() -> None:
    for row in rows(a_clip()):
        assert row.keys() >= ASKED


def test_rendered_and_noisy_clips_have_rows_apart() -> None:
    both = rows([*a_clip(), *(replace(one, bytes=2 * one.bytes) for one in a_clip("noisy"))])
    assert [(row["clips"], row["bytes"]) for row in both if row["format"] == OURS.name] == [
        ("rendered", 100),
        ("noisy", 200),
    ]
    assert {row["vs_lerobot_av1"] for row in both if row["format"] == OURS.name} == {0.75}


def test_losses_come_from_the_worst_clip() -> None:
    worse = replace(a_clip()[-1], losses_keyframes=[0.3], losses_heldout=[0.2])
    row = rows([*a_clip(), worse])[-1]
    assert (row["jod_loss_keyframes_max"], row["jod_loss_heldout_max"], row["clips_in_limit"]) == (0.3, 0.2, 1)
    assert row["jod_loss_heldout_mean"] == 0.1


def test_efforts_are_compared_with_the_default_of_their_codec() -> None:
    sizes = {"fast": 150, "default": 100, "best": 80}
    found = effort_rows(measured(f"hevc-{effort}", size) for effort, size in sizes.items())
    assert [(row["codec"], row["effort"], row["of_default"]) for row in found] == [
        ("hevc", "fast", 1.5),
        ("hevc", "default", 1.0),
        ("hevc", "best", 0.8),
    ]


def test_bytes_of_efforts_that_were_searched_for_other_losses_are_not_compared() -> None:
    default = measured("av1-default", 100)
    fast = replace(measured("av1-fast", 20), limit=1.1)
    assert [row["of_default"] for row in effort_rows([default, fast])] == [1.0, None]


def test_every_codec_is_measured_with_every_effort() -> None:
    assert {form.name for form in effort_formats()} == {
        f"{codec}-{effort}" for codec in CODECS for effort in ("fast", "default", "best")
    }


# --- measuring -----------------------------------------------------------------------------------------


class Counted:
    """PNG that counts how often it is made, and remembers what came before."""

    def __init__(self, name: str):
        self.name, self.made, self.before = name, 0, dict[str, Found]()

    def make(self, film: Film, metric: object, folder: Path, before: dict[str, Found]) -> Made:
        self.made += 1
        self.before = dict(before)
        return Made(store_pictures(film.frames, folder / "clip.hdf5", ".png", []), 1.0, 1.0, crf=7)


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> Clip:
    monkeypatch.setattr(Clip, "load", lambda _clip: Film(pictures(6), FPS, [0, 5], [3]))
    return clips(quick=True)[0]


def test_a_clip_is_measured_once(small: Clip) -> None:
    form = Counted("first")
    once = measure_clip(small, [form])
    assert measure_clip(small, [form]) == once
    assert form.made == 1
    assert once[0].losses_keyframes == [0.0, 0.0] and once[0].losses_heldout == [0.0]


def test_an_interrupted_clip_resumes_with_the_missing_format(small: Clip) -> None:
    first, second = Counted("first"), Counted("second")
    measure_clip(small, [first])
    measure_clip(small, [first, second])
    assert (first.made, second.made) == (1, 1)
    assert second.before["first"].crf == 7


def test_other_code_measures_again(small: Clip, monkeypatch: pytest.MonkeyPatch) -> None:
    form = Counted("first")
    measure_clip(small, [form])
    monkeypatch.setattr(_compression_measures, "code_hash", lambda: "another")
    measure_clip(small, [form])
    assert form.made == 2


# --- curves --------------------------------------------------------------------------------------------


def test_the_curves_are_drawn_side_by_side(tmp_path: Path) -> None:
    points = [Point(clip, "hevc-g10", 20 + i, 100.0 + i, 0.2 - i / 20) for clip in ("a", "b") for i in range(3)]
    picture = cv2.imread(str(draw(points, tmp_path / "curves.png")))
    assert picture.shape[1] > 2 * picture.shape[0]
    assert np.ptp(picture) > 200


# --- the command ---------------------------------------------------------------------------------------


@pytest.fixture
def measured_before() -> None:
    """A cache in which everything that --quick needs lies."""
    for clip in clips(quick=True):
        (cache_dir("benchmarks", "compression", f"v{VERSION}") / f"{clip.recipe.name}.hdf5").touch()
        results = [asdict(measured(form.name, 100, clip.name)) for form in formats(quick=True)]
        write_json(cache_dir("benchmarks", "compression", f"results-{code_hash()}") / f"{clip.name}.json", results)


@pytest.mark.slow
@pytest.mark.usefixtures("measured_before")
def test_the_last_line_is_json_with_a_row_for_each_format(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compression", "--quick"]) == 0
    figures = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert [row["format"] for row in figures["rows"]] == [form.name for form in formats(quick=True)]
    assert any(row["format"].startswith("vcage") for row in figures["rows"])
    assert "curves" not in figures


def test_the_remaining_time_is_reported(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    assert list(compression._watched(iter("ab"), 2)) == ["a", "b"]
    assert caplog.messages[0].startswith("1 of 2 done")
