from __future__ import annotations

from pathlib import Path

import av
import pytest

from tests.datasets.packing.orders import act_folder, add_camera, settings
from tests.datasets.packing.searching import ALL, NONE_PASSES, Searches, episode
from tests.run_folders import digests
from vcage.base.errors import DamagedFile, MissingDependency, UnknownName
from vcage.base.workers import SameProcess
from vcage.datasets.packing import clips as clip_module
from vcage.datasets.packing.agreement import Bound
from vcage.datasets.packing.clips import Clip
from vcage.datasets.packing.dataset_search import search_data_set, workers_for
from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.packing.sources import find_sources
from vcage.schema.compression import VideoStream
from vcage.video.choices import Choices

SEARCHED = CompressionSettings(effort="fast")


@pytest.fixture
def searches(monkeypatch) -> Searches:
    return Searches(monkeypatch)


def clips_of(folder: Path) -> list[Clip]:
    return find_sources(folder, settings()).clips(fps=10.0)


def episodes(folder: Path, **cameras: list) -> list[Clip]:
    """One episode for each entry of the cameras' lists."""
    folder.mkdir(exist_ok=True)
    for index in range(len(next(iter(cameras.values())))):
        episode(folder / f"{index}.hdf5", **{name: allowed[index] for name, allowed in cameras.items()})
    return clips_of(folder)


def streams(clips: list[Clip], folder: Path, chosen: CompressionSettings = SEARCHED, **options) -> list[VideoStream]:
    return [video.stream for video in search_data_set(clips, chosen, folder, workers=1, **options).values()]


# --- what shares a CRF ---------------------------------------------------------------------------------


def test_all_episodes_of_a_camera_get_the_lowest_crf_that_any_allows(tmp_path, searches):
    clips = episodes(tmp_path / "in", high=[24, 22, 23, 19, 25, 21, 24], low=[30] * 7)
    found = streams(clips, tmp_path / "work")
    assert {(stream.camera, stream.crf) for stream in found} == {("high", 19), ("low", 30)}


def test_each_episode_gets_its_own_crf_where_the_scope_is_the_episode(tmp_path, searches):
    clips = episodes(tmp_path / "in", high=[24, 19, 21])
    found = streams(clips, tmp_path / "work", CompressionSettings(scope="episode"))
    assert [stream.crf for stream in found] == [24, 19, 21]
    assert len(searches.calls) == 3


def test_a_crf_that_is_given_is_taken_without_rounds(tmp_path, searches):
    clips = episodes(tmp_path / "in", high=[40, 40, 40, 40])
    assert [stream.crf for stream in streams(clips, tmp_path / "work", CompressionSettings(crf=18))] == [18] * 4
    assert len(searches.calls) == 4


def test_one_episode_without_a_passing_crf_makes_its_camera_lossless(tmp_path, searches):
    clips = episodes(tmp_path / "in", high=[24, NONE_PASSES, 23, 24, 24])
    assert all(stream.lossless for stream in streams(clips, tmp_path / "work"))


def test_where_none_passes_in_the_chosen_pixel_format_the_best_one_gets_its_turn(tmp_path, searches, monkeypatch):
    Preferring("yuv420p10le", monkeypatch)
    clips = episodes(tmp_path / "in", high=[(20, 22), (20, 22), (20, 22), (17, NONE_PASSES), (20, 22)])
    found = streams(clips, tmp_path / "work")
    assert {(stream.pixel_format, stream.crf) for stream in found} == {(ALL, 17)}


def test_a_pixel_format_that_some_sizes_do_not_fit_is_not_agreed_on(tmp_path, monkeypatch):
    Preferring("yuv420p10le", monkeypatch)
    episodes(tmp_path / "in", high=[(20, 22)] * 5)
    for index in (0, 2, 3, 4):
        episode(tmp_path / f"in/{index}.hdf5", size=32, high=(20, 22))
    episode(tmp_path / "in/1.hdf5", size=17, high=21)  # not the one that chooses
    found = streams(clips_of(tmp_path / "in"), tmp_path / "work")
    assert {(stream.pixel_format, stream.crf) for stream in found} == {(ALL, 20)}


def test_a_codec_without_a_lossless_form_gets_the_pixel_format_that_loses_least(tmp_path, monkeypatch):
    Preferring("yuv420p", monkeypatch)
    clips = episodes(tmp_path / "in", high=[22, 22, 22, 21])
    found = streams(clips, tmp_path / "work", CompressionSettings(codec="av1"))
    assert {(stream.pixel_format, stream.crf) for stream in found} == {("yuv420p10le", 21)}


@pytest.mark.parametrize(("allowed", "agreed"), [([24, 23, 25], 20), ([24, 18, 25], 18)])
def test_episodes_that_join_others_are_encoded_as_these_are_or_below(tmp_path, searches, allowed, agreed):
    before = {"high": Bound(ALL, 10, 20)}
    clips = episodes(tmp_path / "in", high=allowed)
    assert {stream.crf for stream in streams(clips, tmp_path / "work", agreed=before)} == {agreed}
    assert searches.calls[0][1].upper == 20


