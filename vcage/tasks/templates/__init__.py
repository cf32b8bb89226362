"""Templates of sub-tasks, one file each: its objects, its question to the reasoner, its feasibility, its script.

A new template is a file here, and its name in :data:`TEMPLATES`.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Protocol

from vcage.base.errors import mismatch
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Refusal, Subtask, Subtasks, TemplateName
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates.close import CLOSE
from vcage.tasks.templates.hand_over import HandOver
from vcage.tasks.templates.hang import HANG
from vcage.tasks.templates.hit import Hit
from vcage.tasks.templates.hold_up import HoldUp
from vcage.tasks.templates.hold_with_both import HoldWithBoth
from vcage.tasks.templates.insert import INSERT
from vcage.tasks.templates.lift import LIFT
from vcage.tasks.templates.open import OPEN
from vcage.tasks.templates.place import PLACE
from vcage.tasks.templates.pour import POUR
from vcage.tasks.templates.present import PRESENT
from vcage.tasks.templates.press import PRESS
from vcage.tasks.templates.proposal import Proposal
from vcage.tasks.templates.push import PUSH
from vcage.tasks.templates.scan import Scan
from vcage.tasks.templates.set_down import SET_DOWN
from vcage.tasks.templates.shake import SHAKE
from vcage.tasks.templates.stack import STACK
from vcage.tasks.templates.turn import TURN
from vcage.tasks.templates.turn_off import TURN_OFF
from vcage.tasks.templates.weigh import WEIGH
from vcage.tasks.templates.wipe import Wipe


class SubtaskTemplate(Protocol):
    """A kind of sub-task."""

    @property
    def name(self) -> TemplateName:
        """Its name in records."""
        ...

    def proposals(
        self, objects: Sequence[SceneObject], asked: Collection[Goal]
    ) -> tuple[Sequence[Proposal], list[Refusal]]:
        """Proposals for a scene, and refusals by the preconditions.

        Args:
            objects: all of the scene.
            asked: the requested goals; some are tried only then.
        """
        ...

    def calls(self, subtask: Subtask) -> list[str]:
        """The lines of the script's ``play``: calls of the task API (:class:`vcage.tasks.task.Task`)."""
        ...


TEMPLATES: dict[TemplateName, SubtaskTemplate] = {
    template.name: template
    for template in (
        PLACE, STACK, WEIGH, SET_DOWN, PUSH, PRESENT, Scan(), OPEN, CLOSE, PRESS, TURN, TURN_OFF, HandOver(), LIFT,
        SHAKE, HoldUp(), HoldWithBoth(), Hit(), Wipe(), POUR, HANG, INSERT,
    )
}  # fmt: skip
"""By name, in the order in which the search goes through them."""


def read_subtasks(path: Path) -> Subtasks:
    """Read ``subtasks.json``.

    Raises:
        MissingStage, DamagedFile: it is not there, or not JSON.
        SchemaMismatch: it breaks its schema, or names a template that does not exist; names the field.
    """
    record = Subtasks.read(path)
    for name in ("kept", "refused"):
        for number, one in enumerate(getattr(record, name)):
            if one.template not in TEMPLATES:
                field = f"{name}.{number}.template"
                raise mismatch(path, field, f"{one.template!r}; expected one of {', '.join(TEMPLATES)}")
    return record
