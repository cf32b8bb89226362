"""Choosing the objects of a scene and reading what the instruction asks for among them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from vcage.models.scene_contents import draw_contents
from vcage.models.selection_check import NamedObject, name_objects, validate_selection
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import Reading
from vcage.schema.plan import Selection
from vcage.schema.scene import SceneTemplate
from vcage.stages.context import StageContext
from vcage.stages.started import start_complaints, started


@dataclass(frozen=True)
class Chosen:
    """The objects of a scene before they have places.

    Args:
        objects: in the order in which they were chosen.
        reading: what the instruction asks for; None where there is no instruction.
        notes: what a person should know about the choice.
    """

    objects: list[NamedObject]
    reading: Reading | None
    notes: list[str]


def choose(instruction: str | None, template: SceneTemplate, context: StageContext, rng: np.random.Generator) -> Chosen:
    """What the reasoner chooses for an instruction and reads in it; without one, a draw of what belongs to the scene.

    Raises:
        NoAssetFits: the catalogue has nothing that the instruction names, or too little of what belongs to the scene.
        UnknownName: it has nothing with a tag or name of what belongs to the scene.
        UnreadInstruction: words of the instruction answer to no goal.
        ModelRefused: the reasoner was told what is wrong with its selection and found no better one in its rounds.
        InfeasibleScene: there is no room where the instruction says that something is at the start.
    """
    selection = _selection(instruction, template, context, rng)
    objects = name_objects(selection, context.catalogue)
    reading = None
    if instruction is not None:
        lying = {o.id: o.starts_in for o in objects if o.starts_in is not None}
        reading = context.models.reasoner.read_goals(instruction, entries_of(objects, context), lying)
        objects = started(objects, reading.descriptions, context.library)
    return Chosen(objects, reading, selection.notes)


def _selection(
    instruction: str | None, template: SceneTemplate, context: StageContext, rng: np.random.Generator
) -> Selection:
    """What the reasoner chooses for an instruction; without one, a draw of what belongs to the scene."""
    if instruction is None:
        return draw_contents(template, context.catalogue, rng)
    check = partial(_complaints, context=context)
    return context.models.reasoner.select_assets(instruction, context.catalogue, rng, check)


def _complaints(selection: Selection, context: StageContext) -> list[str]:
    """What makes a selection unusable: unknown names, or no room where something starts."""
    found = validate_selection(selection, context.catalogue)
    return found or start_complaints(name_objects(selection, context.catalogue), context.library)


def entries_of(objects: Sequence[NamedObject], context: StageContext) -> dict[str, CatalogueEntry]:
    """The catalogue's entry of each object, with no other look than its own, by its id."""
    entries = {entry.name: entry for entry in context.catalogue}
    return {
        o.id: entries[o.asset].model_copy(
            update={"variants": [v for v in entries[o.asset].variants if v.id == o.variant]}
        )
        for o in objects
    }
