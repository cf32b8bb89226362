"""One episode of a collection: its world, its light, the closed loop, and the files that it leaves."""

from __future__ import annotations

import gc
import logging
import platform
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from vcage.base.files import RunFolder
from vcage.base.pictures import write_picture
from vcage.base.time_limit import TimeIsUp, time_limit
from vcage.base.version import __version__
from vcage.datasets.hdf5 import write_episode
from vcage.plans.actions import lasting
from vcage.schema.episodes import Attempt, Episode, Verdict
from vcage.schema.goals import Goal, in_steps
from vcage.schema.plan import Relation
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Chain, Subtask, Subtasks
from vcage.sim.replay import camera_paths, render_log
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.stages.context import StageContext
from vcage.stages.episode_store import background_name
from vcage.stages.inputs import read_plan
from vcage.stages.layouts import Layout, Layouts, NoLayout
from vcage.stages.photographs import Photographer, light_look
from vcage.stages.possible import settled_record
from vcage.stages.question import Asking, verdict
from vcage.stages.stage import Job
from vcage.tasks.assemble import episode_data
from vcage.tasks.ground import Ground
from vcage.tasks.loop import EpisodeRun, Seen, Setting, run_episode
from vcage.tasks.readiness import ready_for
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import Slot, slots_for_chain
from vcage.tasks.synthesis import Script, load_script
from vcage.tasks.task import Asked
from vcage.tasks.variation import shifted_poses

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class _Work:
    """What the episodes of a chain do.

    Args:
        text: what that is called.
        steps: sub-tasks with their scripts, in order.
        scene: as it must be before the first.
        goals: what must be true at the end.
        layouts: draws where things start.
    """

    text: str
    steps: list[tuple[Subtask, Script]]
    scene: Scene
    goals: list[Goal]
    layouts: Layouts | None

    @classmethod
    def of(
        cls,
        chain: Chain,
        kept: Mapping[str, Subtask],
        scene: Scene,
        relations: Sequence[Relation] | None,
        run: RunFolder,
        context: StageContext,
    ) -> _Work:
        """The scripts of a chain, and where it starts: an instruction's where the scene is, as its plan has proven.

        ``relations`` are those of the plan that layouts keep which are drawn; None where none are.
        """
        steps = [(kept[name], load_script(run.root / kept[name].script)) for name in chain.subtasks]
        start = ready_for(steps[0][0], scene, context.objects(scene))
        goals = lasting(in_steps(scene.goals) or [subtask.goals for subtask, _ in steps])
        layouts = None if relations is None else Layouts(start, relations, [subtask for subtask, _ in steps], context)
        return cls(chain.text, steps, start, goals, layouts)


@dataclass(frozen=True)
class _Start:
    """Where an episode begins.

    Args:
        scene: with its objects there.
        objects: of the scene.
        slots: where each sub-task puts its object, by its id.
        layout: what was drawn; None where it is the run's with small shifts.
        refused: why layouts that were drawn were not taken: reason → how many.
    """

    scene: Scene
    objects: dict[str, SceneObject]
    slots: dict[str, Slot]
    layout: Layout | None
    refused: dict[str, int]


