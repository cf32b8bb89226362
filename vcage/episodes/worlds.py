"""Worlds of episodes: differences from the run's scene are drawn, and put into its scene and models.

All words of the task stay true: no look that the instruction names is changed or drawn, names follow looks, and added
objects answer to none of these words.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cached_property

import numpy as np

from vcage.base.attempts import LIMITS
from vcage.base.geometry import Pose
from vcage.base.words import look_words
from vcage.models.quantifiers import quantified
from vcage.models.selection_check import phrase_of
from vcage.objects.bystanders import bystanders
from vcage.runs.context import StageContext
from vcage.scenes.possible import moved_objects, settled_record
from vcage.schema.asset import CatalogueEntry, PhysicalModel
from vcage.schema.base import PoseRecord, box_record
from vcage.schema.randomisation import HEIGHT_STEP, WorldDraw, WorldRanges, heights_within
from vcage.schema.scene import ObjectRecord, Scene
from vcage.schema.subtasks import Subtask
from vcage.sim.bodies import Body
from vcage.sim.collision import CollisionScene
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.wording import in_other_words

WIDEST_CLUTTER_M, HIGHEST_CLUTTER_M = 0.16, 0.12
"""Largest clutter: hands pass over it."""


class Worlds:
    """Draws worlds for the episodes of a chain.

    Args:
        scene: at the start of the chain.
        chain: the sub-tasks, in order.
        context: the library.
    """

    def __init__(self, scene: Scene, chain: Sequence[Subtask], context: StageContext):
        self.scene, self.chain, self.context = scene, chain, context

    def draw(self, ranges: WorldRanges, rng: np.random.Generator) -> WorldDraw:
        """Differences of an episode that do not depend on where its objects stand."""
        lowest, highest = heights_within(ranges.table_height)
        height = round(int(rng.integers(lowest, highest + 1)) * HEIGHT_STEP, 3)
        variants = self._variants(rng) if ranges.variants else {}
        number = int(rng.integers(ranges.clutter[0], ranges.clutter[1] + 1))
        clutter = self._clutter(number, rng) if number else {}
        start = self._start(ranges.start, rng)
        return WorldDraw(variants=variants, clutter=clutter, clutter_drawn=number, table_height=height, start=start)

    def changed(self, draw: WorldDraw) -> Scene:
        """The scene with other variants, called as they look, and its table as high as was drawn."""
        shift = Pose([0.0, 0.0, draw.table_height])
        table = self.scene.table.model_copy(update={"height": self.scene.table.height + draw.table_height})
        records = []
        for o in self.scene.objects:
            changed = self._as_variant(o, draw.variants[o.id]) if o.id in draw.variants else o
            records.append(settled_record(changed, shift * o.pose.pose(), self.context))
        return self.scene.model_copy(update={"table": table, "objects": records})

    def clutter(self, draw: WorldDraw) -> list[SceneObject]:
        """Objects that the task does not touch, in the middle of the table until a layout places them."""
        pose, found = Pose([*self.scene.table.centre, self.scene.table.height + draw.table_height]), []
        for name, kind in draw.clutter.items():
            asset = self.context.library.asset(kind)
            record = ObjectRecord(
                id=name,
                asset=kind,
                variant=asset.variant.id,
                phrase=phrase_of(asset.entry(), asset.variant),
                role="context",
                pose=PoseRecord.of(pose),
                aabb=box_record(asset.bounds, pose),
            )
            found.append(SceneObject(record, asset, pose))
        return found

    # --- draws ----------------------------------------------------------------------------------------

    @cached_property
    def _objects(self) -> list[SceneObject]:
        return self.context.objects(self.scene)

    @cached_property
    def _lying(self) -> dict[str, str]:
        return {o.id: o.container for o in self.scene.objects if o.container is not None}

    @cached_property
    def _instruction(self) -> str:
        """Words whose meaning no random draw may change; empty without any."""
        return self.scene.instruction or ""

    def _variants(self, rng: np.random.Generator) -> dict[str, str]:
        """Another variant for some objects, one after the other, so that all words stay true.

        Contents and their holders keep their variants: others may have other sizes.
        """
        found: dict[str, str] = {}
        for o in self._objects:
            own = phrase_of(o.asset.entry(), o.asset.variant)
            if o.id in {*self._lying, *self._lying.values()} or o.record.phrase != own:  # a hand calls it otherwise
                continue
            others = [v.id for v in o.asset.annotation.variants if v.id != o.record.variant]
            may = [v for v in others if self._stays_true({**found, o.id: v})]
            chosen = int(rng.integers(len(may) + 1))
            found |= {o.id: may[chosen]} if chosen < len(may) else {}
        return found

    def _stays_true(self, variants: Mapping[str, str]) -> bool:
        """Check if the instruction names no look that is left or taken, and each phrase still means one object."""
        named = look_words(self._instruction)
        before = {o.id: o for o in self.scene.objects}
        after = {o.id: self._as_variant(o, variants[o.id]) if o.id in variants else o for o in self.scene.objects}
        for name in variants:
            looks = {word for records in (before, after) for word in self._look_of(records[name])}
            if looks & named:
                return False
            if any([o.phrase for o in said.values()].count(said[name].phrase) > 1 for said in (before, after)):
                return False
        return True

    def _look_of(self, o: ObjectRecord) -> frozenset[str]:
        variant = self.context.asset(o).variant
        return look_words(f"{variant.colour} {variant.id}")

    @cached_property
    def _may_stand_by(self) -> list[CatalogueEntry]:
        """Small rigid objects outside the meaning of all wordings; those of the place first."""
        texts = [self._instruction, *(text for subtask in self.chain for text in (subtask.text, *subtask.texts))]
        texts += [o.phrase for o in self.scene.objects]
        ranging = quantified(self._instruction)
        small = [
            entry
            for entry in self.context.catalogue
            if max(entry.size[:2]) <= WIDEST_CLUTTER_M
            and entry.size[2] <= HIGHEST_CLUTTER_M
            and not (entry.moving_parts or entry.loose)
        ]
        there = [entry for entry in small if not any(quantifier.covers(entry) for quantifier in ranging)]
        return bystanders(texts, [o.kind() for o in self._objects], there)

    def _clutter(self, number: int, rng: np.random.Generator) -> dict[str, str]:
        """That many kinds of objects, one of each, of the place as far as possible: id → asset."""
        tags = {self.scene.template}.union(*(o.asset.annotation.words.scene_tags for o in self._objects))
        order = [self._may_stand_by[i] for i in rng.permutation(len(self._may_stand_by))]
        order.sort(key=lambda entry: not tags & {*entry.words.scene_tags})
        taken = {o.id for o in self._objects}
        return {f"{e.name}_beside" if e.name in taken else e.name: e.name for e in order[:number]}

    def _as_variant(self, o: ObjectRecord, variant: str) -> ObjectRecord:
        asset = self.context.library.asset(o.asset, variant)
        return o.model_copy(update={"variant": variant, "phrase": phrase_of(asset.entry(), asset.variant)})

    def _start(self, largest: float, rng: np.random.Generator) -> dict[str, list[float]]:
        """An offset of each joint, radians, as far as its range allows; nothing if not requested."""
        if largest == 0:
            return {}
        found = {}
        for name, arm in self.context.kinematics(self.scene.robot).items():
            offset = rng.uniform(-largest, largest, size=len(arm.home))
            within = np.clip(arm.home + offset, arm.lower, arm.upper) - arm.home
            found[name] = within.round(4).tolist()
        return found


def left_with(draw: WorldDraw, clutter: Collection[str]) -> WorldDraw:
    """The draw with this clutter alone, by id."""
    return draw.model_copy(update={"clutter": {name: kind for name, kind in draw.clutter.items() if name in clutter}})


def weighed(
    draw: WorldDraw, ranges: WorldRanges, models: Mapping[str, PhysicalModel], rng: np.random.Generator
) -> WorldDraw:
    """The draw with mass and friction of each object that has a model."""
    mass = {name: round(model.total_mass * f, 4) for name, model, f in _factors(models, ranges.mass, rng)}
    friction = {name: round(model.friction * f, 4) for name, model, f in _factors(models, ranges.friction, rng)}
    return draw.model_copy(update={"mass": mass, "friction": friction})


def drawn_models(models: Mapping[str, PhysicalModel], draw: WorldDraw) -> dict[str, PhysicalModel]:
    """Models with the mass and friction that were drawn; moving parts weigh as much more as the body."""
    found = {}
    for name, model in models.items():
        factor = draw.mass.get(name, model.total_mass) / model.total_mass
        links = [link.model_copy(update={"mass": factor * link.mass}) for link in model.links]
        changed = {"mass": factor * model.mass, "links": links, "friction": draw.friction.get(name, model.friction)}
        found[name] = model.model_copy(update=changed)
    return found


def steady(scene: Scene, models: Mapping[str, PhysicalModel], draw: WorldDraw) -> WorldDraw:
    """The draw without the clutter that does not stay where it is put."""
    if not draw.clutter:
        return draw
    report = World.of_scene(scene, models).settle()
    gone = {*moved_objects(report, scene.objects), *report.fallen} & {*draw.clutter}
    return left_with(draw, draw.clutter.keys() - gone)


def free_start(scene: Scene, models: Mapping[str, PhysicalModel], draw: WorldDraw) -> WorldDraw:
    """The draw with arms free of contact at the start: touching ones are brought nearer to home."""
    robot = load_robot(scene.robot)
    bodies = {o.id: Body(models[o.id], o.pose.pose(), o.joints) for o in scene.objects}
    start = {name: np.array(offset) for name, offset in draw.start.items()}
    for name in start:
        for attempt in range(1, LIMITS.home_halvings + 1):
            joints = {other: np.array(robot.arms[other].home) + offset for other, offset in start.items()}
            if CollisionScene(robot, name, scene.table, bodies, joints).first_contact(joints[name]) is None:
                break
            start[name] = start[name] / 2 if attempt < LIMITS.home_halvings else 0 * start[name]
    return draw.model_copy(update={"start": {name: offset.round(4).tolist() for name, offset in start.items()}})


def other_phrases(scene: Scene, objects: Iterable[ObjectRecord]) -> dict[str, str]:
    """New phrases of objects that are called otherwise in a scene, by the old ones."""
    was = {o.id: o.phrase for o in scene.objects}
    return {was[o.id]: o.phrase for o in objects if was.get(o.id, o.phrase) != o.phrase}


def reworded(subtask: Subtask, phrases: Mapping[str, str]) -> Subtask:
    """A sub-task in the words of an episode (:func:`other_phrases`)."""
    texts = [in_other_words(text, phrases) for text in (subtask.text, *subtask.texts)]
    return subtask.model_copy(update={"text": texts[0], "texts": texts[1:]})


def _factors(
    models: Mapping[str, PhysicalModel], within: tuple[float, float], rng: np.random.Generator
) -> list[tuple[str, PhysicalModel, float]]:
    """A factor for each model; nothing where none but 1 may be."""
    if within == (1.0, 1.0):
        return []
    return [(name, model, float(rng.uniform(*within))) for name, model in models.items()]
