"""The relations a planner would have written for a layout: each object's place relative to its neighbours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from vcage.plans.check import contradictions
from vcage.plans.relations import BESIDE_GAP, DIRECTIONS, NEAR_GAP, holds, plane_gap
from vcage.schema.plan import Relation, RelationWord

ROBUST = 0.02
"""Distance that an object may be moved without breaking a relation of the plan, metres."""
NEIGHBOURS = 3
"""A relation is to one of this number of nearest objects."""
SECOND = 0.5
"""Share of the objects that the plan relates to two others."""

_SHIFTS = ROBUST * np.array([[np.cos(t), np.sin(t), 0.0] for t in np.arange(8) * np.pi / 4] + [[0.0, 0.0, 0.0]])


def plan_relations(
    boxes: Mapping[str, np.ndarray], supports: Mapping[str, tuple[RelationWord, str]], rng: np.random.Generator
) -> list[Relation]:
    """Relations that hold in a layout: all contents to their container, and all others in one web, about 1.5 each.

    Args:
        boxes: (2, 3) world box by id.
        supports: (``inside`` or ``on``, container) of what does not stand on the table, by id.
        rng: the only source of randomness.
    """
    relations = [Relation(subject=id, relation=word, reference=c) for id, (word, c) in supports.items()]
    roots = [str(id) for id in rng.permutation([id for id in boxes if id not in supports])]
    for k, subject in enumerate(roots[1:], start=1):
        wanted = 1 + int(rng.random() < SECOND)
        relations += _to_neighbours(subject, roots[:k], boxes, wanted, rng)
    if found := contradictions(relations):
        raise ValueError(f"a plan taken from a layout contradicts itself: {found}")
    return relations


def _to_neighbours(
    subject: str, earlier: Sequence[str], boxes: Mapping[str, np.ndarray], wanted: int, rng: np.random.Generator
) -> list[Relation]:
    """Up to ``wanted`` relations to different objects, the nearest preferred."""
    near = sorted(earlier, key=lambda id: plane_gap(boxes[subject], boxes[id]))
    order = [*map(str, rng.permutation(near[:NEIGHBOURS])), *near[NEIGHBOURS:]]
    found: list[Relation] = []
    for reference in order:
        words = robust_words(boxes[subject], boxes[reference])
        if words and len(found) < wanted:
            found.append(Relation(subject=subject, relation=words[rng.integers(len(words))], reference=reference))
    return found


def robust_words(subject: np.ndarray, reference: np.ndarray) -> list[RelationWord]:
    """Words that hold between two boxes (2, 3) and go on to when the subject moves by :data:`ROBUST`."""
    words: list[RelationWord] = [w for w in DIRECTIONS if all(holds(w, subject + s, reference) for s in _SHIFTS)]
    gap = plane_gap(subject, reference)
    # To touch is no danger to them: what overlaps is a collision first.
    limits: dict[RelationWord, float] = {"beside": BESIDE_GAP, "near": NEAR_GAP}
    return words + [word for word, limit in limits.items() if 0 <= gap <= limit - ROBUST]
