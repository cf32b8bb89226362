"""Collecting: the contents of an episode file, and how a collection resumes, grows, fails and restarts."""

from __future__ import annotations

import gc
import os
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from contextlib import suppress
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import psutil
import pytest

from tests.run_folders import FPS, INSTRUCTION, OPTIONS, Finished, clean_environment, copied, digests
from vcage.base.errors import DamagedFile, InputFileError, PartlyDone, StaleStage, UnknownName, UsageError
from vcage.base.files import RunFolder, read_json, sha256_file, write_json
from vcage.datasets.reader import EpisodeReader
from vcage.episodes import store as episode_store
from vcage.runs.edits import seal
from vcage.runs.running import run_stage
from vcage.schema.episodes import Attempt, CriticCounts, Episode, Episodes, Truth, Verdict
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtasks
from vcage.stages import collect, search_subtasks

KILLS = 3
WITH_WORKERS = ["collect", "--models", "offline", "--episodes", "2", "--fps", str(FPS), "--workers", "2"]
CAMERAS = ["cam_high", "cam_left_wrist", "cam_right_wrist", "front"]


def options(**changes: Any) -> collect.Options:
    return collect.Options(**{"models": "offline", "episodes": 1, "fps": FPS, "workers": 1, **changes})


# --- what a real episode holds -------------------------------------------------------------------------


@pytest.fixture(scope="module")
def reader(finished: Finished):
    with EpisodeReader(finished.run.root / Episodes.read(finished.run.episodes).episodes[0].file) as reader:
        yield reader


def test_the_episode_was_accepted(finished):
    (episode,) = Episodes.read(finished.run.episodes).episodes
    assert episode.accepted and episode.frames > 20


def test_every_camera_sees_something_that_moves(reader):
    assert reader.cameras == CAMERAS
    for camera in CAMERAS:
        pictures = reader.images(camera)
        assert len(pictures) == reader.episode.frames
        assert pictures[0].std() > 10
        assert np.abs(pictures[:].astype(int) - pictures[0]).max() > 40


def test_time_stamps_are_evenly_spaced_from_zero(reader):
    assert np.allclose(reader.episode.timestamp, np.arange(reader.episode.frames) / FPS)


def test_state_and_action_stand_side_by_side_and_grippers_open_from_0_to_1(reader):
    episode = reader.episode
    shape = (episode.frames, len(episode.state_names))
    assert episode.qpos.shape == episode.qvel.shape == episode.action.shape == shape
    grippers = [i for i, name in enumerate(episode.state_names) if name.endswith("gripper")]
    for values in (episode.qpos[:, grippers], episode.action[:, grippers]):
        assert values.min() >= -0.01 and values.max() <= 1.01
    assert np.ptp(episode.action[:, grippers], axis=0).max() > 0.3


def test_the_segments_follow_the_chain_without_gaps_each_with_verdict_and_truth(finished, reader):
    segments = reader.episode.segments
    assert [s.subtask for s in segments] == Subtasks.read(finished.run.subtasks).chains[0].subtasks
    assert segments[0].start == 0
    assert all(a.end == b.start for a, b in pairwise(segments))
    assert segments[-1].end in (reader.episode.frames, reader.episode.frames - 1)
    assert all(s.verdict.accepted and s.verdict.provider == "offline" and s.truth.success for s in segments)


def test_the_file_says_by_itself_how_it_was_made(finished, reader):
    meta = reader.episode.meta
    assert (meta["instruction"], meta["seed"], meta["episode"]) == (INSTRUCTION, 0, 0)
    assert {"vcage", "python", "sapien", "mani_skill", "mplib", "numpy"} <= meta["versions"].keys()
    assert meta["providers"]["critic"] == "offline"
    scene = Scene.model_validate(meta["scene"])
    assert {o.id for o in scene.objects} == reader.episode.object_poses.keys()


