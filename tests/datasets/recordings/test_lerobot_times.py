from __future__ import annotations

import shutil

import numpy as np
import pytest

from tests.datasets.recordings.coded import FPS, data_set, film, in_one_video, numbers, with_info, with_timestamps
from vcage.base.errors import DamagedFile
from vcage.datasets.packing.output import OutputSpec, resolve_output
from vcage.datasets.packing.pack import Order, pack
from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.packing.sources import find_sources
from vcage.datasets.recordings.lerobot_times import (
    RowTimes,
    Share,
    TooShort,
    Unclear,
    frames_of_rows,
    row_times,
    shares,
)
from vcage.datasets.recordings.opening import open_recordings

LENGTHS = (4, 5, 6)
STARTS = (0, 4, 9)
EVEN = np.arange(6) / FPS


# --- rows ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("first", [0, 3000])
def test_even_times_in_single_precision_are_taken_as_they_are(first):
    times = row_times(((first + np.arange(30)) / 30 - first / 30).astype(np.float32), 30)
    assert (times.off_s, times.note) == (0.0, "")


def test_small_jitter_is_counted_and_reported():
    times = row_times(EVEN + [0, 0.004, -0.003, 0, 0.01, 0], FPS)
    assert times.off_s == pytest.approx(0.01)
    assert "up to 10 ms off 10 frames per second" in times.note


@pytest.mark.parametrize("clock", [1.7e9, 86400.0, 1.0])
def test_the_times_of_a_clock_are_counted_from_the_first(clock):
    times = row_times(EVEN + clock, FPS)
    assert np.allclose(times.seconds, EVEN)
    assert "taken for a clock's" in times.note


@pytest.mark.parametrize(
    ("timestamps", "said"),
    [
        (np.arange(10) * 0.107, "frame 9 at 0.9630 s, at 10 frames per second it is 0.9000 s: 63.0 ms off"),
        (np.arange(6) / 20, "those of 20.00 frames per second"),
        (EVEN + 0.1, "100.0 ms off"),
        (EVEN[[0, 1, 1, 3, 4, 5]], "frame 2 repeats 0.1000 s"),
        (EVEN[[0, 1, 2, 4, 3, 5]], "frame 4 goes back to 0.3000 s"),
        (np.full(6, 1.7e9, np.float32), "frame 1 repeats"),
        (EVEN * [1, 1, np.nan, 1, 1, 1], "NaN"),
    ],
)
def test_uncertain_times_are_refused_with_their_size(timestamps, said):
    with pytest.raises(Unclear, match=said):
        row_times(timestamps, 10 if len(timestamps) == 10 else FPS)


# --- frames --------------------------------------------------------------------------------------------


def placed(begin: float, share: Share | None, frames: int = 20, rows: int = 5) -> tuple[list[int], str]:
    shown = np.arange(frames) / FPS
    found, note = frames_of_rows(shown, begin / FPS, RowTimes(np.arange(rows) / FPS), FPS, share)
    return list(found), note


@pytest.mark.parametrize("share", [Share(7, 20), None])
def test_a_begin_within_the_tolerance_counts(share):
    assert placed(7.0005, share) == ([7, 8, 9, 10, 11], "")


@pytest.mark.parametrize("begin", [6.5, 6.6, 7.3, 7.5])
def test_a_drift_of_up_to_half_a_frame_is_mended_where_the_lengths_of_all_episodes_agree(begin):
    frames, note = placed(begin, Share(7, 20))
    assert frames == [7, 8, 9, 10, 11]
    assert "its frames are counted" in note


@pytest.mark.parametrize("begin", [6.4, 7.6, 8.0, 6.0, -1.0, float("nan"), float("inf")])
def test_a_drift_against_the_lengths_of_all_episodes_is_refused(begin):
    with pytest.raises(Unclear):
        placed(begin, Share(7, 20))


def test_a_drift_is_mended_alone_only_where_it_is_small():
    assert placed(7.2, None)[0] == [7, 8, 9, 10, 11]
    assert placed(7.2, Share(3, 19))[0] == [7, 8, 9, 10, 11]
    with pytest.raises(Unclear, match=r"40 ms off the video's frame 7, 0\.40 of a frame"):
        placed(7.4, None)


