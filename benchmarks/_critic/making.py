"""Makes outcomes: scenes are drawn, laid out and searched, sub-tasks carried out, and failures made of them."""

from __future__ import annotations

import copy
import logging
import tempfile
import zlib
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path

import numpy as np

from benchmarks._critic.kinds import FAILURES, RELATED
from benchmarks._critic.outcome import SUCCESS, Outcome, OutcomeRecord, neutral_id, picture_paths
from benchmarks._critic.played import HELD, Case, Shots
from benchmarks._critic.scenes import UNTOUCHED_SCENES, Draw, part_of, settings
from benchmarks._critic.ugly import UGLY
from benchmarks._laying_out import lay_out_placed
from vcage.base.errors import InfeasibleScene, UsageError, VcageError
from vcage.base.files import RunFolder
from vcage.episodes.photographs import Photographer, light_look
from vcage.runs.context import StageContext
from vcage.schema.base import PoseRecord
from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.stages import select_place
from vcage.tasks.chain_slots import slots_for_chain
from vcage.tasks.ground import Ground
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import find_subtasks, sensible
from vcage.tasks.setting import Seen
from vcage.tasks.stowing import ready_for
from vcage.tasks.synthesis import load_script, write_script
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.variation import shifted_poses
from vcage.tasks.wiping import flat_top
from vcage.tasks.workplace import Workplace

logger = logging.getLogger(__name__)

ASKED = 3
"""Number of goals in a scene of each kind that is sensible on request only."""


def outcomes(draw: Draw) -> list[Outcome]:
    """Make one or two successes per sub-task, where it succeeds, and as many failures; skip pairs that do not fit."""
    if draw.part == "tuning" and draw.scene in UNTOUCHED_SCENES:
        return []
    context, rng = _context(), np.random.default_rng([draw.seed, zlib.crc32(draw.scene.encode())])
    with tempfile.TemporaryDirectory() as folder:
        try:
            scene = _laid_out(draw, RunFolder(Path(folder) / "run"), context, rng)
        except UsageError as error:
            logger.warning("%s, draw %d, is left out: %s", draw.scene, draw.seed, error.message)
            return []
        return [] if scene is None else list(_made(draw, scene, Path(folder), context, rng))


@lru_cache(maxsize=1)
def _context() -> StageContext:
    return StageContext("offline")


def _laid_out(draw: Draw, run: RunFolder, context: StageContext, rng: np.random.Generator) -> Scene | None:
    """Lay out the scene of a draw; None if the draw names templates, and none has a sub-task for what is placed."""
    begun = replace(settings()[draw.scene], models="offline", seed=draw.seed, robot=draw.robot)
    select_place.execute(run, begun, context)
    again = copy.deepcopy(rng)  # the same goals are drawn once more in the layout
    if draw.templates and not _proposed(draw, Scene.read(run.scene), context, again):
        return None
    lay_out_placed(run, begun.seed, context)
    return Scene.read(run.layout)


def _proposed(draw: Draw, scene: Scene, context: StageContext, rng: np.random.Generator) -> bool:
    """True if a named template has a sub-task, feasible or not, of a thing of the wanted part of the outcomes."""
    objects, asked = _asked_of(scene, context, rng)
    judge = partial(context.models.reasoner.judge_pairs, instruction=scene.instruction)
    proposals, *_ = sensible(objects, judge, asked)
    return any(_of_part(draw, p.thing) for p in proposals if not set(draw.templates).isdisjoint(p.templates))


def _of_part(draw: Draw, thing: SceneObject) -> bool:
    return draw.part in ("all", part_of(draw.scene, thing.record.asset))


def _made(draw: Draw, scene: Scene, folder: Path, context: StageContext, rng: np.random.Generator) -> Iterator[Outcome]:
    own = {asked.goal for asked in scene.goals}
    objects, asked = _asked_of(scene, context, rng)
    judge = partial(context.models.reasoner.judge_pairs, instruction=scene.instruction)
    kept = find_subtasks(Workplace.of(scene, objects, rng), judge, asked).kept
    used: Counter[str] = Counter()
    wanted = [s for s in kept if s.template in (draw.templates or TEMPLATES)]
    of_part = {o.id for o in objects if _of_part(draw, o)}
    wanted = [s for s in wanted if s.object in of_part]
    for number, subtask in enumerate(_spread(wanted, own, rng)[: draw.subtasks]):
        name = f"{draw.scene}-{draw.seed:03d}-{number:02d}"
        try:
            yield from _Maker(draw, scene, subtask, kept, folder, context, rng, name).outcomes(used)
        except VcageError as error:
            logger.info("%s, %s: %s", name, subtask.id, error.message)