def test_what_others_agreed_on_is_not_taken_where_the_pictures_do_not_fit_its_pixel_format(tmp_path, searches):
    (tmp_path / "in").mkdir()
    episode(tmp_path / "in/0.hdf5", size=17, high=24)
    before = {"high": Bound("yuv420p10le", 10, 20)}
    (found,) = streams(clips_of(tmp_path / "in"), tmp_path / "work", agreed=before)
    assert (found.pixel_format, found.crf, searches.calls[0][1].upper) == (ALL, 24, None)


class Preferring(Searches):
    """Searches that prefer a pixel format where they may choose it."""

    def __init__(self, pixel_format: str, patch: pytest.MonkeyPatch):
        super().__init__(patch)
        self.pixel_format = pixel_format

    def preferred(self, choices: Choices) -> str:
        return self.pixel_format if self.pixel_format in choices.pixel_formats else choices.pixel_formats[0]


def test_the_first_episode_chooses_and_the_others_are_encoded_with_that(tmp_path, searches):
    clips = episodes(tmp_path / "in", high=[19, 25, 20, 19, 25])
    streams(clips, tmp_path / "work")
    assert [choices.upper for _, choices in searches.calls] == [None, 19, 19, 19, 19]
    assert {choices.pixel_formats for _, choices in searches.calls[1:]} == {(ALL,)}


def test_a_stricter_limit_lowers_all_and_re_encodes_only_clips_above_it(tmp_path, searches):
    clips = episodes(tmp_path / "in", high=[24, 25, 20, 25, 25, 18, 25])
    assert {stream.crf for stream in streams(clips, tmp_path / "work")} == {18}
    calls = [(allowed, choices.upper) for allowed, choices in searches.calls]
    assert calls[1:4] == [(25, 24), (20, 24), (25, 24)]
    assert calls[4:7] == [(25, 20), (18, 20), (25, 20)]
    assert calls[7:] == [(24, 18), (25, 18), (20, 18), (25, 18), (25, 18), (25, 18)]


def test_the_episode_with_the_largest_pictures_is_the_first(tmp_path, searches):
    episodes(tmp_path / "in", high=[24, 23, 21])
    episode(tmp_path / "in/1.hdf5", frames=9, high=23)
    episode(tmp_path / "in/2.hdf5", size=32, high=21)
    streams(clips_of(tmp_path / "in"), tmp_path / "work")
    assert [allowed for allowed, _ in searches.calls] == [21, 24, 23]


# --- order, progress, memory ---------------------------------------------------------------------------


class LastFirst(SameProcess):
    """Finishes tasks in another order than they were submitted in."""

    def results(self):
        while self._waiting:
            yield self._work(self._waiting.pop())


def test_videos_and_trials_come_in_order_regardless_of_finishing_order(tmp_path, searches, monkeypatch):
    clips = episodes(tmp_path / "in", high=[24, 20, 22, 24], low=[9, 9, 8, 9])
    found = search_data_set(clips, SEARCHED, tmp_path / "a", workers=1)
    monkeypatch.setattr("vcage.datasets.packing.dataset_search.SameProcess", LastFirst)
    again = search_data_set(clips, SEARCHED, tmp_path / "b", workers=1)
    assert list(again) == [clip.key for clip in clips]
    assert [video.stream for video in again.values()] == [video.stream for video in found.values()]


def test_progress_never_claims_more_clips_than_there_are(tmp_path, searches):
    clips = episodes(tmp_path / "in", high=[24, 20, 22, 18, 25])
    told: list[tuple[str, int, int]] = []
    streams(clips, tmp_path / "work", progress=lambda *step: told.append(step))
    assert [number for _, number, _ in told] == [0, 0, 1, 0, 1, 2, 3, 4]
    assert {total for *_, total in told} == {5}


def test_progress_counts_the_first_episode_of_every_camera(tmp_path, searches):
    clips = episodes(tmp_path / "in", high=[24, 24], low=[9, 9])
    told: list[int] = []
    streams(clips, tmp_path / "work", progress=lambda _what, number, _total: told.append(number))
    assert told == [0, 1, 2, 3]


def test_there_is_at_least_one_worker_and_never_more_than_cores(tmp_path, searches, monkeypatch):
    clips = episodes(tmp_path / "in", high=[24] * 4)
    monkeypatch.setattr("vcage.datasets.packing.dataset_search.cores", lambda: 3)
    monkeypatch.setattr("vcage.datasets.packing.dataset_search.free_memory", lambda: 10**12)
    assert workers_for(clips) == 3
    monkeypatch.setattr("vcage.datasets.packing.dataset_search.free_memory", lambda: 1)
    assert workers_for(clips) == 1


def test_there_are_no_more_processes_than_clips(tmp_path, searches, monkeypatch):
    clips = episodes(tmp_path / "in", high=[24])
    monkeypatch.setattr("vcage.datasets.packing.dataset_search.cores", lambda: 16)
    assert workers_for(clips) == workers_for(clips, 8) == 1


