"""Feasibility of passing: one arm takes an object, another takes it over and brings it to its place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from vcage.schema.subtasks import Check
from vcage.sim.kinematics import ArmKinematics
from vcage.tasks.feasibility import Transfer, opens_wide_enough
from vcage.tasks.findings import Feasibility, Report, reach_check, travel
from vcage.tasks.meeting import Hold, NoMeeting, Suits, meeting_height, meetings
from vcage.tasks.picks import picks
from vcage.tasks.primitives.place import Surroundings


def examine_passing(
    transfer: Transfer, to: str, kinematics: Mapping[str, ArmKinematics], table_height: float
) -> Feasibility:
    """All checks of a transfer in which the object changes hands, with the grasps of the arms that can give it.

    Args:
        transfer: to try; its contact point is the giving arm's.
        to: the arm that takes it and brings it to its place.
        kinematics: by arm.
        table_height: z of the table top, metres.
    """
    wide = opens_wide_enough(transfer.target, transfer.contact, kinematics)
    if not wide.passed:
        return Feasibility([wide], [])
    reports = {arm: _examine_giver(transfer, arm, to, kinematics, table_height) for arm in kinematics if arm != to}
    return Feasibility.of_arms(transfer.contact.id, [wide], reports)


def examine_detour(
    transfers: Sequence[Transfer], kinematics: Mapping[str, ArmKinematics], table_height: float
) -> tuple[str | None, list[Feasibility]]:
    """The arm that can bring an object to its place after another has given it to it, and the findings.

    Where none can, the arm is None, and the findings are those of the last.

    Args:
        transfers: of one object to one place, by each of its contact points.
        kinematics: by arm.
        table_height: z of the table top, metres.
    """
    found: dict[str, list[Feasibility]] = {}
    for to in kinematics if len(kinematics) > 1 else ():
        found[to] = [examine_passing(transfer, to, kinematics, table_height) for transfer in transfers]
    best = {to: max((g.score for f in finding for g in f.grasps), default=None) for to, finding in found.items()}
    able = {to: score for to, score in best.items() if score is not None}
    if not able:
        return None, next(reversed(found.values()), [])
    to = max(able, key=able.__getitem__)
    return to, [finding for finding in found[to] if finding.feasible]


def _examine_giver(
    transfer: Transfer, arm: str, to: str, kinematics: Mapping[str, ArmKinematics], table_height: float
) -> Report:
    """The checks of the grasp that came furthest, and the score of the first that does."""
    target, giver, taker = transfer.target, kinematics[arm], kinematics[to]
    width = target.asset.grasp_width(transfer.contact)
    meet_at = meeting_height(target, transfer.others, table_height)
    suits, furthest = _brings(transfer, taker, transfer.heights(table_height)), list[Check]()
    for pick in picks(target, transfer.contact.id, tuple(transfer.others), arm, giver, table_height):
        checks, picked = list(pick.checks), pick.path
        if picked is not None:
            try:
                given = Hold(pick.grasp.in_object, width)
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
        around, home = Surroundings(transfer.where, transfer.obstacles, heights), taker.home
        around.ways(taker, hold.in_object, hold.width, transfer.poses, home)

    return suits
