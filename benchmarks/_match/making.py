"""One case of a level from its number alone."""

from __future__ import annotations

import functools
from collections.abc import Mapping

import numpy as np

from benchmarks._match.cases import Case
from benchmarks._match.drawing import background, photograph, plain_look, visible_shares
from benchmarks._match.levels import LEVELS
from benchmarks._match.scenes import TRIES, Thing, choose_looks, scatter
from benchmarks._match.targets import LEAST_VISIBLE, Target
from benchmarks._match.truth import Truth
from benchmarks._match.views import Look, library
from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose
from vcage.models.selection_check import NamedObject, name_objects
from vcage.runs.context import METRES_PER_PIXEL
from vcage.schema.base import PoseRecord, Provenance, box_record
from vcage.schema.plan import SelectedAsset, Selection
from vcage.schema.scene import ObjectRecord, Scene, SceneTemplate
from vcage.sim.drawer import reference_view
from vcage.sim.robots import load_template

SEED = 20240
"""Of every case, together with its level and number."""

TEMPLATES = ("bathroom", "cabinet", "cashier_desk", "kitchen", "office_desk", "table")


@functools.cache
def _reference(asset: str, variant: str) -> np.ndarray:
    """(h, w, 4) uint8 RGBA of a look from straight above, in studio light, as the match stage has it."""
    return reference_view(library().asset(asset, variant).model, METRES_PER_PIXEL)


def make_case(level: str, index: int) -> Case:
    """The case ``index`` of a level, always the same.

    Raises:
        InfeasibleScene: its objects find no place; does not happen with the numbers that are used.
        NoRenderer: nothing here can draw.
    """
    rng = np.random.default_rng([SEED, list(LEVELS).index(level), index])
    count = 4 + (7 * index + 3 * list(LEVELS).index(level)) % 17  # every number from 4 to 20 in 17 cases
    for _ in range(TRIES):
        try:
            case = _draw(level, index, count, rng)
        except InfeasibleScene:
            continue
        if case is not None:
            return case
    raise InfeasibleScene(f"no scene of {count} objects for case {level}/{index:03d}", hint="choose another number")


def _draw(level: str, index: int, count: int, rng: np.random.Generator) -> Case | None:
    """One attempt at a case; None when an object is hidden."""
    template = load_template(TEMPLATES[int(rng.integers(len(TEMPLATES)))])
    looks = choose_looks(count, template.workspace, rng)
    named = _named(looks)
    things = [Thing(o.id, library().asset(o.asset, o.variant)) for o in named]
    poses = scatter(things, template.workspace, template.table, rng)
    source = photograph(template, things, poses, plain_look(template.table.texture))
    if min(visible_shares(source, template, things, poses).values()) < LEAST_VISIBLE:
        return None
    target = Target.draw(LEVELS[level], template, things, looks, rng)
    if target is None:
        return None
    scene = _scene(template, named, things, poses, index)
    return Case(
        name=f"{level}/{index:03d}",
        scene=scene,
        source=source.picture,
        segmentation=source.segmentation,
        background=background(template.name),
        target=target.picture,
        truth=Truth(level=level, objects=target.objects, strangers=target.strangers, changes=target.changes),
        references={o.id: _reference(o.asset, o.variant) for o in named},
    )


def _named(looks: list[Look]) -> list[NamedObject]:
    chosen = [SelectedAsset(asset=asset, variant=variant, role="context") for asset, variant in looks]
    entries = [library().entry(name) for name in sorted({asset for asset, _ in looks})]
    return name_objects(Selection(objects=chosen), entries)


def _scene(
    template: SceneTemplate, named: list[NamedObject], things: list[Thing], poses: Mapping[str, Pose], index: int
) -> Scene:
    """M as stage 1 leaves it; the values of the segmentation are the order of the objects."""
    records = [
        ObjectRecord(
            id=o.id,
            asset=o.asset,
            variant=o.variant,
            phrase=o.phrase,
            role=o.role,
            pose=PoseRecord.of(poses[o.id]),
            aabb=box_record(thing.asset.bounds, poses[o.id]),
        )
        for o, thing in zip(named, things, strict=True)
    ]
    return Scene(
        provenance=Provenance(producer="benchmarks.match", seed=index),
        instruction="Move everything",
        template=template.name,
        robot=template.robot,
        table=template.table,
        workspace=template.workspace,
        top_camera=template.top_camera,
        objects=records,
        pictures={name: f"{name}.png" for name in ("source", "background", "segmentation")},
        segmentation_ids={o.id: i for i, o in enumerate(named, start=1)},
    )