def _asked_of(scene: Scene, context: StageContext, rng: np.random.Generator) -> tuple[Sequence[SceneObject], set[Goal]]:
    """The objects of a scene, and the goals to try: its own, and some that are tried only on request."""
    objects = context.objects(scene)
    own = {asked.goal for asked in scene.goals}
    return objects, own | _asked(objects, sorted(load_robot(scene.robot).arms), rng)


def _asked(objects: Sequence[SceneObject], arms: Sequence[str], rng: np.random.Generator) -> set[Goal]:
    """Goals that are tried only on request."""
    others = [o for o in objects if o.record.container is None]
    carried = [o for o in others if o.asset.annotation.carrying_points and o.asset.standing is None]
    pushed = [o for o in others if not o.asset.annotation.carrying_points]
    found: set[Goal] = set()
    for _ in range(ASKED if len(carried) > 1 else 0):
        thing, handed, back, lifted, shaken = (carried[int(i)] for i in rng.integers(len(carried), size=5))
        found |= _beside(thing, others, rng)
        if back.id != shaken.id:
            found.add(Goal(subject=back.id, relation="in_place_of", reference=shaken.id))
        if len(arms) > 1:
            found.add(Goal(subject=handed.id, relation="handed", reference=arms[int(rng.integers(len(arms)))]))
        found |= {Goal(subject=back.id, relation="back"), Goal(subject=lifted.id, relation="lifted")}
        found |= {Goal(subject=shaken.id, relation=word) for word in ("shaken", *HELD, "moved_away", "centred")}
    for thing in pushed[:ASKED]:
        found |= _beside(thing, others, rng)
    found |= _asked_with_tools(others, carried)
    fronted = [o for o in carried if o.asset.annotation.front]
    found |= {Goal(subject=o.id, relation=word) for o in fronted[:ASKED] for word in ("presented", "facing_robot")}
    return found


def _asked_with_tools(others: Sequence[SceneObject], carried: Sequence[SceneObject]) -> set[Goal]:
    """Goals to hit and to wipe things, where there are tools for it."""
    found: set[Goal] = set()
    if any(o.asset.annotation.faces_of("head") for o in carried):
        hit = [o for o in others if not o.asset.annotation.faces_of("head")]
        found |= {Goal(subject=o.id, relation="hit") for o in hit[:ASKED]}
    if any(o.asset.annotation.faces_of("pad") for o in carried):
        wiped = [o for o in others if flat_top(o) is not None]
        found |= {Goal(subject=o.id, relation="wiped") for o in wiped[:ASKED]}
    return found


def _beside(thing: SceneObject, others: Sequence[SceneObject], rng: np.random.Generator) -> set[Goal]:
    """Draw the goal that a thing stands beside another in some way; nothing where that is the thing itself."""
    other = others[int(rng.integers(len(others)))]
    word = RELATED[int(rng.integers(len(RELATED)))]
    return {Goal(subject=thing.id, relation=word, reference=other.id)} if other.id != thing.id else set()


def _spread(kept: Sequence[Subtask], own: Collection[Goal], rng: np.random.Generator) -> list[Subtask]:
    """The sub-tasks, of each template in turn, those first that the scene's instruction asks for."""
    order = [kept[int(i)] for i in rng.permutation(len(kept))]
    seen: Counter[str] = Counter()
    turns = []
    for subtask in order:
        turns.append((subtask.goals[0] not in own, seen[subtask.template], subtask))
        seen[subtask.template] += 1
    return [subtask for _, _, subtask in sorted(turns, key=lambda turn: turn[:2])]