# --- taken up again ------------------------------------------------------------------------------------


def test_a_search_that_broke_off_goes_on_and_ends_with_the_same_bytes(tmp_path, searches, monkeypatch):
    clips = episodes(tmp_path / "in", high=[24, 20, 22, 18, 25, 21], low=[30, 30, 29, 31, 30, 28])
    whole = {
        key: video.file.read_bytes()
        for key, video in search_data_set(clips, SEARCHED, tmp_path / "whole", workers=1).items()
    }
    needed = len(searches.calls)
    for stop in (1, 4, 8, needed - 1):
        folder = tmp_path / f"broken{stop}"
        searches.calls.clear()
        perform = _stopping(stop)
        with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
            patch.setattr("vcage.datasets.packing.dataset_search.perform", perform)
            search_data_set(clips, SEARCHED, folder, workers=1)
        again = {
            key: video.file.read_bytes() for key, video in search_data_set(clips, SEARCHED, folder, workers=1).items()
        }
        assert again == whole
        assert len(searches.calls) == needed


def _stopping(after: int):
    """``perform`` that is interrupted after some clips."""
    done = []

    def perform(task):
        if len(done) == after:
            raise KeyboardInterrupt
        done.append(task)
        return clip_module.perform(task)

    return perform


def test_a_finished_search_searches_nothing_again(tmp_path, searches):
    clips = episodes(tmp_path / "in", high=[24, 20, 22, 18])
    search_data_set(clips, SEARCHED, tmp_path / "work", workers=1)
    searches.calls.clear()
    search_data_set(clips, SEARCHED, tmp_path / "work", workers=1)
    assert searches.calls == []


@pytest.mark.parametrize("what", ["the input", "the settings"])
def test_results_of_other_inputs_or_options_are_not_reused(tmp_path, searches, what):
    clips = episodes(tmp_path / "in", high=[24, 20])
    search_data_set(clips, SEARCHED, tmp_path / "work", workers=1)
    chosen = SEARCHED
    if what == "the input":
        clips = episodes(tmp_path / "in", high=[12, 11])
    else:
        chosen = CompressionSettings(effort="fast", scope="episode", max_loss=0.2)
    searches.calls.clear()
    streams(clips, tmp_path / "work", chosen)
    assert searches.calls


def test_a_video_that_was_cut_off_is_made_again(tmp_path, searches):
    clips = episodes(tmp_path / "in", high=[24, 24])
    video = next(iter(search_data_set(clips, SEARCHED, tmp_path / "work", workers=1).values())).file
    content = video.read_bytes()
    video.write_bytes(content[:3])
    search_data_set(clips, SEARCHED, tmp_path / "work", workers=1)
    assert video.read_bytes() == content


def test_a_record_that_was_cut_off_is_made_again(tmp_path, searches):
    clips = episodes(tmp_path / "in", high=[24, 24])
    record = next(iter(search_data_set(clips, SEARCHED, tmp_path / "work", workers=1).values())).file.with_suffix(
        ".json"
    )
    content = record.read_bytes()
    record.write_bytes(content[:30])
    search_data_set(clips, SEARCHED, tmp_path / "work", workers=1)
    assert record.read_bytes() == content


# --- what is missing, and processes --------------------------------------------------------------------


def test_an_unknown_display_is_refused_before_any_work(tmp_path):
    clips = episodes(tmp_path / "in", high=[24])
    with pytest.raises(UnknownName, match="display 'cinema'"):
        search_data_set(clips, CompressionSettings(display="cinema"), tmp_path / "work")
    assert not (tmp_path / "work").exists()


def test_an_encoder_that_the_build_lacks_is_named_before_any_work(tmp_path, monkeypatch):
    clips = episodes(tmp_path / "in", high=[24])
    monkeypatch.setattr(av, "codecs_available", av.codecs_available - {"libx265"})
    with pytest.raises(MissingDependency, match="libx265"):
        search_data_set(clips, CompressionSettings(), tmp_path / "work")
    assert not (tmp_path / "work").exists()


def test_a_recording_that_only_decoding_shows_to_be_damaged_is_named(tmp_path, searches):
    clips = episodes(tmp_path / "in", high=[24, 24])
    with open(clips[1].recording.path, "r+b") as handle:
        handle.truncate(100)
    with pytest.raises(DamagedFile, match=r"1\.hdf5") as damaged:
        search_data_set(clips, SEARCHED, tmp_path / "work", workers=1)
    assert damaged.value.details["recording"] == "1"


def test_two_processes_find_the_same_as_one(tmp_path):
    add_camera(act_folder(tmp_path / "in", "a") / "a.hdf5", "cam_low")
    for workers in (1, 2):
        search_data_set(clips_of(tmp_path / "in"), settings(), tmp_path / str(workers), workers=workers)
    assert digests(tmp_path / "1") == digests(tmp_path / "2")
