"""Choice of the objects of a scene, with the reading of the instruction among them.

Complaints about a choice, its reading and sizes included, go back to the reasoner, which chooses again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.errors import InfeasibleScene, ModelRefused, NoAssetFits, NoFeasibleTask, UnreadInstruction
from vcage.layout.capacities import crowding_complaints
from vcage.models.checked_reading import in_english
from vcage.models.occasion import draw_contents
from vcage.models.protocols import OFFLINE
from vcage.models.second_look import second_look, unmet_names
from vcage.models.selection_check import NamedObject, entries_of, instructed, name_objects, validate_selection
from vcage.objects.asset import Asset
from vcage.plans.actions import lasting
from vcage.runs.context import StageContext
from vcage.scenes.starting_poses import StartingPoses, scene_object, started
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import AskedGoal, Reading, in_steps
from vcage.schema.plan import Selection
from vcage.schema.scene import SceneTemplate
from vcage.sim.robots import load_robot
from vcage.tasks.ruled_out import require_way


@dataclass(frozen=True)
class Chosen:
    """The objects of a scene before they have places.

    Args:
        objects: in the order in which they were chosen.
        reading: of the instruction; None without one.
        notes: on the choice, for a person.
    """

    objects: list[NamedObject]
    reading: Reading | None
    notes: list[str]


def choose(instruction: str | None, template: SceneTemplate, context: StageContext, rng: np.random.Generator) -> Chosen:
    """Let the reasoner choose for an instruction and read it; without one, draw objects of the scene.

    Raises:
        NoAssetFits: the catalogue lacks objects of the instruction, or enough objects of the scene.
        UnknownName: it has nothing with a tag or name required by the scene.
        UnreadInstruction: words of the instruction answer to no goal.
        NoFeasibleTask: sizes rule out a goal with every choice that was made.
        ModelRefused: the reasoner was given the faults of its selection and found no better one in its rounds.
        InfeasibleScene: there is no room at a starting place given by the instruction.
    """
    if instruction is None:
        selection = draw_contents(template, context.catalogue, rng)
        return Chosen(name_objects(selection, context.catalogue), None, selection.notes)
    choices = _Choices(instruction, template, context)
    reasoner = context.models.reasoner
    try:
        selection = reasoner.select_assets(instruction, context.catalogue, rng, choices.complaints, template.name)
    except ModelRefused as error:
        if choices.infeasible is not None:
            raise choices.infeasible from error
        raise
    except (UnreadInstruction, NoAssetFits) as error:
        if reasoner.provider == OFFLINE and not in_english(instruction, context.catalogue):
            raise _not_english(instruction) from error
        raise
    return choices.chosen(selection)


def _not_english(instruction: str) -> UnreadInstruction:
    return UnreadInstruction(
        f"{instruction!r} is not read: the rules ({OFFLINE}) read English only",
        hint="say it in English, or let a model read it: --models agent, gemini, openai, anthropic or ollama",
        details={"unread": instruction, "understood": []},
    )


class _Choices:
    """The outcome of each selection for an instruction: complaints, or objects with their reading.

    Args:
        instruction: in plain language.
        template: of the scene.
        context: the library and the reasoner.
    """

    def __init__(self, instruction: str, template: SceneTemplate, context: StageContext):
        self._instruction, self._template, self._context = instruction, template, context
        self._found: dict[str, list[str] | Chosen] = {}
        self.infeasible: NoFeasibleTask | InfeasibleScene | None = None

    def complaints(self, selection: Selection) -> list[str]:
        """Complaints about a selection, one sentence each; a selection is examined once.

        Raises:
            UnreadInstruction: the instruction is not read, whatever is chosen.
            ModelRefused, AnswerNeeded, EndpointFailed, ConfigurationError: the reader does not answer.
        """
        key = selection.model_dump_json()
        if key not in self._found:
            self._found[key] = self._look(selection)
        found = self._found[key]
        return found if isinstance(found, list) else []

    def chosen(self, selection: Selection) -> Chosen:
        """The objects and the reading of a selection without complaints."""
        self.complaints(selection)
        found = self._found[selection.model_dump_json()]
        assert isinstance(found, Chosen), f"there are complaints about the selection: {found}"
        return found

    def _look(self, selection: Selection) -> list[str] | Chosen:
        self.infeasible = None
        found = validate_selection(selection, self._context.catalogue)
        if found:
            return found
        objects = name_objects(selection, self._context.catalogue)
        kinds = entries_of(objects, self._context.catalogue)
        found = unmet_names(self._instruction, self._context.catalogue, list(kinds.values()))
        if found:
            return found
        try:
            reading = self._read(objects, kinds)
        except UnreadInstruction as error:
            if error.details.get("wrong_objects"):
                return error.details["wrong_objects"]
            raise
        try:
            objects = started(objects, reading, self._context.library)
        except InfeasibleScene as error:
            self.infeasible = error
            return error.details["problems"]
        self.infeasible = impossible(objects, reading, self._template, self._context)
        return [self.infeasible.message] if self.infeasible else Chosen(objects, reading, selection.notes)

    def _read(self, objects: Sequence[NamedObject], kinds: dict[str, CatalogueEntry]) -> Reading:
        """Read the instruction among the objects, with a second look.

        Raises:
            UnreadInstruction: the second look has a complaint.
        """
        asked = instructed(self._instruction, objects, kinds)
        reading = self._context.models.reasoner.read_goals(asked)
        found = second_look(asked, reading)
        if found:
            raise UnreadInstruction(
                f"the reading of {self._instruction!r} is not believed: {'; '.join(found)}",
                hint="say it in plainer words, one thing after the other",
                details={"unread": "; ".join(found), "understood": [str(asked.goal) for asked in reading.goals]},
            )
        return reading


def impossible(
    objects: Sequence[NamedObject], reading: Reading, template: SceneTemplate, context: StageContext
) -> NoFeasibleTask | InfeasibleScene | None:
    """The error if no layout of some objects makes the goals possible, else None.

    Sizes may rule goals out, alone or together, the table has no room for a start that is as described, or nothing
    lies in what is to be poured.
    """
    assets = {o.id: context.library.asset(o.asset, o.variant) for o in objects}
    try:
        require_way(reading.goals, [scene_object(o, assets[o.id]) for o in objects], load_robot(template.robot).arms)
        # A placement that is only tried: the run draws its own.
        StartingPoses(objects, template, reading.descriptions, reading.goals, context).draw(np.random.default_rng(0))
    except (NoFeasibleTask, InfeasibleScene) as error:
        return error
    if crowded := _crowded(reading.goals, objects, {name: asset.standing or asset for name, asset in assets.items()}):
        return NoFeasibleTask(
            f"wherever the objects stand, {'; '.join(crowded)}", hint="ask for fewer things, or for a larger place"
        )
    return _empty(reading.goals, objects)


def _empty(goals: Sequence[AskedGoal], objects: Sequence[NamedObject]) -> NoFeasibleTask | None:
    """The error if nothing lies at the start in a vessel that is to be poured."""
    filled = {o.starts_in for o in objects}
    empty = [g.goal.subject for g in goals if g.goal.relation == "poured" and g.goal.subject not in filled]
    if not empty:
        return None
    return NoFeasibleTask(
        f"nothing lies in {empty[0]} that could be poured",
        hint="say what lies in it: pour the balls from the cup into the bowl, or --start 'ball inside cup'",
    )


def _crowded(goals: Sequence[AskedGoal], objects: Sequence[NamedObject], assets: dict[str, Asset]) -> list[str]:
    """Complaints about objects that do not fit together into or onto their targets."""
    last = [g for g in lasting(in_steps(goals)) if g.relation in ("inside", "on") and g.reference in assets]
    held: dict[tuple[str, str | None], list[str]] = {}
    for goal in last:
        held.setdefault((str(goal.reference), goal.part), []).append(goal.subject)
    for o in objects:
        if o.starts_in is not None and not o.heaped and o.id not in {asked.goal.subject for asked in goals}:
            held.setdefault((o.starts_in, o.starts_in_part), []).append(o.id)
    return crowding_complaints(held, assets)