def test_the_objects_end_where_the_task_wants_them(reader):
    poses, plate = reader.episode.object_poses, "plate_white"
    for name in (s.subtask.split("-")[0] for s in reader.episode.segments):
        assert np.linalg.norm(poses[name][-1, :2] - poses[plate][-1, :2]) < 0.15
        assert np.linalg.norm(poses[name][0, :2] - poses[plate][0, :2]) > 0.1


@pytest.mark.slow
def test_the_scenes_of_two_episodes_differ(finished, more):
    starts = []
    for index in (0, 1):
        with h5py.File(more.root / f"episodes/episode_{index:06d}.hdf5") as file:
            starts.append(np.stack([poses[0] for poses in file["objects"].values()]))
    assert not np.allclose(*starts, atol=1e-4)


def test_acceptance_and_the_critic_s_confusion_follow_from_the_log(finished):
    record = Episodes.read(finished.run.episodes)
    attempts = episode_store.read_log(finished.run.episodes.parent)
    assert record.attempts == len(attempts)
    assert sum(entry["attempts"] for entry in record.acceptance.values()) == len(attempts)
    assert sum(entry["accepted"] for entry in record.acceptance.values()) == sum(a.accepted for a in attempts)
    counts = record.critic
    assert counts.judged == sum(a.verdict is not None for a in attempts)
    assert counts.judged == counts.true_accepted + counts.false_accepted + counts.false_refused + counts.true_refused


def test_the_pictures_of_every_verdict_are_kept(finished):
    (episode,) = Episodes.read(finished.run.episodes).episodes
    pictures = [name for verdict in episode.verdicts for name in verdict.pictures]
    assert len(pictures) == 7 * len(episode.subtasks)  # before and after, from above and both wrists, and one let go
    assert all((finished.run.episodes.parent / name).is_file() for name in pictures)


# --- more of them --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def more(finished: Finished, tmp_path_factory) -> RunFolder:
    """The finished run, of which a second episode was asked later."""
    run = copied(finished.run, tmp_path_factory.mktemp("more") / "run")
    collect.execute(run, options(episodes=2), finished.context)
    return run


def test_asking_for_more_adds_to_the_existing_ones(finished, more):
    record = Episodes.read(more.episodes)
    assert sum(e.accepted for e in record.episodes) == 2
    before, after = (digests(run.root / "episodes") for run in (finished.run, more))
    assert after["episode_000000.hdf5"] == before["episode_000000.hdf5"]
    assert before.keys() < after.keys()


def _with_pictures(files: dict[str, str]) -> dict[str, str]:
    """All but the first episode, whose pictures became videos before the second was asked for."""
    return {name: digest for name, digest in files.items() if not name.startswith(("episode_000000.", "episodes.json"))}


@pytest.mark.slow
def test_collections_with_workers_killed_at_random_equal_undisturbed_ones(finished, more, tmp_path):
    rng, killed = np.random.default_rng(0), 0
    while killed < KILLS:
        run = copied(finished.run, tmp_path / f"run-{killed}", before="collect")
        while not run.episodes.exists():  # a call gives up when one episode lost all its tries
            killed += _killed_workers(run, rng, KILLS - killed)
        mine, theirs = (_with_pictures(digests(one.root / "episodes")) for one in (run, more))
        assert mine == theirs and "episode_000001.hdf5" in mine
        assert not list(run.root.glob("episodes.*"))


def _workers(process: int) -> list[int]:
    """Processes forked by the one that has their modules loaded."""
    with suppress(psutil.NoSuchProcess):
        return [worker.pid for server in psutil.Process(process).children() for worker in server.children()]
    return []


def _killed_workers(run: RunFolder, rng: np.random.Generator, most: int) -> int:
    """Call ``vcage collect`` and kill its workers at random moments, at most so many; returns how many were."""
    killed = 0
    with open(run.root.with_suffix(".log"), "ab") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", "vcage.cli.main", *WITH_WORKERS, "--run", str(run)],
            env=clean_environment(), stdout=log, stderr=log,
        )  # fmt: skip
        while process.poll() is None:
            time.sleep(float(rng.uniform(0.2, 2.5)) if killed < most else 0.1)
            workers = _workers(process.pid)
            if killed < most and workers:
                with suppress(ProcessLookupError):
                    os.kill(int(rng.choice(workers)), signal.SIGKILL)
                    killed += 1
    assert process.returncode in (0, PartlyDone.exit_code), run.root.with_suffix(".log").read_text()
    return killed


