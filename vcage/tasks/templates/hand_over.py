"""Hand over: one arm takes an object, another takes it from that in the air and puts it down.

It is tried on request. An object for another one, where no arm reaches both, changes hands too:
see :mod:`~vcage.tasks.templates.place`.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from vcage.schema.goals import Goal
from vcage.schema.subtasks import Check, Refusal, Subtask, TemplateName
from vcage.sim.kinematics import ArmKinematics
from vcage.tasks.feasibility import Transfer, opens_wide_enough, picks
from vcage.tasks.findings import Feasibility, Report, reach_check, travel
from vcage.tasks.meeting import Hold, NoMeeting, Suits, meeting_height, meetings
from vcage.tasks.primitives.place import Surroundings
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates.set_down import Move
from vcage.tasks.workplace import Workplace


def examine_passing(transfer: Transfer, to: str, workplace: Workplace) -> Feasibility:
    """All checks of a transfer with a hand-over, with the grasps of the arms that can give it.

    Args:
        transfer: to try; its contact point is the giving arm's.
        to: the arm that takes it and brings it to its place.
        workplace: with the arms.
    """
    wide = opens_wide_enough(transfer.target, transfer.contact, workplace.kinematics)
    if not wide.passed:
        return Feasibility([wide], [])
    givers = [arm for arm in workplace.kinematics if arm != to]
    reports = {arm: _examine_giver(transfer, arm, to, workplace) for arm in givers}
    return Feasibility.of_arms(transfer.contact.id, [wide], reports)


def examine_detour(transfers: Sequence[Transfer], workplace: Workplace) -> tuple[str | None, list[Feasibility]]:
    """The arm that can bring an object to its place after another has given it to it, and the findings.

    If none can, the arm is None, and the findings are of the last one.

    Args:
        transfers: of one object to one place, by each of its contact points.
        workplace: with the arms.
    """
    found: dict[str, list[Feasibility]] = {}
    for to in workplace.kinematics if len(workplace.kinematics) > 1 else ():
        found[to] = [examine_passing(transfer, to, workplace) for transfer in transfers]
    best = {to: max((g.score for f in finding for g in f.grasps), default=None) for to, finding in found.items()}
    able = {to: score for to, score in best.items() if score is not None}
    if not able:
        return None, next(reversed(found.values()), [])
    to = max(able, key=able.__getitem__)
    return to, [finding for finding in found[to] if finding.feasible]


def _examine_giver(transfer: Transfer, arm: str, to: str, workplace: Workplace) -> Report:
    """The checks of the grasp that got furthest, and the score of the first success."""
    target, table_height = transfer.target, workplace.ground.height
    giver, taker = workplace.kinematics[arm], workplace.kinematics[to]
    width = target.asset.grasp_width(transfer.contact)
    suits, furthest = _brings(transfer, taker, transfer.heights(table_height)), list[Check]()
    for pick in picks(target, transfer.contact.id, tuple(transfer.others), arm, giver, table_height):
        checks, picked = list(pick.checks), pick.path
        if picked is not None:
            try:
                given = Hold(pick.grasp.in_object, width)
                meet_at = meeting_height(target, given, giver.arm.gripper, transfer.others, table_height)
                found = next(meetings(target, given, (giver, taker), meet_at, suits))
            except NoMeeting as error:
                checks.append(Check(name=error.check, passed=False, message=error.message))
            else:
                met = f"the {arm} and the {to} arm reach {target.record.phrase} between them"
                checks.append(Check(name="reach_meeting", passed=True, message=met))
                checks.append(reach_check("reach_place", transfer.where, True, to))
                ways = [giver.home, *picked, found.giving, giver.home], [taker.home, found.taking, taker.home]
                return checks, -sum(map(travel, ways))
        furthest = checks if len(checks) > len(furthest) else furthest
    return furthest, None


def _brings(transfer: Transfer, taker: ArmKinematics, heights: tuple[float, ...]) -> Suits:
    """Return the check that the taking arm can bring an object to the transfer's place.

    Args:
        heights: z's that the object's bottom may keep on the way, the highest first, metres.
    """

    def suits(hold: Hold) -> None:
        around = Surroundings(transfer.where, transfer.obstacles, heights, drop_m=transfer.drop_m)
        around.ways(taker, hold.in_object, hold.width, transfer.poses, taker.home)

    return suits


NAME: TemplateName = "hand_over"


class HandOver:
    """The template."""

    name = NAME

    def proposals(self, objects: Sequence[SceneObject], asked: Collection[Goal]) -> tuple[list[Handing], list[Refusal]]:
        """Each object to hand to an arm."""
        by_id = {o.id: o for o in objects}
        goals = sorted((g for g in asked if g.relation == "handed" and g.subject in by_id), key=str)
        return [Handing(NAME, by_id[goal.subject], goal) for goal in goals], []

    def calls(self, subtask: Subtask) -> list[str]:
        """The lines of the script's ``play``; GRASPS is a constant of the script."""
        point = subtask.functional_point
        where = "" if point is None else f"{subtask.receptacle!r}, point={point}"
        grasps = "[(contact, arm) for contact, arm, _ in GRASPS]"
        return [
            f"task.pick({subtask.object!r}, grasps={grasps}, hand_to={subtask.hand_to!r})",
            f"task.hand_over({subtask.hand_to!r})",
            f"task.place({where})",
            "task.home()",
        ]


@dataclass(frozen=True)
class Handing(Move):
    """An object and its receiving arm, which puts it down."""

    def impossible(self) -> Refusal | None:
        """Refuse an object that cannot be carried."""
        return None if self.candidates else self.not_carried()

    def examine(self, workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task if another arm can give it and the arm put it down, else a refusal for each contact point."""
        if self.hand_to not in workplace.kinematics or len(workplace.kinematics) == 1:
            reason = f"the arms are {', '.join(workplace.kinematics)}: none hands anything to {self.hand_to!r}"
            return None, [self.refusal(reason)]
        return super().examine(workplace)

    @property
    def hand_to(self) -> str:
        """The receiving arm."""
        return str(self.goal.reference)

    @property
    def _wanted(self) -> str:
        return f"on the side of the {self.hand_to} arm"

    def _finding(self, transfer: Transfer, workplace: Workplace) -> Feasibility:
        return examine_passing(transfer, self.hand_to, workplace)

    def _identifier(self) -> str:
        return f"{self.thing.id}-handed-{self.hand_to}"