class EpisodeRunner:
    """Runs the episodes of a collection, with what all of them share.

    Args:
        stage: the collection; its options say what follows a failed sub-task, and the frames per second.
        context: the library and the models.
        limit_s: seconds after which an episode is given up.
    """

    def __init__(self, stage: Job, context: StageContext, limit_s: float):
        run = stage.run
        self._stage, self._context, self._limit_s = stage, context, limit_s
        self._scene = Scene.read(run.layout)
        self._robot = load_robot(self._scene.robot)
        self._models = context.physical_models(self._scene)
        subtasks = Subtasks.read(run.subtasks)
        kept = {s.id: s for s in subtasks.kept}
        self._edited = subtasks.edited
        varied = stage.options["layout"] == "varied" and run.plan.exists()  # a script that runs alone has no plan
        relations = read_plan(run, Scene.read(run.scene), context).relations if varied else None
        self._chains = [_Work.of(chain, kept, self._scene, relations, run, context) for chain in subtasks.chains]

    def one(self, index: int, folder: Path) -> tuple[Episode, list[Attempt]]:
        """Run an episode and write its files; one that takes too long is rejected, and nothing of it is kept."""
        try:
            with time_limit(self._limit_s):
                return self._run(index, folder)
        except TimeIsUp:
            reason = f"given up after {self._limit_s:g} s"
            logger.warning("episode %d: %s", index, reason)
            fps = self._stage.options["fps"]
            chain = index % len(self._chains)
            return Episode(index=index, chain=chain, seed=self._stage.seed, accepted=False, reason=reason, fps=fps), []
        finally:
            gc.collect()  # worlds refer to themselves, and Python does not count what a driver holds for them

    def _run(self, index: int, folder: Path) -> tuple[Episode, list[Attempt]]:
        work = self._chains[index % len(self._chains)]
        rng = np.random.default_rng([self._stage.seed, index])
        start = self._start(work, rng)
        look = light_look(start.scene, self._models, self._robot, rng)
        photographer = Photographer(start.scene, self._models, self._robot, look)
        background = photographer.empty_table()
        write_picture(folder / background_name(index), background)
        setting = Setting(
            build=lambda: World.of_scene(start.scene, self._models, self._robot),
            objects=start.objects,
            slots=start.slots,
            photograph=photographer.shots,
            judge=lambda asked, subtask, seen: self._judge(start.scene, asked, subtask, seen, background),
            on_failure=self._stage.options["on_failure"],
            retries=self._stage.options["retries"],
            fps=self._stage.options["fps"],
        )
        done = run_episode(setting, work.steps, index, work.goals)
        for name, picture in done.pictures.items():
            write_picture(folder / name, picture)
        return self._write(done, index, work, start, photographer.world, folder), done.attempts

    def _start(self, work: _Work, rng: np.random.Generator) -> _Start:
        """A layout that is drawn, with the grasps and slots that are feasible there; or the run's."""
        objects = {o.id: o for o in self._context.objects(work.scene)}
        layout, refused = None, {}
        if work.layouts is not None:
            try:
                layout = work.layouts.draw(rng)
                refused = layout.refused
            except NoLayout as error:
                logger.warning("%s: objects stand as optimised, with small shifts", error.message)
                refused = error.details["refused"]
        poses = shifted_poses(list(objects.values()), rng) if layout is None else layout.poses
        objects = {name: o.moved(poses[name]) for name, o in objects.items()}
        records = [settled_record(o.record, o.pose, self._context) for o in objects.values()]
        scene = work.scene.model_copy(update={"objects": records})
        for subtask, script in work.steps:
            if script.path.name not in self._edited:
                script.try_grasps(subtask.grasps if layout is None else layout.grasps[subtask.id])
        if layout is not None:
            return _Start(scene, objects, layout.slots, layout, refused)
        chain = [subtask for subtask, _ in work.steps]
        slots = slots_for_chain(chain, list(objects.values()), self._robot, Ground.of(scene), rng)
        return _Start(scene, objects, slots, None, refused)

    def _judge(self, scene: Scene, asked: Asked, subtask: Subtask, seen: Seen, background: np.ndarray) -> Verdict:
        told = (seen, background, subtask.requires, subtask.grasped)
        return verdict(self._context, scene, Asking(asked.text, asked.goals, *told))

    def _write(self, done: EpisodeRun, index: int, work: _Work, start: _Start, drawn: World, folder: Path) -> Episode:
        """Write the HDF5: with pictures when accepted, states alone when not."""
        name = f"episode_{index:06d}.hdf5" if done.accepted else f"rejected/episode_{index:06d}.hdf5"
        frames = len(done.log)
        if frames:
            cameras = camera_paths(drawn, done.log.states()) if done.accepted else {}
            data = episode_data(done.log, done.segments, cameras, self._facts(index, work, start, done))
            pictures: Iterator[Mapping[str, np.ndarray]] = iter([{}] * frames)
            if done.accepted:
                pictures = (frame.pictures for frame in render_log(drawn, done.log))
            write_episode(folder / name, data, pictures)
        return Episode(
            index=index,
            chain=index % len(self._chains),
            seed=self._stage.seed,
            accepted=done.accepted,
            reason=done.reason,
            file=self._stage.inside(name) if frames else None,
            frames=frames,
            fps=self._stage.options["fps"],
            subtasks=[segment.subtask for segment in done.segments],
            verdicts=[segment.verdict for segment in done.segments],
            attempts=len(done.attempts),
            goals_hold=done.goals_hold,
            layout="fixed" if start.layout is None else "varied",
            layouts_refused=start.refused,
            poses={o.id: o.pose for o in start.scene.objects},
        )

    def _facts(self, index: int, work: _Work, start: _Start, done: EpisodeRun) -> dict[str, Any]:
        """What travels inside the episode."""
        return {
            "instruction": work.text,
            "seed": self._stage.seed,
            "episode": index,
            "accepted": done.accepted,
            "reason": done.reason,
            "robot": self._scene.robot,
            "scene": start.scene.model_dump(mode="json", by_alias=True),
            "wordings": {subtask.id: [subtask.text, *subtask.texts] for subtask, _ in work.steps},
            "providers": self._context.models.providers("reasoner", "editor", "detector", "embedder", "critic"),
            "versions": versions(),
        }


def versions() -> dict[str, str]:
    """What made the data."""
    packages = ("sapien", "mani_skill", "mplib", "numpy")
    return {"vcage": __version__, "python": platform.python_version(), **{p: metadata.version(p) for p in packages}}
