"""Set down: a portable object is put on the table: beside another, back at its place, aside, or out of the way."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from itertools import islice

from vcage.base.attempts import LIMITS
from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE
from vcage.schema.subtasks import Refusal, Subtask, TemplateName
from vcage.tasks.feasibility import Transfer, examine, transfers
from vcage.tasks.findings import Feasibility, best_first
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.stowing import reached
from vcage.tasks.templates.proposal import Proposal, stood_up
from vcage.tasks.workplace import Workplace

_RELATIONS = (
    "left_of", "right_of", "in_front_of", "behind", "beside", "near", "row_left_of", "back", "centred", "moved_away",
    "facing_robot", "in_place_of", "upright",
)  # fmt: skip


@dataclass(frozen=True)
class SetDown:
    """A template that puts an object somewhere on the table.

    Args:
        name: of the template.
        wants: selects the goals about an object worth trying, of the requested ones and others.
    """

    name: TemplateName
    wants: Callable[[SceneObject, Collection[Goal]], Iterable[Goal]]

    def proposals(self, objects: Sequence[SceneObject], asked: Collection[Goal]) -> tuple[list[Move], list[Refusal]]:
        """Every object with each goal wanted of it, and the objects that cannot be carried."""
        found, refused = [], []
        for thing in objects:
            moves = [Move(self.name, thing, goal) for goal in dict.fromkeys(self.wants(thing, asked))]
            if thing.asset.annotation.carrying_points:
                found += moves
            else:
                refused += [move.not_carried() for move in moves]
        return found, refused

    def calls(self, subtask: Subtask) -> list[str]:
        """The lines of the script's ``play``; GRASPS is a constant of the script."""
        return [
            f"task.pick({subtask.object!r}, grasps=[(contact, arm) for contact, arm, _ in GRASPS])",
            "task.place()",
            "task.home()",
        ]


def _aside(thing: SceneObject, asked: Collection[Goal]) -> list[Goal]:
    """Beside, back…, on request; out of the way, for an object inside another now or later."""
    about = [goal for goal in asked if goal.subject == thing.id]
    on_table = [Goal(subject=thing.id, relation="on", reference=TABLE)]
    return [g for g in about if g.relation in _RELATIONS] + (on_table if about or thing.record.container else [])


SET_DOWN = SetDown("set_down", _aside)


@dataclass(frozen=True)
class Move(Proposal):
    """An object and its goal after it is put down."""

    @property
    def goals(self) -> list[Goal]:
        """Its goals: it stands on the table besides."""
        on_table = Goal(subject=self.thing.id, relation="on", reference=TABLE)
        return list(dict.fromkeys([self.goal, on_table, *stood_up(self.thing)]))

    def impossible(self) -> Refusal | None:
        """Refuse to put an object back on the table that did not stand there."""
        if self.goal.relation == "back" and self.thing.record.container is not None:
            return self.refusal(f"{self.thing.record.phrase} did not stand on the table at the start")
        return None

    def examine(self, workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task if an arm can bring the object to one of a few places, else the refusals."""
        there = reached(self.thing, workplace.others(self.thing.id))
        thing, others = there.thing, workplace.ground.after_leaving(self.goal, there.others)
        poses = list(islice(workplace.ground.poses(thing, self.goal, others, workplace.rng), LIMITS.table_places))
        if not poses:
            return None, [self.refusal(f"there is no room in reach on the table {self._wanted}")]
        ways = transfers(thing, None, None, poses, others)
        findings, refused = self.judged({contact: self._finding(way, workplace) for contact, way in ways.items()})
        if not findings:
            return None, refused
        grasps, checks = best_first(findings)
        slots = {"receptacle": TABLE, "grasps": grasps, "hand_to": self.hand_to, "goals": self.goals, "checks": checks}
        return self.subtask(self._identifier(), workplace.objects, requires=there.requires, **slots), refused

    @property
    def _wanted(self) -> str:
        """A condition on its place, in words."""
        return f"so that {self.goal}"

    def _finding(self, transfer: Transfer, workplace: Workplace) -> Feasibility:
        return examine(transfer, workplace)

    def _identifier(self) -> str:
        word = {"on": "onto", "presented": "shown", "back": "back"}.get(self.goal.relation, self.goal.relation)
        name = f"{self.thing.id}-{word}"
        return name if word in ("shown", "back", "centred") else f"{name}-{self.goal.reference or TABLE}"
