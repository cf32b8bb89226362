"""The share of a plan that a layout keeps: the one metric for every stage, benchmark and report.

:mod:`vcage.plans.relations` decides when a relation holds, and :mod:`vcage.plans.check` whether a plan can be true.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from numpy.typing import ArrayLike

from vcage.plans.relations import ground_box, holds_between
from vcage.schema.plan import TABLE, Relation
from vcage.schema.scene import Scene


@dataclass(frozen=True)
class Kept:
    """The share of a plan that a layout keeps, in [0, 1], and the broken relations."""

    share: float
    broken: list[Relation]

    @property
    def sentences(self) -> list[str]:
        """The broken relations in words: ``cup left_of plate``."""
        return [f"{r.subject} {r.relation} {r.reference}" for r in self.broken]


def relations_kept(relations: Sequence[Relation], aabbs: Mapping[str, ArrayLike], ground: ArrayLike) -> Kept:
    """Measure which of a plan's relations hold among world boxes (2, 3); the share is 1 for a plan without any.

    Args:
        relations: of the plan.
        aabbs: world boxes by object id.
        ground: (2, 3) box of the reference ``table`` (:func:`vcage.plans.relations.ground_box`).

    Raises:
        UnknownName: a relation names an object that has no box.
    """
    boxes = {**aabbs, TABLE: ground}
    broken = [r for r in relations if not holds_between(r.relation, r.subject, r.reference, boxes)]
    return Kept(1 - len(broken) / len(relations) if relations else 1.0, broken)


def relations_kept_in(scene: Scene, relations: Sequence[Relation]) -> Kept:
    """:func:`relations_kept` of the objects where the scene has them.

    Raises:
        UnknownName: a relation names an object that is not in the scene.
    """
    ground = ground_box(scene.workspace, scene.table.height)
    return relations_kept(relations, {o.id: o.aabb for o in scene.objects}, ground)