def test_asking_for_fewer_changes_nothing(finished, more):
    before = digests(more.root)
    assert not collect.execute(more, options(episodes=1), finished.context).fresh
    assert digests(more.root) == before


def test_another_way_of_failing_is_another_collection(finished):
    with pytest.raises(StaleStage, match="option on_failure"):
        collect.execute(finished.run, options(on_failure="abort"), finished.context)


# --- what stops a collection, with episodes that cost nothing ------------------------------------------


class Cheap:
    """In place of the simulation: episodes of a few bytes, accepted unless their index is in ``bad``."""

    bad: frozenset[int] = frozenset()
    stop_at: int | None = None
    made: list[int] = []

    def __init__(self, *_: Any):
        pass

    def one(self, index: int, folder: Path) -> tuple[Episode, list[Attempt]]:
        (folder / f"episode_{index:06d}.partial-1.hdf5").write_bytes(b"half")
        if index == self.stop_at:
            raise KeyboardInterrupt
        (folder / f"episode_{index:06d}.partial-1.hdf5").unlink()
        self.made.append(index)
        (folder / f"episode_{index:06d}.hdf5").write_text(f"episode {index}")
        return episode(index, index not in self.bad), [attempt(index, index not in self.bad)]


def episode(index: int, accepted: bool) -> Episode:
    return Episode(
        index=index, seed=0, accepted=accepted, reason="it slipped", file=f"episodes/episode_{index:06d}.hdf5",
        frames=3, fps=FPS, subtasks=["a-onto-b"], verdicts=[], attempts=1,
    )  # fmt: skip


def attempt(index: int, accepted: bool) -> Attempt:
    verdict = Verdict(accepted=accepted, reason="seen", confidence=1, provider="offline")
    return Attempt(
        episode=index, step=0, attempt=0, subtask="a-onto-b", object="a", asset="block", variant="red", arm="left",
        contact=0, stage="done" if accepted else "verify", reason="it slipped", accepted=accepted, steps=1,
        verdict=verdict, truth=Truth(success=index == 0, reason="so it is"),
    )  # fmt: skip


@pytest.fixture
def cheap(monkeypatch) -> type[Cheap]:
    kind = type("ThisCheap", (Cheap,), {"made": []})
    monkeypatch.setattr(collect, "EpisodeRunner", kind)
    return kind


@pytest.fixture
def begun(finished, tmp_path) -> RunFolder:
    return copied(finished.run, tmp_path / "run", before="collect")


def test_an_interrupted_collection_resumes_after_its_last_whole_episode(finished, begun, cheap):
    cheap.stop_at = 2
    with pytest.raises(KeyboardInterrupt):
        collect.execute(begun, options(episodes=4), finished.context)
    assert not begun.episodes.exists()
    cheap.stop_at = None
    record = collect.execute(begun, options(episodes=4), finished.context).record
    assert cheap.made == [0, 1, 2, 3] and len(record.episodes) == record.attempts == 4
    assert not [name for name in digests(begun.root) if "partial" in name]
    assert not list(begun.root.glob("episodes.*"))


def test_it_equals_an_uninterrupted_run(finished, begun, cheap, tmp_path):
    cheap.stop_at = 1
    with pytest.raises(KeyboardInterrupt):
        collect.execute(begun, options(episodes=2), finished.context)
    cheap.stop_at = None
    collect.execute(begun, options(episodes=2), finished.context)
    straight = copied(finished.run, tmp_path / "straight", before="collect")
    collect.execute(straight, options(episodes=2), finished.context)
    assert digests(begun.root) == digests(straight.root)


