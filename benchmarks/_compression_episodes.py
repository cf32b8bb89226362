"""Rendered episodes for the compression benchmark: real tasks, planned, simulated and drawn by the project itself.

Each task goes through the stages of the pipeline up to its sub-tasks and is then simulated; an episode counts when the
simulator's own state says that every sub-task succeeded. Light, table, floor and wall differ from episode to episode,
and objects stand a little differently. Episodes are kept in the user's cache, for drawing them takes minutes.
"""

from __future__ import annotations

import logging
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from vcage.base.errors import PartlyDone
from vcage.base.files import RunFolder, cache_dir
from vcage.datasets.hdf5 import write_episode
from vcage.episodes.photographs import light_look
from vcage.evaluation.expert import unwatched
from vcage.runs.context import StageContext
from vcage.schema.base import PoseRecord
from vcage.schema.robot import Robot
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask, Subtasks
from vcage.sim.appearance import Appearance
from vcage.sim.looks import appearance_of
from vcage.sim.replay import camera_paths, render_log
from vcage.sim.robots import load_robot
from vcage.sim.world import PHYSICS_HZ, World
from vcage.stages import chain, collect, inpaint_plan, match, optimize, search_subtasks, select_place
from vcage.tasks.assemble import episode_data
from vcage.tasks.chain_slots import slots_for_chain
from vcage.tasks.loop import EpisodeRun, run_episode
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.synthesis import Script, script_of
from vcage.tasks.variation import shifted_poses
from vcage.tasks.workplace import Workplace

logger = logging.getLogger(__name__)

ROBOT = "dual_panda"
"""The wrist cameras of the clips (:data:`benchmarks._compression_clips.VIEWS`) are those of its arms that do more."""

VERSION = 2
"""Of the episodes in the cache; a higher one makes them again."""

SIZE = (640, 480)
"""Width and height of the pictures, as most real robots record them; the robot's own cameras have half of it."""

FPS = 25
"""Frames per second: the fewest that are usual with real arms (LeRobot's data sets have 30, ALOHA's 50)."""

SPARSE_FPS = collect.Options().fps
"""Frames per second of a collection unless more are asked for; more changes from one to the next."""

SUBTASKS = 2
"""Number of sub-tasks that an episode carries out: reach, grasp, lift, carry, release, each about 7 seconds."""

FRAMES = 120
"""An episode is cut after this number of frames."""

STAGES = (select_place, inpaint_plan, match, optimize, search_subtasks)

TRIES = 4
"""Simulations of an episode, each from its own seed, until one succeeds."""


@dataclass(frozen=True)
class Recipe:
    """Content of an episode.

    Args:
        template: of the scene.
        instruction: the task in plain language.
        seed: of the layout, the shifts of the objects and the look.
        fps: frames per second.
    """

    template: str
    instruction: str
    seed: int
    fps: int = FPS

    @property
    def name(self) -> str:
        return f"{self.template}-{self.seed}-{self.fps}fps"


TASKS = (
    ("kitchen", "Take the salt shaker and the pepper mill and put them on the plate"),
    ("office_desk", "Pack the marker pens and the eraser into the box"),
    ("bathroom", "Put the soap and the sponge into the basket"),
    ("cashier_desk", "Put the cookie box and the chocolate bar into the shopping basket"),
    ("table", "Put the blocks on the plate"),
    ("table", "Put the cup and the lemon on the tray"),
)

RECIPES = tuple(Recipe(*task, len(TASKS) * turn + i) for turn in range(2) for i, task in enumerate(TASKS))
"""Twelve episodes: six tasks, each twice with other layouts and looks."""


def episode_path(recipe: Recipe) -> Path:
    """The HDF5 file of an episode, made when it is not in the cache.

    Raises:
        NoRenderer: nothing here can draw.
        PartlyDone: no simulation of the task succeeded.
    """
    path = cache_dir("benchmarks", "compression", f"v{VERSION}") / f"{recipe.name}.hdf5"
    if not path.exists():
        start = time.perf_counter()
        frames = _Making(recipe).write(path)
        logger.info(
            "%s: %d frames planned, simulated and drawn in %.0f s", path.name, frames, time.perf_counter() - start
        )
    return path


