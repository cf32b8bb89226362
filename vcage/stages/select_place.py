"""Choose the objects for an instruction, or those of a scene template, and place them on the table without collision.

Writes place/scene.json (objects, poses, camera), source.png, background.png and segmentation.png.

examples:
  vcage select-place "Pack the marker pens and the eraser into the box" --out runs/stationery
  vcage select-place "Put the blocks on the plate" --out runs/blocks --seed 7 --force
  vcage select-place --scene office_desk --out runs/office
  vcage select-place "Put the apple into the bowl" --robot dual_panda --out runs/apple
  vcage select-place --goal "marker inside packaging_box" --goal "then sponge inside packaging_box" --out runs/stated

Goals can be stated in place of an instruction. Nothing is read then, and no reasoner is asked. All goals but those that
name an arm may end with "with the left|right arm". A goal that begins with "then" comes after those before it.
A name is a kind (marker), a kind and look (marker/red), or an id of the scene (marker_red, marker_red_2).
Without an instruction, the scene's is a plain sentence for the goals; a given one must not contradict them.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from tyro.conf import Positional, UseAppendAction, arg

from vcage.base.errors import UsageError
from vcage.base.files import RunFolder
from vcage.base.options import UNSAID, value
from vcage.base.progress import Progress, silent
from vcage.base.text import one_line
from vcage.goals import written_forms
from vcage.runs.context import StageContext
from vcage.runs.edits import Edit, Editable
from vcage.runs.stage import Job, ModelOptions, StageResult
from vcage.scenes.chosen_objects import choose
from vcage.scenes.placed_scene import photograph, place_until_stable
from vcage.scenes.possible import SCENE_FIELDS, accepted_scene
from vcage.scenes.stated_goals import StatedTask
from vcage.scenes.stated_scene import choose_stated
from vcage.schema.base import Provenance
from vcage.schema.scene import Scene, SceneTemplate
from vcage.sim.robots import available, load_template

logger = logging.getLogger(__name__)

MAX_INSTRUCTION_CHARACTERS = 1000


@dataclass(frozen=True, kw_only=True)
class Options(ModelOptions):
    """Options that begin a run."""

    instruction: Annotated[str | None, Positional, arg(metavar="[instruction]"), UNSAID] = None
    """the task in plain language, in quotes; without one, the objects come from the scene template"""
    template: Annotated[str, arg(name="scene", metavar="TEMPLATE")] = "table"
    """the scene template"""
    goals: Annotated[
        tuple[Annotated[str, value(str, "GOAL")], ...],
        UseAppendAction,
        arg(name="goal", help=f"what shall be true, of the form {written_forms()}; may be repeated"),
        UNSAID,
    ] = ()
    starts: Annotated[tuple[Annotated[str, value(str, "GOAL")], ...], UseAppendAction, arg(name="start"), UNSAID] = ()
    """what must be true at the start of every episode, as in "banana inside pot" or "plate/white left_of plate/blue";
    of the table it may be center, left_of, right_of, in_front_of or behind, its middle or outer third; may be repeated
    """
    objects: Annotated[str | None, arg(metavar="OBJECTS"), UNSAID] = None
    """what stands there, as in "marker/red, packaging_box, 2 apple" (default: what the goals name, one of each, and the
    scanner, scale, hammer or sponge that they need; three balls in what is poured)"""
    robot: Annotated[str | None, arg(metavar="ROBOT"), UNSAID] = None
    """the robot (default: that of the scene template, or aloha_agilex); ``vcage robots list`` lists them"""

    def stated(self) -> StatedTask | None:
        """The stated goals, with start conditions and objects; None without goals."""
        return StatedTask.of(self.goals, self.starts, self.objects)


def asked_by(options: Options) -> dict[str, Any]:
    """Return what options ask for, as the provenance of the scene keeps it.

    Raises:
        UsageError: the instruction is empty, too long or no text; or there is none, and nothing belongs to the scene;
            or goals, start conditions or objects are not of their grammar.
        UnknownName: there is no such scene or robot.
    """
    asked: dict[str, Any] = {"instruction": None, "template": options.template}
    asked["robot"] = load_template(options.template, options.robot).robot
    if options.instruction is not None:
        asked["instruction"] = _read(options.instruction)
    stated = options.stated()
    if stated is not None:
        asked |= stated.record()
    elif options.instruction is None:
        asked["contents"] = [one.model_dump(mode="json") for one in _with_contents(options.template).contents]
    return asked


def job(run: RunFolder, options: Options, context: StageContext) -> Job:
    """Return the work of the stage; raises as :func:`asked_by`."""
    asked, stated = asked_by(options), bool(options.goals)
    return Job(
        run=run,
        output=run.scene,
        seed=options.seed or 0,
        options=asked,
        providers=context.models.providers("reasoner") if asked["instruction"] and not stated else {},
    )


def _with_contents(name: str) -> SceneTemplate:
    """The scene template, with its contents."""
    template = load_template(name)
    if not template.contents:
        others = [other for other in available("scenes") if load_template(other).contents]
        raise UsageError(
            f"the scene {name} has no contents, and there is no instruction",
            hint=f'give one in quotes: "Put the blocks on the plate", or --scene with one of: {", ".join(others)}',
        )
    return template


def _read(instruction: str) -> str:
    """The instruction in one line."""
    instruction = " ".join(instruction.split())
    if not instruction:
        raise UsageError("the instruction is empty", hint='give it in quotes: "Put the blocks on the plate"')
    if len(instruction) > MAX_INSTRUCTION_CHARACTERS:
        raise UsageError(
            f"the instruction has {len(instruction)} characters, at most {MAX_INSTRUCTION_CHARACTERS} are read",
            hint="make a run of each part",
        )
    if one_line(instruction) != instruction:
        raise UsageError(
            f"the instruction {instruction!r} contains control characters, or invisible characters",
            hint="write it in UTF-8, without them",
        )
    return instruction


def summary(record: Scene) -> dict[str, Any]:
    """A few facts for the user of the stage."""
    goals = [str(asked.goal) for asked in record.goals]
    return {"objects": [o.id for o in record.objects], "goals": goals, **record.checks}


def execute(run: RunFolder, options: Options, context: StageContext, progress: Progress = silent) -> StageResult[Scene]:
    """Write ``place/``: M, the top view, the empty table, the segmentation.

    Raises:
        NoAssetFits: the catalogue lacks objects of the instruction, or enough objects of the scene.
        UnknownName: it has nothing with a tag or name required by the scene.
        UnreadInstruction: words of the instruction answer to no goal.
        UsageError: the given goals name several objects at once, contradict each other or the instruction.
        NoFeasibleTask: the sizes of the objects rule out a goal, wherever they stand.
        ModelRefused: the reasoner was given the faults of its selection and found no better one in its rounds.
        InfeasibleScene: the objects have no place, or do not stay where they are put.
    """
    stage = job(run, options, context)

    def make(folder: Path, provenance: Provenance) -> Scene:
        rng = stage.rng()
        template = load_template(options.template, options.robot)
        instruction = stage.options["instruction"]
        stated = options.stated()
        if stated is None:
            chosen = choose(instruction, template, context, rng)
        else:
            instruction, chosen = choose_stated(stated, instruction, template, context, rng)
        for note in chosen.notes:
            logger.warning("%s", note)
        scene: dict[str, Any] = {
            "provenance": provenance,
            "instruction": instruction,
            "template": template.name,
            **{name: getattr(template, name) for name in ("robot", "table", "workspace", "top_camera")},
            "pictures": {name: stage.inside(f"{name}.png") for name in ("source", "background", "segmentation")},
        }
        if chosen.reading is not None:
            read = chosen.reading
            scene |= {"goals": read.goals, "untouched": read.untouched, "descriptions": read.descriptions}
        placed = place_until_stable(scene, chosen.objects, template, context, rng)
        noted = placed.model_copy(update={"checks": {**placed.checks, "notes": chosen.notes}})
        return photograph(noted, context, folder)

    return stage.do(Scene, make, force=options.force)


def _accept(edit: Edit[Scene]) -> Scene:
    """Check an edited M, and photograph it as it settles."""
    if not edit.changes(*SCENE_FIELDS):
        return edit.record
    settled, notes = accepted_scene(edit), edit.was.checks.get("notes", [])
    noted = settled.model_copy(update={"checks": {**settled.checks, "notes": notes}})
    return photograph(noted, edit.context, edit.folder)


EDITABLE = Editable(Scene, fields=SCENE_FIELDS, pictures=True, accept=_accept)