def test_half_done_work_of_another_mode_is_thrown_away(finished, begun, cheap):
    cheap.stop_at = 1
    with pytest.raises(KeyboardInterrupt):
        collect.execute(begun, options(episodes=2), finished.context)
    cheap.stop_at = None
    collect.execute(begun, options(episodes=2, on_failure="abort"), finished.context)
    assert cheap.made == [0, 0, 1]


@pytest.mark.parametrize("name", ["episodes.json", "log.jsonl"])
def test_a_damaged_leftover_is_thrown_away(finished, begun, cheap, name):
    cheap.stop_at = 1
    with pytest.raises(KeyboardInterrupt):
        collect.execute(begun, options(episodes=2), finished.context)
    (begun.root / "episodes.collecting" / name).write_text("{")
    cheap.stop_at = None
    collect.execute(begun, options(episodes=2), finished.context)
    assert cheap.made == [0, 0, 1]


def test_a_kill_while_earlier_episodes_are_taken_over_loses_none(finished, begun, cheap, monkeypatch):
    collect.execute(begun, options(episodes=2), finished.context)
    monkeypatch.setattr(shutil, "copytree", copy_the_index_and_die)
    with pytest.raises(KeyboardInterrupt):
        collect.execute(begun, options(episodes=3), finished.context)
    monkeypatch.undo()
    monkeypatch.setattr(collect, "EpisodeRunner", cheap)
    record = collect.execute(begun, options(episodes=3), finished.context).record
    assert all((begun.root / e.file).is_file() for e in record.episodes) and len(record.episodes) == 3


def copy_the_index_and_die(source: Path, target: Path, **_: Any) -> None:
    shutil.copy(source / "episodes.json", target)
    raise KeyboardInterrupt


def test_failed_episodes_are_made_up_for_and_counted(finished, begun, cheap):
    cheap.bad = frozenset({0, 2})
    record = collect.execute(begun, options(episodes=2), finished.context).record
    assert [e.accepted for e in record.episodes] == [False, True, False, True]
    assert record.acceptance == {"block/red": {"accepted": 2, "attempts": 4}}
    assert record.critic == CriticCounts.of([(True, False), (True, False), (False, True), (False, False)])


def test_a_collection_without_success_ends_and_says_why(finished, begun, cheap):
    cheap.bad = frozenset(range(100))
    with pytest.raises(PartlyDone, match=r"none of 6 episodes was verified: it slipped"):
        collect.execute(begun, options(episodes=2), finished.context)
    assert len(episode_store.read_log(begun.episodes.parent)) == 6


def test_only_episodes_that_may_be_needed_are_begun(finished, begun, cheap, monkeypatch):
    submitted = Submitted()
    monkeypatch.setattr(collect, "Processes", lambda *_: submitted)
    cheap.bad = frozenset({1, 2})
    submitted.order = [1, 0, 2, 3, 4]
    collect.execute(begun, options(episodes=3, workers=4), finished.context)
    assert [e.index for e in Episodes.read(begun.episodes).episodes] == [0, 1, 2, 3, 4]
    assert submitted.running == [3, 3, 2, 2, 1]


class Submitted:
    """In place of processes: finishes the tasks in an order of its own, and notes how many were running."""

    order: list[int]

    def __init__(self):
        self.tasks: dict[int, Any] = {}
        self.running: list[int] = []

    def __enter__(self):
        return self

    def __exit__(self, *_: object):
        assert not self.tasks

    def submit(self, task: Any) -> None:
        self.tasks[task.index] = task

    def results(self):
        for index in self.order:
            self.running.append(len(self.tasks))
            task = self.tasks.pop(index)
            yield Cheap.one(collect.EpisodeRunner(), task.index, task.folder)


def test_an_episode_that_takes_too_long_is_given_up_and_says_so(finished, begun):
    with pytest.raises(
        PartlyDone, match=r"none of 3 episodes was verified: given up after the 0\.05 s of --episode-limit"
    ):
        collect.execute(begun, options(episode_limit=0.05), finished.context)
    assert {episode.layout for episode in Episodes.read(begun.episodes).episodes} == {None}