class _Making:
    """An episode on its way from the instruction to the file."""

    def __init__(self, recipe: Recipe):
        self._recipe = recipe
        context = StageContext("offline")
        with tempfile.TemporaryDirectory() as folder:
            run = RunFolder(folder)
            options = chain.ChainOptions(
                instruction=recipe.instruction,
                template=recipe.template,
                robot=ROBOT,
                seed=recipe.seed,
                models="offline",
            )
            for stage in STAGES:
                stage.execute(run, options, context)
            self._scene = Scene.read(run.layout)
            self._chain = _chain(run)
        self._models = context.physical_models(self._scene)
        self._robot = sharp(load_robot(self._scene.robot))
        self._objects = context.objects(self._scene)

    def write(self, path: Path) -> int:
        """Simulate until an episode succeeds, draw it, and return how many frames it has."""
        for attempt in range(TRIES):
            rng = np.random.default_rng([self._recipe.seed, attempt])
            poses = shifted_poses(self._objects, rng)
            objects = [o.moved(poses[o.id]) for o in self._objects]
            done = self._simulated(objects, rng)
            if done.accepted and all(segment.truth.success for segment in done.segments):
                return self._draw(done, objects, rng, path)
        raise PartlyDone(
            f"{self._recipe.name}: none of {TRIES} simulations succeeded", hint="choose another seed for the recipe"
        )

    def _simulated(self, objects: Sequence[SceneObject], rng: np.random.Generator) -> EpisodeRun:
        slots = slots_for_chain([subtask for subtask, _ in self._chain], Workplace.of(self._scene, objects, rng))
        setting = unwatched(lambda: self._world(objects), {o.id: o for o in objects}, slots, self._recipe.fps)
        setting = replace(setting, accept="critic", on_failure="resample", retries=2)
        return run_episode(setting, self._chain, self._recipe.seed)

    def _draw(self, done: EpisodeRun, objects: Sequence[SceneObject], rng: np.random.Generator, path: Path) -> int:
        look = appearance_of(light_look(self._scene, self._models, self._robot, rng))
        done.log.frames = done.log.frames[:FRAMES]
        for rows in done.log.drives.rows.values():
            del rows[FRAMES * PHYSICS_HZ // self._recipe.fps :]
        world = self._world(objects, look)
        facts = {
            "instruction": self._recipe.instruction,
            "seed": self._recipe.seed,
            "robot": self._robot.name,
            "scene": self._scene.model_dump(mode="json", by_alias=True),
        }
        data = episode_data(done.log, [], camera_paths(world, done.log.states()), facts)
        write_episode(path, data, (frame.pictures for frame in render_log(world, done.log)))
        return data.frames

    def _world(self, objects: Sequence[SceneObject], look: Appearance | None = None) -> World:
        """The table with the objects; drawn when it has a look."""
        records = [o.record.model_copy(update={"pose": PoseRecord.of(o.pose)}) for o in objects]
        scene = self._scene.model_copy(update={"objects": records})
        return World.of_scene(scene, self._models, self._robot, look, render=look is not None)


def _chain(run: RunFolder) -> list[tuple[Subtask, Script]]:
    """The first :data:`SUBTASKS` sub-tasks of a run, with their scripts."""
    subtasks = Subtasks.read(run.subtasks)
    kept = {s.id: s for s in subtasks.kept}
    return [(kept[i], script_of(kept[i])) for i in subtasks.chains[0].subtasks[:SUBTASKS]]


def sharp(robot: Robot) -> Robot:
    """The same robot with cameras of :data:`SIZE`."""
    width, height = SIZE
    cameras = {k: c.model_copy(update={"width": width, "height": height}) for k, c in robot.cameras.items()}
    return robot.model_copy(update={"cameras": cameras})
