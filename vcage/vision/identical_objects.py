"""Objects that look the same: only the plan can tell them apart in a target picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np

from vcage.base.geometry import wrap_angle
from vcage.plans.kept import relations_kept
from vcage.plans.relations import ground_box
from vcage.schema.matches import Match
from vcage.schema.plan import Relation
from vcage.schema.scene import ObjectRecord, Scene


def settle_identical(scene: Scene, relations: Sequence[Relation], matches: Sequence[Match]) -> list[Match]:
    """The matches, with objects of one asset and variant exchanged where that keeps more of the plan.

    Two are exchanged at a time, as long as one more relation holds afterwards. Objects that were not found stay.
    """
    found = {m.object: m for m in matches}
    pairs = [
        (a.id, b.id)
        for a, b in combinations(scene.objects, 2)
        if (a.asset, a.variant) == (b.asset, b.variant) and "kept" not in (found[a.id].method, found[b.id].method)
    ]
    share = _share_kept(scene, relations, found)
    while better := _best_exchange(scene, relations, found, pairs, share):
        share, found = better
    return [found[m.object] for m in matches]


def _best_exchange(
    scene: Scene, relations: Sequence[Relation], found: dict[str, Match], pairs: list[tuple[str, str]], share: float
) -> tuple[float, dict[str, Match]] | None:
    """The exchange that keeps most of the plan and the share that it keeps, if that exceeds the present ``share``."""
    tried = []
    for a, b in pairs:
        exchanged = {**found, a: _as(scene.object(a), found[b]), b: _as(scene.object(b), found[a])}
        tried.append((_share_kept(scene, relations, exchanged), exchanged))
    best = max(tried, key=lambda one: one[0], default=None)
    return best if best is not None and best[0] > share + 1e-9 else None


def _as(record: ObjectRecord, match: Match) -> Match:
    """The match of another object that looks the same, as the match of this object."""
    turned = float(wrap_angle(match.yaw - record.pose.pose().yaw))
    return match.model_copy(update={"object": record.id, "turned": turned})


def _share_kept(scene: Scene, relations: Sequence[Relation], found: Mapping[str, Match]) -> float:
    boxes = {o.id: matched_box(o, found[o.id]) for o in scene.objects}
    return relations_kept(relations, boxes, ground_box(scene.workspace, scene.table.height)).share


def matched_box(record: ObjectRecord, match: Match) -> np.ndarray:
    """(2, 3) an object's world box moved to its matched place; its turn does not change the box."""
    shift = np.subtract(match.position, record.pose.position[:2])
    return np.array(record.aabb) + np.array([*shift, 0.0])
