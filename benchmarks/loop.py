"""What the closed loop is worth: verified long trajectories per hour, failures planted so that steps succeed at a rate.

A chain of sub-tasks is carried out over and over, once trying again from the last verified state (``resample``), once
beginning anew at the first failure (``abort``), and once without looking (``open``). What was put down is taken away
again by hand in a share of the attempts, so that a step fails as often as is asked for, whoever looks. Once the critic
that looks at pictures judges, once one that is always right. Trajectories are counted that were accepted; ``false`` are
those in which some step had failed all the same. In theory, where steps succeed with p, resampling needs n / p attempts
for n steps and aborting (1 − pⁿ) / (1 − p) / pⁿ.
"""

from __future__ import annotations

import argparse
import logging
import tempfile
import time
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np

from benchmarks._laying_out import lay_out
from vcage.base.errors import VcageError
from vcage.base.files import RunFolder
from vcage.base.geometry import Pose
from vcage.plans.actions import lasting
from vcage.schema.episodes import Truth, Verdict
from vcage.schema.goals import in_steps
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask, Subtasks
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.stages import search_subtasks, select_place
from vcage.stages.context import StageContext
from vcage.stages.photographs import Photographer, episode_light
from vcage.stages.question import Asking, verdict
from vcage.stages.stage import ModelOptions
from vcage.tasks.events import Watch
from vcage.tasks.ground import Ground
from vcage.tasks.loop import EpisodeRun, PicturesByCamera, Seen, Setting, run_episode
from vcage.tasks.slots import slots_for_chain
from vcage.tasks.synthesis import Script, load_script
from vcage.tasks.task import Asked, Task
from vcage.tasks.truth import goals_hold

logger = logging.getLogger(__name__)

Mode = Literal["resample", "abort", "open"]
Critic = Literal["pictures", "perfect"]

CHAINS = {
    (6, 0.75): "Pick six blocks and put them in the packaging box",
    (10, 0.8): "Put six blocks and four marker pens in the packaging box",
}
"""(steps, share of attempts that succeed) → a sentence for as many."""

RETRIES = 12
"""Further attempts of a step: enough that hardly any chain ends for want of them."""

MOST_BEGUN = 100
"""A row ends when so many times the trajectories that are wanted were begun, with those that were accepted by then."""