def test_an_episode_beyond_the_end_of_its_video_is_refused():
    with pytest.raises(TooShort):
        placed(17.0, None)


def test_a_video_of_more_frames_is_looked_up_by_time():
    shown = np.arange(40) / (2 * FPS)
    found, note = frames_of_rows(shown, 0.2, RowTimes(np.arange(5) / FPS), FPS, None)
    assert (list(found), note) == ([4, 6, 8, 10, 12], "")


def test_a_pause_between_two_episodes_of_a_video_shifts_nothing():
    shown = np.concatenate([np.arange(4), 4.5 + np.arange(5)]) / FPS
    found, note = frames_of_rows(shown, 0.45, RowTimes(np.arange(5) / FPS), FPS, Share(4, 9))
    assert (list(found), note) == ([4, 5, 6, 7, 8], "")


def test_shares_follow_the_order_in_the_video():
    rows = [
        {"episode_index": 0, "length": 4, "videos/k/chunk_index": 0, "videos/k/file_index": 0},
        {"episode_index": 1, "length": 5, "videos/k/chunk_index": 0, "videos/k/file_index": 0},
        {"episode_index": 2, "length": 6, "videos/k/chunk_index": 0, "videos/k/file_index": 1},
    ]
    for row, begin in zip(rows, (0.5, 0.0, 0.0), strict=True):
        row["videos/k/from_timestamp"] = begin
    assert shares(rows, "k", FPS) == {1: Share(0, 9), 0: Share(5, 9), 2: Share(0, 6)}
    rows[0]["videos/k/from_timestamp"] = 0.0
    assert shares(rows, "k", FPS) == {0: Share(0, 9), 1: Share(4, 9, overlaps=0), 2: Share(0, 6)}
    rows[0]["videos/k/from_timestamp"] = None
    assert shares(rows, "k", FPS) == {2: Share(0, 6)}


# --- data sets -----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("coded")
    return {name: data_set(f"lerobot-{name}", folder / name, LENGTHS) for name in ("v2.1", "v3.0")}


@pytest.fixture
def v30(made, tmp_path):
    return shutil.copytree(made["v3.0"], tmp_path / "set")


@pytest.fixture
def v21(made, tmp_path):
    return shutil.copytree(made["v2.1"], tmp_path / "set")


def compressed(root, target=None):
    order = Order(root, root.parent / "out", CompressionSettings(crf=1, keyframes=2), OutputSpec(target))
    return pack(order, workers=1).record, open_recordings(root.parent / "out")


def require_own_frames(recordings):
    for recording, start, length in zip(recordings, STARTS, LENGTHS, strict=True):
        assert numbers(recording.pictures("cam")) == list(range(start, start + length))
        assert recording.state[:, 0].tolist() == list(range(start, start + length))


@pytest.mark.parametrize("target", [None, "lerobot-v2.1"])
def test_every_frame_stays_with_its_row_though_begins_drift_by_half_a_frame(v30, target):
    in_one_video(v30, LENGTHS, (0, 4.25, 9.5))
    record, written = compressed(v30, target)
    require_own_frames(written)
    assert "0.50 of a frame" in record.notes["episode_000002"][0]
    assert "episode_000000" not in record.notes


def test_every_frame_stays_with_its_row_in_a_video_of_many_episodes(v30):
    require_own_frames(open_recordings(in_one_video(v30, LENGTHS, STARTS)))


def test_a_begin_that_is_off_by_more_is_refused_by_episode_file_and_size(v30):
    in_one_video(v30, LENGTHS, (0, 4.25, 9.75))
    with pytest.raises(DamagedFile, match=r"episode 2, videos/.*/file-000\.mp4: .* 0\.75 of a frame") as refused:
        compressed(v30)
    assert "tolerance is 0.1 ms" in refused.value.message
    assert not (v30.parent / "out").exists()


def test_a_begin_at_another_episodes_frame_is_refused(v30):
    in_one_video(v30, LENGTHS, (0, 4, 8))
    with pytest.raises(DamagedFile, match="begins at frame 8 of the video by its time, and at frame 9"):
        _ = open_recordings(v30)[2].pictures("cam")