# --- scripts -------------------------------------------------------------------------------------------


def first_script(run: RunFolder) -> Path:
    return run.subtasks.with_name(f"{Subtasks.read(run.subtasks).chains[0].subtasks[0]}.py")


@pytest.fixture
def script(begun) -> Path:
    """The first script of the chain, edited: executed, it leaves a file."""
    path = first_script(begun)
    path.write_text(f"open({str(begun.root / 'executed')!r}, 'w')\n{path.read_text()}")
    return path


@pytest.mark.parametrize("sealed", [False, True], ids=["edited", "edited and sealed"])
def test_no_script_of_a_run_is_executed(finished, begun, script, sealed):
    if sealed:
        seal(Subtasks.read(begun.subtasks), begun.subtasks)
    run_stage(search_subtasks, begun, search_subtasks.Options(models="offline"), finished.context)
    collect._runner(begun.root, options(), finished.context)
    assert not (begun.root / "executed").exists()


def test_a_named_script_is_executed_and_recorded_in_the_provenance(finished, begun, script):
    named = options(script=(script,))
    collect._runner(begun.root, named, finished.context)
    assert (begun.root / "executed").exists()
    told = collect.job(begun, named, finished.context).provenance().options
    assert told["scripts"] == {script.stem: sha256_file(script)}


def test_an_edited_but_unnamed_script_is_reported_with_the_way_out(finished, begun, script, cheap):
    (note,) = collect.execute(begun, options(), finished.context).notes
    assert f"subtasks/{script.name}" in note and note.endswith(f"--script {script}")
    assert not collect.execute(begun, options(script=(script,), force=True), finished.context).notes


def test_episodes_of_generated_scripts_do_not_count_for_a_named_one(finished):
    named = options(script=(first_script(finished.run),))
    with pytest.raises(StaleStage, match="option scripts"):
        collect.execute(finished.run, named, finished.context)


def test_a_damaged_named_script_is_reported_before_anything_is_collected(finished, begun, script):
    script.write_text("def play(:")
    with pytest.raises(DamagedFile, match=script.name):
        collect.execute(begun, options(script=(script,)), finished.context)
    assert not begun.episodes.exists()


def test_a_named_script_belongs_to_one_sub_task(finished, begun, script, tmp_path):
    other = tmp_path / "other.py"
    for named, error in (((other,), InputFileError), ((script, script), UsageError)):
        with pytest.raises(error):
            collect.job(begun, options(script=named), finished.context)
    other.write_text("")
    with pytest.raises(UnknownName, match="other"):
        collect.job(begun, options(script=(other,)), finished.context)


def test_force_makes_a_damaged_collection_again(finished, begun, cheap):
    collect.execute(begun, options(), finished.context)
    write_json(begun.episodes, {**read_json(begun.episodes), "attempts": -1})
    with pytest.raises(Exception, match="attempts") as caught:
        collect.execute(begun, options(), finished.context)
    assert caught.value.maker == "collect"
    assert collect.execute(begun, options(force=True), finished.context).fresh


def test_ranges_that_need_layouts_are_refused_where_none_are_drawn(finished: Finished):
    with pytest.raises(UsageError, match="not --layout fixed"):
        collect.job(finished.run, replace(OPTIONS, layout="fixed", randomise="full"), finished.context)


@pytest.mark.slow
def test_memory_does_not_grow_with_episodes(finished, tmp_path):
    runner = collect._runner(finished.run.root, options(), finished.context)
    held = []
    for index in (1, 2):
        runner.one(index, tmp_path)
        held.append(Counter(type(thing) for thing in gc.get_objects()))
    grown = {kind.__qualname__: number - held[0][kind] for kind, number in held[1].items()}
    assert {kind: number for kind, number in grown.items() if number > 20} == {}
