"""Clocks of HDF5 recordings: their places, their units, and the notes about them."""

from __future__ import annotations

import re
from pathlib import Path

import h5py
import numpy as np
import pytest

from tests.datasets.packing.orders import settings
from tests.datasets.recordings.layouts import FRAMES, act, robomimic
from vcage.base.errors import DamagedFile, UsageError
from vcage.datasets.packing.output import OutputSpec
from vcage.datasets.packing.pack import Order, prepare
from vcage.datasets.recordings.clocks import clock_of
from vcage.datasets.recordings.opening import open_recordings

EVEN = np.arange(FRAMES) / 50
GAP = EVEN + [0, 0, 0, 0.4, 0.4, 0.4]
EPOCH = 1_700_000_000


def timed(path: Path, key: str, values: object) -> Path:
    with h5py.File(act(path), "r+") as file:
        file[key] = values
    return path


def order(path: Path, fps: float | None = None) -> Order:
    return Order(path, path.parent / "out", settings(), OutputSpec("lerobot-v3.0", fps, "go"))


def ros(seconds: np.ndarray, kind: type = np.int64) -> np.ndarray:
    """(T, 2) seconds and nanoseconds."""
    nanoseconds = np.round(seconds * 1e9).astype(np.int64)
    return np.stack([EPOCH + nanoseconds // 10**9, nanoseconds % 10**9], axis=1).astype(kind)


KEYS = (
    *("timestamps", "observations/time", "observations/timestamps/cam_high", "obs/cam_high_timestamp"),
    *("meta/camera/timeStamp", "header/stamp", "times", "observations/sim_time", "time/left_arm", "clock", "ts"),
)


@pytest.mark.parametrize("key", KEYS)
def test_a_clock_is_found_in_any_group_by_a_word_of_time(tmp_path, key):
    (recording,) = open_recordings(timed(tmp_path / "a.hdf5", key, EVEN))
    assert recording.rate_guess == 50
    with pytest.raises(DamagedFile, match="off, more than half a frame"):
        prepare(order(timed(tmp_path / "b.hdf5", key, GAP), 50))


SHAPES = {
    "column": lambda times: times[:, None],
    "row": lambda times: times[None],
    "two clocks": lambda times: np.stack([times, times], axis=1),
    "ros": ros,
    "ros as floats": lambda times: ros(times + 0.97, np.float64),
    "microseconds": lambda times: ros(times) // [1, 1000],
}


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_a_clock_may_have_columns(tmp_path, shape):
    assert open_recordings(timed(tmp_path / "a.hdf5", "timestamps", shape(EVEN)))[0].rate_guess == 50
    with pytest.raises(DamagedFile, match="off, more than half a frame"):
        prepare(order(timed(tmp_path / "b.hdf5", "timestamps", shape(GAP)), 50))


def test_a_gap_in_a_demonstration_of_robomimic_is_refused_by_name(tmp_path):
    path = robomimic(tmp_path / "a.hdf5", ("demo_0", "demo_1"))
    with h5py.File(path, "r+") as file:
        file["data/demo_1/obs/timestamp"] = np.arange(FRAMES) / 20 + [0, 0, 0, 1, 1, 1]
    with pytest.raises(DamagedFile, match="demo_1: obs/timestamp has frame"):
        prepare(order(path))


@pytest.mark.parametrize(
    ("key", "values", "told"),
    [
        ("timestamps", [b"12:00:00"] * FRAMES, r"timestamps \(\(6,\) text\)"),
        ("observations/time", np.arange(FRAMES + 3) / 50, r"observations/time \(\(9,\) float64\)"),
        ("header/stamp/nsec", np.arange(FRAMES), r"header/stamp/nsec \(\(6,\) int64\)"),
        ("solver_time", EVEN[::-1], r"solver_time \(\(6,\) float64\)"),
        ("observations/segment_time", np.arange(FRAMES) % 3 / 50, r"segment_time \(\(6,\) float64\)"),
        ("timestamp/robot_nanos", np.arange(FRAMES) * 3e8 % 1e9, r"robot_nanos \(\(6,\) float64\)"),
        ("timestamp/robot_seconds", np.arange(FRAMES) // 3, r"robot_seconds \(\(6,\) int64\)"),
        ("time", np.zeros((FRAMES, 2, 2)), r"time \(\(6, 2, 2\) float64\)"),
    ],
)
def test_a_clock_in_an_unknown_form_is_reported(tmp_path, key, values, told):
    (recording,) = open_recordings(timed(tmp_path / "a.hdf5", key, values))
    (note,) = (note for note in recording.notes if "not understood" in note)
    assert re.search(told, note)
    prepare(order(tmp_path / "a.hdf5", 50))


@pytest.mark.parametrize("key", ["runtime", "time_limit", "inference_time", "observations/timesteps", "contact_time"])
def test_durations_are_no_clocks(tmp_path, key):
    (recording,) = open_recordings(timed(tmp_path / "a.hdf5", key, GAP))
    assert recording.rate_guess is None and not any(key in note for note in recording.notes)


@pytest.mark.parametrize("values", [np.arange(FRAMES), np.arange(FRAMES) + 100, np.arange(FRAMES, dtype=float)])
def test_a_counter_of_frames_tells_no_rate(tmp_path, values):
    path = timed(tmp_path / "a.hdf5", "timestamps", values)
    assert any("counts frames and tells no rate" in note for note in open_recordings(path)[0].notes)
    with pytest.raises(UsageError, match="does not say how many") as refused:
        prepare(order(path))
    assert "counts frames" in refused.value.hint
    work = prepare(order(path, 30))
    assert {clip.fps for clip in work.clips()} == {30}


def test_a_counter_that_jumps_means_missing_frames(tmp_path):
    path = timed(tmp_path / "a.hdf5", "timestamps", [0, 1, 2, 7, 8, 9])
    with pytest.raises(DamagedFile, match="frame 3 comes 5 after the one before it"):
        prepare(order(path, 30))


@pytest.mark.parametrize(
    ("step", "rate"),
    [(0.002, 500), (0.02, 50), (1.5, None), (2, None), (5, 200), (33_333_333, 30), (33_333, 30), (1500, None)],
)
def test_the_unit_of_a_clock_is_certain_or_left_to_the_user(step, rate):
    assert clock_of("time", np.arange(FRAMES) * step).nominal_rate == rate


def test_a_stated_rate_settles_the_unit(tmp_path):
    path = timed(tmp_path / "a.hdf5", "timestamps", np.arange(FRAMES) * 2)
    assert any("0.5 Hz in s or 500 Hz in ms" in note for note in open_recordings(path)[0].notes)
    for fps in (0.5, 500):
        prepare(order(path, fps))
    with pytest.raises(DamagedFile, match="more than half a frame"):
        prepare(order(path, 30))


@pytest.mark.parametrize(
    ("values", "told"),
    [(GAP, "more than half a frame"), ([0, 0.02, 0.04, 0.06, 0.04, 0.06], "does not grow at frame 4")],
)
def test_a_clock_that_jumps_or_goes_back_is_reported_and_gives_no_rate(tmp_path, values, told):
    (recording,) = open_recordings(timed(tmp_path / "a.hdf5", "timestamps", values))
    assert recording.rate_guess is None
    assert any(told in note for note in recording.notes)
    assert not any("its frame rate" in note for note in recording.notes)