class _Maker:
    """Makes the outcomes of one sub-task."""

    def __init__(
        self,
        draw: Draw,
        scene: Scene,
        subtask: Subtask,
        kept: Sequence[Subtask],
        folder: Path,
        context: StageContext,
        rng: np.random.Generator,
        name: str,
    ):
        self._draw, self._subtask, self._rng, self._name = draw, subtask, rng, name
        robot, models = load_robot(scene.robot), context.physical_models(scene)
        ready = ready_for(subtask, scene, context.objects(scene))
        self._planned, objects = ready, context.objects(ready)
        objects = [o.moved(pose) for o, pose in zip(objects, shifted_poses(objects, rng).values(), strict=True)]
        self._scene = ready.model_copy(
            update={"objects": [o.record.model_copy(update={"pose": PoseRecord.of(o.pose)}) for o in objects]}
        )
        look = light_look(self._scene, models, robot, rng)
        self._photographer = Photographer(self._scene, models, robot, look, objects)
        self._empty = self._photographer.empty_table()
        ground = Ground.of(scene)
        slots = slots_for_chain([subtask], Workplace.of(scene, objects, rng))
        script = write_script(subtask, self._scene, folder / "subtasks" / f"{subtask.id}.py")
        away, start = {}, None
        leaves = {"back": subtask.object, "in_place_of": subtask.goals[0].reference}.get(subtask.goals[0].relation)
        if leaves is not None:
            start = World.of_scene(self._scene, models, robot).state()
            thing = next(o for o in objects if o.id == leaves)
            rest = [o for o in objects if o.id != thing.id]
            anywhere = Goal(subject=thing.id, relation="on", reference=TABLE)
            spot = next(iter(ground.poses(thing, anywhere, rest, rng, [thing.aabb[:, :2]])), None)
            if spot is None:
                raise InfeasibleScene(f"there is no room on the table to put {thing.record.phrase} aside")
            away = {thing.id: spot}

        def build() -> World:
            world = World.of_scene(self._scene, models, robot)
            for key, pose in away.items():
                world.set_object_pose(key, pose)
            return world

        self._case = Case(
            subtask=subtask,
            script=load_script(script),
            objects={o.id: o for o in objects},
            slots={subtask.object: slots[subtask.id]} if subtask.id in slots else {},
            build=build,
            others=[s for s in kept if s.id != subtask.id],
            rng=rng,
            start=start,
        )

    def outcomes(self, used: Counter[str]) -> Iterator[Outcome]:
        """Yield the robot's own outcome, an ugly success, and two failures of the kinds that were ``used`` least."""
        played = self._case.play()
        failures = 0
        if played.gave_up or not played.shots.truth.success:
            yield self._outcome("gave up" if played.gave_up else "as it came", played.shots)
            failures += 1
        else:
            yield self._outcome(SUCCESS, played.shots)
        if played.gave_up:
            return
        wanted = 1
        for kind in sorted(UGLY, key=lambda kind: (used[kind], self._rng.random())):
            shots = UGLY[kind](played)
            if shots is not None and shots.truth.success:
                used[kind] += 1
                wanted = 2
                yield self._outcome(kind, shots)
                break
        for kind in sorted(FAILURES, key=lambda kind: (used[kind], self._rng.random())):
            if failures == wanted:
                break
            shots = FAILURES[kind](played)
            if shots is not None and not shots.truth.success:
                used[kind] += 1
                failures += 1
                yield self._outcome(kind, shots)

    def _outcome(self, kind: str, shots: Shots) -> Outcome:
        subtask = self._subtask
        asked = shots.asked or subtask
        seen = self._seen(shots, asked.goals)
        name = f"{self._name}-{kind.replace(' ', '_')}"
        asset = self._case.objects[subtask.object].record.asset
        number = neutral_id(name, self._draw.seed)
        record = OutcomeRecord(
            id=number,
            name=name,
            scene=f"{number}/scene.json",
            setting=self._draw.scene,
            part=part_of(self._draw.scene, asset),
            template=asked.template,
            text=asked.text,
            goals=asked.goals,
            requires=asked.requires,
            grasped=asked.grasped,
            asset=asset,
            success=shots.truth.success,
            reason=shots.truth.reason,
            kind=kind,
            pictures=picture_paths(number, seen),
            empty=f"{number}/empty.png",
        )
        return Outcome(record, self._planned, seen, self._empty)

    def _seen(self, shots: Shots, goals: Sequence[Goal]) -> Seen:
        take = self._photographer.shots
        seen = {"before": take(shots.before, goals), "after": take(shots.after, goals)}
        if shots.moment is not None:
            seen["moment"] = take(shots.moment, goals, shots.arm)
        if shots.later is not None:
            seen["later"] = take(shots.later, goals, shots.arm)
        if any(goal.kind.shown.start for goal in goals):
            seen["start"] = take(shots.start, goals)
        return seen
