"""Descriptions of an instruction: what must be true of where things are in every starting layout.

They are relations like those of a plan (:mod:`vcage.plans.relations` says when one holds), but they are never given up:
"the left plate" is another plate if it stands on the right. The contents of a moving part, such as a drawer, are in
the box of that part.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from numpy.typing import ArrayLike

from vcage.plans.actions import HOLDING
from vcage.plans.plain_words import in_words
from vcage.plans.relations import holds_between
from vcage.schema.goals import Description, RelationWord
from vcage.schema.plan import TABLE, LayoutPlan, Relation


def place_key(description: Description) -> str:
    """The key of the reference's box: its id, with the moving part after a slash where there is one."""
    part = f"/{description.part}" if description.part else ""
    return f"{description.reference}{part}"


def false_descriptions(
    descriptions: Sequence[Description], boxes: Mapping[str, ArrayLike], ground: ArrayLike
) -> list[Description]:
    """The descriptions that are not true where things have these world boxes.

    Args:
        descriptions: of a scene.
        boxes: (2, 3) world boxes by object id, and of moving parts by ``id/part``.
        ground: (2, 3) box of the reference ``table`` (:func:`vcage.plans.relations.ground_box`).

    Raises:
        UnknownName: a description names what has no box.
    """
    known = {**boxes, TABLE: ground}
    return [d for d in descriptions if not holds_between(d.relation, d.subject, place_key(d), known)]


def false_in_words(descriptions: Sequence[Description], phrases: Mapping[str, str]) -> list[str]:
    """Complaints about false descriptions, a sentence each: it is not so that…, as the instruction says."""
    return [f"it is not so that {in_words(d, phrases)} ({d.words!r})" for d in descriptions]


def described_relations(descriptions: Sequence[Description]) -> list[Relation]:
    """Descriptions as relations of a plan, each once; contents of a moving part are outside the plan."""
    said = [d for d in descriptions if d.part is None]
    return list(dict.fromkeys(Relation(subject=d.subject, relation=d.relation, reference=d.reference) for d in said))


def with_descriptions(plan: LayoutPlan, descriptions: Sequence[Description], phrases: Mapping[str, str]) -> LayoutPlan:
    """A plan with the descriptions: missing ones are added to its relations and its text."""
    missing = unsaid(plan.relations, descriptions)
    if not missing:
        return plan
    sentences = list(dict.fromkeys(f"{text[0].upper()}{text[1:]}." for text in (in_words(d, phrases) for d in missing)))
    relations = [*plan.relations, *described_relations(missing)]
    return LayoutPlan(text=" ".join([plan.text, *sentences]), relations=relations)


def unsaid(relations: Sequence[Relation], descriptions: Sequence[Description]) -> list[Description]:
    """The descriptions that a plan with these relations does not say; what lies ``inside`` a thing by its description
    and ``on`` it by the plan, or the other way round, lies there."""
    said = {(r.subject, _same(r.relation), r.reference) for r in relations}
    return [d for d in descriptions if not d.part and (d.subject, _same(d.relation), d.reference) not in said]


def _same(word: RelationWord) -> RelationWord:
    return "on" if word in HOLDING else word
