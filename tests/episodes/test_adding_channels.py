"""Depth and masks that are added to recorded episodes, beside those of a collection that took them at once."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest

from tests.run_folders import FPS, Finished, copied
from vcage.apps.channel_sheet import channel_sheet
from vcage.apps.replay import replay_episode
from vcage.base.channels import CHANNELS, DEPTH, RGB, SEGMENTATION
from vcage.base.errors import MissingStage, StaleStage, UnknownName
from vcage.base.files import RunFolder, sha256_file
from vcage.datasets.reader import EpisodeReader
from vcage.episodes.adding_channels import Gained, add_channels
from vcage.episodes.rendering import Order, render_run
from vcage.runs.context import StageContext
from vcage.runs.raw_pictures import originals
from vcage.runs.running import at_work, run_stage
from vcage.sim.robots import load_randomisation
from vcage.stages import collect, compress, export

pytestmark = pytest.mark.slow

FILE = "episodes/episode_000000.hdf5"
CONTEXT = StageContext("offline")


@pytest.fixture(scope="module")
def run(finished: Finished, tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    return copied(finished.run, tmp_path_factory.mktemp("adding") / "run")


@pytest.fixture(scope="module")
def gained(run: RunFolder) -> Gained:
    """Depth first, then masks too."""
    add_channels(run, [RGB, DEPTH])
    return add_channels(run, CHANNELS)


@pytest.fixture(scope="module")
def at_once(finished: Finished, tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    """The same collection with all channels."""
    run = copied(finished.run, tmp_path_factory.mktemp("at_once") / "run", before="collect")
    options = collect.Options(models="offline", episodes=1, fps=FPS, workers=1, channels=CHANNELS)
    run_stage(collect, run, options)
    return run


def test_what_is_added_equals_what_is_collected_at_once(run, gained, at_once):
    with EpisodeReader(run.file(FILE)) as later, EpisodeReader(at_once.file(FILE)) as collected:
        assert later.channels == collected.channels == CHANNELS
        assert later.episode.meta[SEGMENTATION] == collected.episode.meta[SEGMENTATION]
        for camera in collected.cameras:
            assert np.array_equal(later.depth(camera)[:], collected.depth(camera)[:])
            assert np.array_equal(later.segmentation(camera)[:], collected.segmentation(camera)[:])


def test_colour_and_numbers_are_the_same_with_and_without_channels(finished, at_once):
    with EpisodeReader(finished.run.file(FILE)) as without, EpisodeReader(at_once.file(FILE)) as collected:
        assert without.channels == (RGB,)
        for camera in without.cameras:
            assert without.recorded_digest(camera) == collected.recorded_digest(camera)
        assert without.episode.qpos.tobytes() == collected.episode.qpos.tobytes()
        assert without.episode.finger_forces["left"].tobytes() == collected.episode.finger_forces["left"].tobytes()


def test_all_else_of_the_file_stays(finished, run, gained):
    with EpisodeReader(finished.run.file(FILE)) as before, EpisodeReader(run.file(FILE)) as after:
        assert before.episode.digest() == after.episode.digest()
        for camera in before.cameras:
            assert not after.holds_pictures(camera), "compress moved them to a video, where they are still read"
            assert np.array_equal(before.images(camera)[3], after.images(camera)[3])


def test_the_table_names_every_id_that_occurs(run, gained):
    with EpisodeReader(run.file(FILE)) as reader:
        table = reader.episode.meta[SEGMENTATION]
        found = {int(n) for camera in reader.cameras for n in np.unique(reader.segmentation(camera)[:])}
        objects = {one["object"] for one in table.values() if one["kind"] == "object"}
        assert objects == {*reader.episode.object_poses}
    assert found - {0} <= {int(number) for number in table}


def test_an_object_is_where_its_mask_is(run, gained):
    """The middle of the masks of a thing and its pose in the camera agree, frame by frame."""
    with EpisodeReader(run.file(FILE)) as reader:
        episode, camera = reader.episode, reader.episode.cameras["cam_high"]
        table = episode.meta[SEGMENTATION]
        plate = next(int(n) for n, one in table.items() if one["object"].startswith("plate"))
        masks, checked = reader.segmentation("cam_high"), 0
        for frame in range(0, episode.frames, 7):
            v, u = np.nonzero(masks[frame] == plate)
            if len(v) < 400:
                continue
            checked += 1
            at = camera.extrinsics[frame] @ [*episode.object_poses[table[str(plate)]["object"]][frame, :3], 1]
            x, y = (camera.intrinsics @ at[:3])[:2] / at[2]
            assert u.min() < x < u.max() and v.min() < y < v.max()
    assert checked > 1


def test_the_summary_counts_bytes_by_channel(gained):
    assert gained.added == [FILE] and gained.colours_differ == {}
    assert gained.stored_bytes[RGB] == 0, "they are in videos"
    assert gained.stored_bytes[DEPTH] > gained.stored_bytes[SEGMENTATION] > 0


def test_a_call_that_is_killed_before_a_file_is_replaced_leaves_the_old_one(finished, tmp_path, monkeypatch):
    run = copied(finished.run, tmp_path / "run")
    before, path = sha256_file(run.file(FILE)), run.file(FILE)

    def killed(source: Path, target: Path) -> None:
        if target == path:
            raise KeyboardInterrupt
        Path(source).rename(target)

    with monkeypatch.context() as patched, pytest.raises(KeyboardInterrupt):
        patched.setattr(os, "replace", killed)
        add_channels(run, [DEPTH])
    assert sha256_file(run.file(FILE)) == before
    with at_work(run):  # which sweeps what was left
        assert add_channels(run, [DEPTH]).added == [FILE]
    assert sorted(path.suffix for path in run.file(FILE).parent.iterdir() if path.is_file()) == sorted(
        path.suffix for path in finished.run.file(FILE).parent.iterdir() if path.is_file()
    )
    assert originals(run)[sha256_file(run.file(FILE))] == originals(run)[before]


def test_an_episode_that_has_them_stays_as_it_is(run, gained):
    before = sha256_file(run.file(FILE))
    assert add_channels(run, CHANNELS).had == [FILE]
    assert sha256_file(run.file(FILE)) == before


def test_compress_has_nothing_to_do_then_and_export_reads_what_is_new(run, gained):
    record = compress.Compression.read(run.compression)
    settings = compress.CompressionSettings(**record.provenance.options)
    assert not compress.execute(run, compress.Options(compression=settings), CONTEXT).fresh
    with pytest.raises(StaleStage, match="another input episodes/episode_000000"):
        export.execute(run, export.Options(), CONTEXT)


def test_another_collection_of_more_channels_names_the_way_to_add_them(run, gained):
    options = collect.Options(models="offline", episodes=1, fps=FPS, workers=1, channels=CHANNELS)
    with pytest.raises(StaleStage, match="another option channels") as error:
        collect.execute(run, options, CONTEXT)
    assert f"render {run} --channels rgb depth segmentation" in error.value.hint


def test_depth_and_masks_are_replayed_too(at_once, tmp_path):
    path = shutil.copy(at_once.file(FILE), tmp_path / "episode.hdf5")
    with h5py.File(path, "r+") as file:
        file["observations/depth/cam_high"][2, 5, 6] += 7
        file["finger_forces/left"][3, 0] += 0.5
    found = replay_episode(path, CONTEXT)
    assert str(found.states) == "from frame 3 on the force on a finger of the left arm differs, by 0.5"
    other = found.pictures.pop("depth/cam_high")
    assert str(other) == "from frame 2 on the picture of depth/cam_high differs, by 7"
    assert [*found.pictures.values()] == ["equal"] * 11  # of three channels of four cameras


def test_renders_have_the_channels_that_are_asked_for(run, gained):
    order = Order(looks=1, ranges=load_randomisation("light"), seed=0, channels=CHANNELS)
    (render,) = render_run(run, order).renders
    with EpisodeReader(run.file(render.file)) as reader, EpisodeReader(run.file(FILE)) as own:
        assert reader.channels == CHANNELS
        assert reader.episode.meta[SEGMENTATION].keys() == own.episode.meta[SEGMENTATION].keys()
        assert own.episode.digest() == reader.episode.meta["render"]["sha256"]


def test_the_sheet_has_a_row_for_each_channel(finished, run, gained):
    assert channel_sheet(finished.run.file(FILE)) is None
    sheet = channel_sheet(run.file(FILE))
    assert sheet is not None and sheet.shape[1] > 1600 and sheet.shape[0] > 1200


def test_episodes_that_are_not_there_are_named(run, finished, tmp_path):
    with pytest.raises(UnknownName, match="unknown episode '7'"):
        add_channels(run, CHANNELS, [7])
    with pytest.raises(MissingStage, match="does not exist"):
        add_channels(copied(finished.run, tmp_path / "none", before="collect"), CHANNELS)
