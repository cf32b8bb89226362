"""Recorded states drawn again under other looks."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from tests.recordings import HEIGHT, WIDTH, episode
from tests.run_folders import Finished, copied
from vcage.base.errors import MissingStage, UnknownName, UsageError
from vcage.base.files import RunFolder
from vcage.base.pictures import read_picture
from vcage.datasets.hdf5 import write_episode
from vcage.datasets.reader import EpisodeReader
from vcage.episodes.rendering import Order, render_run, write_sheet
from vcage.episodes.runner import versions
from vcage.schema.base import Provenance
from vcage.schema.episodes import Render, Renders
from vcage.schema.randomisation import Drawn
from vcage.sim.robots import load_randomisation

pytestmark = pytest.mark.slow

FULL = load_randomisation("full")


@pytest.fixture(scope="module")
def run(finished: Finished, tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    return copied(finished.run, tmp_path_factory.mktemp("rendering") / "run")


@pytest.fixture(scope="module")
def rendered(run: RunFolder) -> Renders:
    return render_run(run, Order(looks=2, ranges=FULL, seed=0))


def files(run: RunFolder, rendered: Renders) -> tuple[Path, list[Path]]:
    """The episode's own file, and those of its renders."""
    return next(run.root.glob("episodes/*.hdf5")), [run.root / one.file for one in rendered.renders]


def test_all_numbers_are_kept_but_where_the_cameras_are(run, rendered):
    own, drawn = files(run, rendered)
    with EpisodeReader(own) as before, EpisodeReader(drawn[0]) as after:
        was, now = before.episode, after.episode
        np.testing.assert_array_equal(was.qpos, now.qpos)
        np.testing.assert_array_equal(was.action, now.action)
        for name, poses in was.object_poses.items():
            np.testing.assert_array_equal(poses, now.object_poses[name])
        assert now.segments == was.segments
        for name, camera in was.cameras.items():
            assert not np.allclose(camera.extrinsics, now.cameras[name].extrinsics, atol=1e-4), name
            assert np.allclose(camera.extrinsics[:, :3, 3], now.cameras[name].extrinsics[:, :3, 3], atol=0.2), name


def test_each_look_is_another_and_is_recorded_with_the_world_of_the_episode(run, rendered):
    own, drawn = files(run, rendered)
    records = []
    for path in (own, *drawn):
        with EpisodeReader(path) as reader:
            meta = reader.episode.meta
        records.append(Drawn.model_validate(meta["randomisation"]))
        assert meta["scene"]["table"]["texture"] == records[-1].look.table_top
    assert len({record.look.model_dump_json() for record in records}) == 3
    assert all(record.ranges.endswith("full") for record in records[1:])
    assert all(record.world == records[0].world for record in records)


def test_existing_renders_are_kept_and_more_can_be_added(run, rendered):
    _, drawn = files(run, rendered)
    before = [path.stat().st_mtime_ns for path in drawn]
    more = render_run(run, Order(looks=3, ranges=FULL, seed=0))
    assert [path.stat().st_mtime_ns for path in drawn] == before
    assert len(more.renders) == 3


def test_the_index_names_the_renders_of_earlier_calls_with_their_ranges(run, rendered):
    light = render_run(run, Order(looks=1, ranges=load_randomisation("light"), seed=4))
    told = [(one.look, one.ranges, one.seed) for one in light.renders]
    assert told[:2] == [(0, "light", 4), (1, "full", 0)]
    assert Renders.read(run.root / "renders" / "renders.json") == light
    with EpisodeReader(run.root / light.renders[0].file) as reader:
        made = reader.episode.meta["render"]
    assert (made["ranges"], made["versions"]) == ("light", versions())
    render_run(run, Order(looks=2, ranges=FULL, seed=0))


@pytest.mark.parametrize("count", [1, 2])
def test_the_sheet_shows_an_episode_of_fewer_than_three_cameras(count, tmp_path):
    names = ["high", "wrist"][:count]
    usual = episode(4)
    data = replace(usual, cameras=dict.fromkeys(names, next(iter(usual.cameras.values()))))
    shown = [{name: np.full((HEIGHT, WIDTH, 3), 90, np.uint8) for name in names}] * 4
    write_episode(tmp_path / "renders" / "a.hdf5", data, shown)
    one = Render(episode=0, look=0, ranges="full", seed=0, file="renders/a.hdf5", frames=4)
    record = Renders(provenance=Provenance(producer="render", seed=0), renders=[one])
    picture = read_picture(write_sheet(RunFolder(tmp_path), record, tmp_path / "looks.png", columns=1))
    assert (picture == 90).all(axis=2).mean() > 0.5


def test_leftovers_of_a_killed_render_are_drawn_again(run, rendered):
    _, drawn = files(run, rendered)
    whole = drawn[1].read_bytes()
    drawn[1].write_bytes(whole[: len(whole) // 2])
    partial = drawn[1].with_name(f"{drawn[1].stem}.partial-999999999.hdf5")
    partial.write_bytes(b"begun")
    render_run(run, Order(looks=2, ranges=FULL, seed=0))
    assert drawn[1].read_bytes() == whole
    assert not partial.exists()


def test_renders_of_rejected_or_replaced_episodes_are_removed(run, rendered):
    _, drawn = files(run, rendered)
    refused, earlier = (drawn[0].with_name(f"episode_00000{n}-look_{m:03d}.hdf5") for n, m in ((9, 0), (0, 7)))
    for path, told in ((refused, {"episode": 9}), (earlier, {"sha256": "of another recording"})):
        shutil.copy2(drawn[0], path)
        with h5py.File(path, "r+") as file:
            made = {**json.loads(file["meta/render"][()]), **told}
            file["meta/render"][()] = json.dumps(made)
    again = render_run(run, Order(looks=1, ranges=FULL, seed=0))
    assert not refused.exists() and not earlier.exists()
    assert {*drawn} <= {run.root / one.file for one in again.renders}


def test_the_sheet_shows_every_look(run, rendered, tmp_path):
    picture = read_picture(write_sheet(run, rendered, tmp_path / "looks.png", columns=2))
    left, right = np.split(picture, 2, axis=1)
    assert np.abs(left.astype(int) - right).mean() > 5


def test_fewer_than_one_look_too_many_an_unknown_episode_and_a_run_without_episodes_are_refused(run, tmp_path):
    with pytest.raises(UsageError, match="looks"):
        render_run(run, Order(looks=0, ranges=FULL, seed=0))
    with pytest.raises(UsageError, match="looks"):
        render_run(run, Order(looks=20_000_000, ranges=FULL, seed=0))
    with pytest.raises(UnknownName, match="77"):
        render_run(run, Order(looks=1, ranges=FULL, seed=0, episodes=(77,)))
    with pytest.raises(MissingStage):
        render_run(RunFolder(tmp_path / "none"), Order(looks=1, ranges=FULL, seed=0))