def test_episodes_that_all_begin_at_the_start_of_one_video_are_refused_or_reported_to_overlap(v30):
    first, second, _ = open_recordings(in_one_video(v30, LENGTHS, (0, 0, 0)))
    assert first.notes == []
    with pytest.raises(DamagedFile, match="begins at frame 0 of the video by its time, and at frame 4"):
        _ = second.notes
    second = open_recordings(in_one_video(v30, LENGTHS, (0, 2, 9), spare=1))[1]
    assert second.notes == ["observation.images.cam: by its times it shows frames of episode 0 too"]


def test_a_drift_in_a_video_that_holds_more_is_refused_where_it_leaves_a_doubt(v30):
    in_one_video(v30, LENGTHS, (0, 4.2, 9.4), spare=3)
    first, second, third = open_recordings(v30)
    assert numbers(second.pictures("cam")) == [4, 5, 6, 7, 8]
    assert len(first.notes) == 0 and len(second.notes) == 1
    with pytest.raises(DamagedFile, match=r"0\.40 of a frame"):
        third.pictures("cam")


def test_times_at_another_rate_than_the_data_set_states_are_refused(v21):
    with_timestamps(v21, 1, (np.arange(5) * 0.12).astype(np.float32))
    with pytest.raises(DamagedFile, match=r"episode 1, data/.*episode_000001\.parquet: .* 80\.0 ms off") as refused:
        find_sources(v21, CompressionSettings())
    assert refused.value.details["damaged"].keys() == {"episode_000001"}
    with pytest.raises(DamagedFile, match=r"those of 10\.00 frames per second"):
        find_sources(with_info(v21, fps=20), CompressionSettings())


def test_clock_times_become_frame_times_in_another_version_only(v21):
    with_timestamps(v21, 1, 1.7e9 + np.arange(5) / FPS)
    with pytest.raises(DamagedFile, match=r"episode 1: .* keeps them") as refused:
        compressed(v21)
    assert "--to lerobot-v3.0" in refused.value.hint
    record, written = compressed(v21, "lerobot-v3.0")
    require_own_frames(written)
    assert "taken for a clock's" in record.notes["episode_000001"][0]
    assert written[1]._files.times.off_s == 0


def test_jitter_is_reported_once_and_leaves_the_data_set_of_another_version_even(v21):
    with_timestamps(v21, 1, np.array([0, 0.11, 0.19, 0.31, 0.4], np.float32))
    record, written = compressed(v21, "lerobot-v3.0")
    require_own_frames(written)
    assert [len(notes) for notes in record.notes.values()] == [1]
    assert written[1]._files.times.off_s == 0


def test_times_with_nan_are_named(v21):
    with_timestamps(v21, 1, np.array(list("abcde")))
    with pytest.raises(DamagedFile, match=r"episode_000001\.parquet: its timestamps are no numbers"):
        open_recordings(v21)[1].pictures("cam")


def test_frames_that_belong_to_no_row_are_reported(v21):
    film(v21 / "videos/chunk-000/observation.images.cam/episode_000001.mp4", range(4, 12))
    recording = open_recordings(v21)[1]
    assert numbers(recording.pictures("cam")) == [4, 5, 6, 7, 8]
    assert recording.notes == ["observation.images.cam: its video has 3 frames that belong to no row"]


def test_pictures_in_tables_need_even_times_too(v21):
    times = with_timestamps(v21, 0, np.array([0, 0.1, 0.1, 0.3], np.float32))
    info = {"observation.images.cam": {"dtype": "image", "shape": [48, 64, 3], "names": None}}
    with_info(times, features={"timestamp": {"dtype": "float32", "shape": [1]}, **info})
    with pytest.raises(DamagedFile, match="frame 2 repeats"):
        _ = open_recordings(v21)[0]._camera_notes()


def test_a_missing_column_of_times_is_no_fault(v21):
    info = {"observation.images.cam": {"dtype": "video", "shape": [48, 64, 3], "names": None}}
    recording = open_recordings(with_info(v21, features=info))[0]
    assert numbers(recording.pictures("cam")) == [0, 1, 2, 3]
    assert resolve_output(
        OutputSpec("lerobot-v3.0", task="go"), find_sources(v21, CompressionSettings()).sources
    ).lerobot
