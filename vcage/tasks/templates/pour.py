"""Pour: a vessel is tipped over a container until all the balls in it lie in that, and put back."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose
from vcage.goals.thresholds import THRESHOLDS
from vcage.schema.asset import ContactPoint
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Check, Refusal, Subtask, TemplateName
from vcage.sim.kinematics import ArmKinematics
from vcage.tasks.feasibility import opens_wide_enough, picks
from vcage.tasks.findings import Feasibility, Report, best_first, reach_check, travel
from vcage.tasks.pouring import balls_in, followed, lips, pouring_ways
from vcage.tasks.primitives.grip import holds_firmly
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import lying_on
from vcage.tasks.stowing import heaped_in, open_point
from vcage.tasks.templates.proposal import Proposal, carried
from vcage.tasks.workplace import Workplace

NAME: TemplateName = "pour"


class Pour:
    """The template, on request."""

    name = NAME

    def proposals(self, objects: Sequence[SceneObject], asked: Collection[Goal]) -> tuple[list[Pouring], list[Refusal]]:
        """Each vessel to pour into a container that stands there, and those that cannot be carried."""
        ids = {o.id for o in objects}
        return carried(Pouring, NAME, "poured", objects, [goal for goal in asked if goal.reference in ids])

    def calls(self, subtask: Subtask) -> list[str]:
        """The lines of the script's ``play``; GRASPS is a constant of the script."""
        grasps = "[(contact, arm) for contact, arm, _ in GRASPS]"
        target = subtask.goals[0].reference
        return [f"task.pour({subtask.object!r}, {target!r}, grasps={grasps})", "task.home()"]


@dataclass(frozen=True)
class Pouring(Proposal):
    """A vessel, and its goal to be poured into a container."""

    def impossible(self) -> Refusal | None:
        """The vessel must be open at the top and held beside its lip, and stand on the table."""
        phrase = self.thing.record.phrase
        if open_point(self.thing.asset) is None:
            return self.refusal(f"{phrase} is no vessel: nothing lies in it that could be poured")
        if not any(lips(self.thing, contact) for contact in self.thing.asset.annotation.carrying_points):
            return self.refusal(f"{phrase} is only held where its contents would roll over the fingers")
        if self.thing.record.container is not None:
            return self.refusal(f"{phrase} does not stand on the table; put it there first")
        return None

    def examine(self, workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task if an arm can tip the vessel over the container, else a refusal for each contact point."""
        target = workplace.by_id[str(self.goal.reference)]
        others = workplace.others(self.thing.id)
        if (why := _unfit(self.thing, target, others)) is not None:
            return None, [self.refusal(why)]
        around = tuple(o for o in others if o not in lying_on(self.thing, others))
        found, refused = dict[int, Feasibility](), list[Refusal]()
        for contact in self.thing.asset.annotation.carrying_points:
            width = self.thing.asset.grasp_width(contact)
            firm = {a: k for a, k in workplace.kinematics.items() if holds_firmly(k.arm.gripper, width)}
            if firm:
                found[contact.id] = _Hold(self.thing, contact, target, around).examined(firm, workplace.ground.height)
            else:
                why = f"held at {contact.name!r}, {self.thing.record.phrase} turns between fingers that are not firm"
                refused.append(self.refusal(why, contact.id))
        findings, others_refused = self.judged(found)
        if not findings:
            return None, [*refused, *others_refused]
        grasps, checks = best_first(findings)
        slots = {"grasps": grasps, "checks": checks, "grasped": self.thing.id}
        identifier = f"{self.thing.id}-poured-into-{target.id}"
        return self.subtask(identifier, workplace.objects, **slots), [*refused, *others_refused]


@dataclass(frozen=True)
class _Hold:
    """A vessel that is held at a contact point, and tipped over a container among other objects."""

    vessel: SceneObject
    contact: ContactPoint
    target: SceneObject
    others: tuple[SceneObject, ...]

    def examined(self, kinematics: Mapping[str, ArmKinematics], table_height: float) -> Feasibility:
        """The findings for some arms: one must grasp the vessel here, and tip it."""
        wide = opens_wide_enough(self.vessel, self.contact, kinematics)
        if not wide.passed:
            return Feasibility([wide], [])
        ways = list(pouring_ways(self.vessel, self.target, self.contact))
        reports = {arm: self._report(ways, arm, one, table_height) for arm, one in kinematics.items()}
        return Feasibility.of_arms(self.contact.id, [wide], reports)

    def _report(
        self, ways: Sequence[Sequence[Pose]], arm: str, kinematics: ArmKinematics, table_height: float
    ) -> Report:
        """The checks of an arm, and the score of its straightest grasp with which it tips the vessel."""
        where, found = f"its place over {self.target.record.phrase}, tipped", list[Check]()
        for pick in picks(self.vessel, self.contact.id, self.others, arm, kinematics, table_height):
            if pick.path is None:
                found = found or pick.checks
                continue
            paths = (followed(kinematics, way, pick.grasp.in_object, pick.path[-1]) for way in ways)
            path = next((path for path in paths if path is not None), None)
            found = [*pick.checks, reach_check("reach_motion", where, path is not None, arm)]
            if path is not None:
                return found, -travel([kinematics.home, *pick.path, *path, kinematics.home])
        return found, None


def _unfit(vessel: SceneObject, target: SceneObject, others: Sequence[SceneObject]) -> str | None:
    """Why a vessel is not poured into a container, whatever an arm can do; None where it may be."""
    name, there = vessel.record.phrase, target.record.phrase
    contents = lying_on(vessel, others)
    strange = [o for o in contents if o.asset.ball_radius is None]
    point = open_point(target.asset)
    if not contents:
        return f"nothing lies in {name} that could be poured"
    if strange:
        return f"{strange[0].record.phrase} lies in {name}, and only balls are poured"
    if point is None:
        return f"{there} is not open at the top: nothing is poured into it"
    if there_already := lying_on(target, others):
        return f"{there_already[0].record.phrase} lies in {there}, and things are poured into what is empty"
    size = target.asset.opening(point).size
    if min(size) < THRESHOLDS.poured_into_m:
        room = f"{100 * size[0]:.1f} × {100 * size[1]:.1f} cm"
        return f"{there} is too narrow to pour into: {room}, and {100 * THRESHOLDS.poured_into_m:.0f} cm are needed"
    if target.pose.rotation()[2, 2] < np.cos(THRESHOLDS.upright_rad):
        return f"{there} is tipped"
    try:
        heaped_in(target, balls_in(vessel, others), np.random.default_rng(0))
    except InfeasibleScene as error:
        return error.message
    return None
