"""A pick-and-place episode, without and with pictures, beside ManiSkill's motion-planning runner on StackCube."""

from __future__ import annotations

import logging
import os
import re
import subprocess
import sys
import tempfile
import time
from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from vcage.base.errors import VcageError
from vcage.base.geometry import Pose, world_aabb
from vcage.evaluation.expert import unwatched
from vcage.objects.library import Library
from vcage.schema.base import PoseRecord, Provenance
from vcage.schema.robot import Robot
from vcage.schema.scene import ObjectRecord, Role, Scene
from vcage.schema.subtasks import PairAnswer, PairQuestion, Subtask
from vcage.setup.vulkan import ensure_driver
from vcage.sim.bodies import Body
from vcage.sim.recording import StateLog
from vcage.sim.replay import render_log
from vcage.sim.robots import load_robot, load_template
from vcage.sim.world import World
from vcage.tasks.chain_slots import slots_for_chain
from vcage.tasks.loop import EpisodeRun, run_episode
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import find_subtasks
from vcage.tasks.synthesis import Script, load_script, write_script
from vcage.tasks.variation import shifted_poses
from vcage.tasks.workplace import Workplace

logger = logging.getLogger(__name__)

FPS = 10
"""Frames of a recording per second of simulated time."""

ROBOT = "dual_panda"
"""With the arm that ManiSkill's runner has."""

MANISKILL = (
    "import vcage.sim, runpy; runpy.run_module('mani_skill.examples.motionplanning.panda.run', run_name='__main__')"
)
"""``python -m mani_skill.examples.motionplanning.panda.run``, with SAPIEN's import as quiet as in our own process."""

PROGRESS = re.compile(r"(\d+)/\d+ \[")
"""Pattern of the trajectories that its progress bar counts as done."""


def run(quick: bool) -> dict[str, float]:
    """Mean wall times in seconds, each without the start of its process and its first episode.

    - ``seconds_per_episode``: the closed loop over one sub-task (a block onto a plate) with the generated script
      and a critic that accepts everything: building the world, settling, planning, simulating and recording,
      without pictures; the time of all runs divided by those in which the block really came to lie on the plate.
    - ``seconds_rendering``: drawing an episode's frames, :data:`FPS` per simulated second, with all three cameras.
    - ``maniskill_seconds_per_trajectory``: ManiSkill's runner on StackCube, one process, CPU simulation, no pictures,
      until as many trajectories succeeded; the time between two states of its progress bar. It is the same task on
      an empty table: one arm grasps a cube, carries it onto another and lets it go; the hand is not drawn back.
    - ``ratio``: ours without pictures divided by ManiSkill's.

    Args:
        quick: fewer repetitions.
    """
    count = 8 if quick else 30
    bench = _Episodes()
    bench.one(0)  # kinematics and meshes are loaded once per process
    half = count // 2
    before, first = _timed(bench, range(1, half + 1))
    theirs = _maniskill(count)
    after, second = _timed(bench, range(half + 1, count + 1))  # so that a machine that grows busy is busy for both
    runs, elapsed = [*first, *second], before + after
    done = [r for r in runs if r.accepted and all(s.truth.success for s in r.segments)]
    if not done:
        raise VcageError(f"no episode of {count} succeeded: {runs[0].reason}")
    logger.info("%d of %d episodes succeeded, %.1f s", len(done), count, elapsed)
    ours = elapsed / len(done)
    return {
        "seconds_per_episode": round(ours, 3),
        "seconds_rendering": round(bench.seconds_rendering([r.log for r in done[: 1 if quick else 4]]), 2),
        "maniskill_seconds_per_trajectory": round(theirs, 3),
        "ratio": round(ours / theirs, 2),
    }


def _timed(bench: _Episodes, indices: range) -> tuple[float, list[EpisodeRun]]:
    """Seconds that some episodes took, and what came of them."""
    start = time.perf_counter()
    runs = [bench.one(index) for index in indices]
    return time.perf_counter() - start, runs


# --- ours ----------------------------------------------------------------------------------------------