FPS = 10


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What can be chosen."""
    parser.add_argument("--trajectories", type=int, help="accepted ones of each row (default: 8, with --quick 1)")


def run(quick: bool, trajectories: int | None = None) -> dict[str, Any]:
    """Rows for each chain, critic and what follows a failure.

    Args:
        quick: the shorter chain alone, and one trajectory of each row.
        trajectories: accepted ones of each row.
    """
    wanted = trajectories or (1 if quick else 8)
    rows = []
    for (steps, share), sentence in list(CHAINS.items())[: 1 if quick else None]:
        chain = _Chain(sentence, steps, share)
        for critic in ("pictures", "perfect"):
            rates: dict[str, float] = {}
            for mode in ("resample", "abort", "open"):
                if critic == "perfect" and mode == "open":
                    continue  # nobody looks
                row = chain.row(mode, critic, wanted)
                rates[mode] = row["per_hour"]
                rows.append(row)
            for row in rows[-len(rates) :]:
                row["over_abort"] = round(row["per_hour"] / rates["abort"], 2) if rates.get("abort") else None
    return {"rows": rows}


class _Chain:
    """A chain of sub-tasks in a scene, carried out again and again."""

    def __init__(self, sentence: str, steps: int, share: float):
        self._context = StageContext("offline")
        self._steps, self._share = steps, share
        with tempfile.TemporaryDirectory() as folder:
            run = RunFolder(Path(folder) / "run")
            lay_out(run, select_place.Options(instruction=sentence, models="offline"), self._context)
            search_subtasks.execute(run, ModelOptions(models="offline"), self._context)
            self._scene, found = Scene.read(run.layout), Subtasks.read(run.subtasks)
            kept = {subtask.id: subtask for subtask in found.kept}
            self._chain = [(kept[n], load_script(run.root / kept[n].script)) for n in found.chains[0].subtasks]
        if len(self._chain) != steps:
            raise VcageError(f"{sentence!r} became {len(self._chain)} sub-tasks, not {steps}")
        self._objects = self._context.objects(self._scene)
        self._by_id = {o.id: o for o in self._objects}
        self._known = Truth(success=False, reason="nothing was done yet")
        self._robot, self._models = load_robot(self._scene.robot), self._context.physical_models(self._scene)
        look = episode_light(np.random.default_rng(0))
        self._photographer = Photographer(self._scene, self._models, self._robot, look)
        self._empty = self._photographer.empty_table()

    def row(self, mode: Mode, critic: Critic, wanted: int) -> dict[str, Any]:
        """Trajectories until as many were accepted as are wanted."""
        rng = np.random.default_rng(7)
        accepted, false, attempts, failed, begun = 0, 0, 0, 0, time.perf_counter()
        for _ in range(wanted * MOST_BEGUN):
            if accepted == wanted:
                break
            done = self._one(mode, critic, rng)
            attempts += len(done.attempts)
            failed += sum(not (a.truth and a.truth.success) for a in done.attempts)
            accepted += done.accepted
            false += done.accepted and not all(s.truth.success for s in done.segments)
        seconds = time.perf_counter() - begun
        logger.info("%d steps, %s, %s: %d in %.0f s", self._steps, critic, mode, accepted, seconds)
        return {
            "steps": self._steps,
            "critic": "none" if mode == "open" else critic,
            "mode": mode,
            "accepted": accepted,
            "false": false,
            "attempts": attempts,
            "step_success": round(1 - failed / attempts, 3),
            "per_hour": round(accepted / seconds * 3600, 1),
            "true_per_hour": round((accepted - false) / seconds * 3600, 1),
        }

    def _one(self, mode: Mode, critic: Critic, rng: np.random.Generator) -> EpisodeRun:
        looks = critic == "pictures" and mode != "open"
        chain = [(s, replace(script, play=partial(self._play, s, script, rng))) for s, script in self._chain]
        slots = slots_for_chain([s for s, _ in chain], self._objects, self._robot, Ground.of(self._scene), rng)
        setting = Setting(
            build=lambda: World.of_scene(self._scene, self._models, self._robot),
            objects=self._by_id,
            slots=slots,
            photograph=self._photographer.shots if looks else _nothing,
            judge=self._judge if looks else _accept if mode == "open" else self._know,
            on_failure="resample" if mode == "resample" else "abort",
            retries=RETRIES,
            fps=FPS,
        )
        return run_episode(setting, chain, 0, lasting(in_steps(self._scene.goals)))

    def _play(self, subtask: Subtask, script: Script, rng: np.random.Generator, task: Task) -> None:
        """Carry out a script; then, sometimes, bring what was put down back and let it fall on the table."""
        world, was = task.world, task.world.object_pose(subtask.object)
        script.play(task)
        if rng.random() >= self._share:
            turn = Pose.from_yaw([0, 0, 0], float(rng.uniform(0.3, np.pi)))
            away = was.p + [*rng.uniform(-0.02, 0.02, 2), 0.02]
            world.set_object_pose(subtask.object, Pose(away, (turn * Pose(q=was.q)).q))
            world.settle()
        watch = Watch(world, self._by_id, subtask.goals)
        self._known = goals_hold(subtask.goals, {name: watch.now(name) for name in self._by_id}, watch)
        watch.stop()

    def _know(self, _asked: Asked, _subtask: Subtask, _seen: Seen) -> Verdict:
        known = self._known
        return Verdict(accepted=known.success, reason=known.reason, confidence=1.0, provider="benchmark")

    def _judge(self, asked: Asked, subtask: Subtask, seen: Seen) -> Verdict:
        told = (seen, self._empty, subtask.requires, subtask.grasped)
        return verdict(self._context, self._scene, Asking(asked.text, asked.goals, *told))


def _nothing(*_: Any) -> PicturesByCamera:
    return {}


def _accept(_asked: Asked, _subtask: Subtask, _seen: Seen) -> Verdict:
    return Verdict(accepted=True, reason="nobody looks here", confidence=1.0, provider="benchmark")