class _Episodes:
    """Episodes of one sub-task, with all that they share made beforehand."""

    def __init__(self) -> None:
        self._robot: Robot = load_robot(ROBOT)
        self._objects = [
            _object("block_red", "block", "red", "content", (-0.2, -0.05)),
            _object("plate_white", "plate", "white", "receptacle", (0.05, 0.05)),
        ]
        self._scene = _scene([o.record for o in self._objects])
        self._step = self._made()

    def one(self, index: int) -> EpisodeRun:
        """Run an episode; objects stand a little differently in each."""
        rng = np.random.default_rng(index)
        poses = shifted_poses(self._objects, rng)
        objects = [o.moved(poses[o.id]) for o in self._objects]
        slots = slots_for_chain([self._step[0]], Workplace.of(self._scene, objects, rng))
        setting = unwatched(lambda: self._world(objects), {o.id: o for o in objects}, slots, FPS)
        return run_episode(replace(setting, accept="critic", on_failure="resample", retries=2), [self._step], index)

    def seconds_rendering(self, logs: Sequence[StateLog]) -> float:
        """Mean time to draw a recording."""
        drawn = self._world(self._objects, render=True)
        next(render_log(drawn, logs[0]))  # shaders are compiled with the first pictures
        start = time.perf_counter()
        frames = sum(1 for recording in logs for _ in render_log(drawn, recording))
        elapsed = time.perf_counter() - start
        logger.info("%d frames of %d cameras drawn in %.1f s", frames, len(self._robot.cameras), elapsed)
        return elapsed / len(logs)

    def _world(self, objects: Sequence[SceneObject], render: bool = False) -> World:
        bodies = {o.id: Body(o.asset.model, o.pose) for o in objects}
        return World(self._scene.table, bodies, self._robot, render=render)

    def _made(self) -> tuple[Subtask, Script]:
        """The sub-task that the search keeps, and its generated script."""
        workplace = Workplace.of(self._scene, self._objects, np.random.default_rng(0))
        (subtask,) = find_subtasks(workplace, _sensible).kept
        with tempfile.TemporaryDirectory() as folder:
            return subtask, load_script(write_script(subtask, self._scene, Path(folder) / "subtask.py"))


def _object(key: str, asset: str, variant: str, role: Role, xy: tuple[float, float]) -> SceneObject:
    """An object of the library on the table."""
    geometry = Library.load().asset(asset, variant)
    pose = Pose([*xy, load_template("table").table.height])
    lower, upper = world_aabb(geometry.bounds, pose).tolist()
    record = ObjectRecord(
        id=key,
        asset=asset,
        variant=variant,
        phrase=f"{variant} {asset}",
        role=role,
        pose=PoseRecord.of(pose),
        aabb=(tuple(lower), tuple(upper)),
    )
    return SceneObject(record, geometry, pose)


def _scene(records: Sequence[ObjectRecord]) -> Scene:
    template = load_template("table", ROBOT)
    return Scene(
        provenance=Provenance(producer="benchmark", seed=0),
        instruction="Put the block on the plate",
        template=template.name,
        robot=template.robot,
        table=template.table,
        workspace=template.workspace,
        top_camera=template.top_camera,
        objects=list(records),
    )


def _sensible(questions: Sequence[PairQuestion]) -> list[PairAnswer]:
    return [
        PairAnswer(
            object=q.object,
            receptacle=q.receptacle,
            sensible=True,
            reason="it fits",
        )
        for q in questions
    ]


# --- ManiSkill's ---------------------------------------------------------------------------------------


def _maniskill(count: int) -> float:
    """Seconds per successful trajectory: from the first one on the progress bar to the last."""
    ensure_driver()
    with tempfile.TemporaryDirectory() as folder:
        options = f"-e StackCube-v1 -n {count + 1} --only-count-success --sim-backend cpu --record-dir {folder}"
        process = subprocess.Popen(
            [sys.executable, "-c", MANISKILL, *options.split()],
            cwd=folder,
            env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
        )
        try:
            reached, said = _watch(process)
        finally:
            process.kill()
            code = process.wait()
    if code != 0 or count + 1 not in reached:
        raise VcageError(f"ManiSkill's runner ended with {code}: {said}", hint="run: vcage doctor")
    elapsed = reached[count + 1] - reached[1]
    logger.info("ManiSkill: %d trajectories in %.1f s", count, elapsed)
    return elapsed / count


def _watch(process: subprocess.Popen[bytes]) -> tuple[dict[int, float], str]:
    """When the progress bar first showed each number of trajectories, and the last that the process said."""
    assert process.stderr is not None
    reached: dict[int, float] = {}
    tail: deque[str] = deque(maxlen=2000)
    while chunk := os.read(process.stderr.fileno(), 4096).decode(errors="replace"):
        tail.extend(chunk)
        for match in PROGRESS.finditer("".join(tail)):
            reached.setdefault(int(match[1]), time.perf_counter())
    process.wait()
    return reached, " ".join("".join(tail).split())[-300:]
