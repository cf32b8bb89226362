"""Hang: the closed handle of a thing is slid over a peg of a rack, where the thing stays."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from vcage.base.geometry import Pose
from vcage.objects.pegs import loops_of, pegs_of
from vcage.schema.asset import ContactPoint
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Check, Refusal, Subtask, TemplateName
from vcage.sim.kinematics import ArmKinematics, follow
from vcage.tasks.feasibility import opens_wide_enough, picks
from vcage.tasks.findings import Feasibility, Report, best_first, reach_check, travel
from vcage.tasks.hanging import free_pegs, hanging_ways, leaves_free, suits
from vcage.tasks.primitives.grip import sag
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates.proposal import Proposal, carried
from vcage.tasks.workplace import Workplace

NAME: TemplateName = "hang"


class Hang:
    """The template, on request."""

    name = NAME

    def proposals(self, objects: Sequence[SceneObject], asked: Collection[Goal]) -> tuple[list[Hanging], list[Refusal]]:
        """Each thing to hang on a rack that stands there, and those that cannot be carried."""
        by_id = {o.id: o for o in objects}
        goals = [goal for goal in asked if goal.relation == "hung_on" and goal.reference in by_id]
        found, refused = carried(Hanging, NAME, "hung_on", objects, goals)
        asks = Counter(str(goal.reference) for goal in goals)
        over = {name: by_id[name] for name, number in asks.items() if number > len(pegs_of(by_id[name].asset)) > 0}
        refused += [one.too_many(over[one.goal.reference]) for one in found if one.goal.reference in over]
        return [one for one in found if one.goal.reference not in over], refused

    def calls(self, subtask: Subtask) -> list[str]:
        """The lines of the script's ``play``; GRASPS is a constant of the script."""
        grasps = "[(contact, arm) for contact, arm, _ in GRASPS]"
        rack = subtask.goals[0].reference
        return [f"task.hang({subtask.object!r}, {rack!r}, grasps={grasps})", "task.home()"]


@dataclass(frozen=True)
class Hanging(Proposal):
    """A thing, and its goal to hang on a rack."""

    def too_many(self, rack: SceneObject) -> Refusal:
        """The refusal where more things are to hang on a rack than it has pegs."""
        return self.refusal(
            f"{rack.record.phrase} has {len(pegs_of(rack.asset))} pegs, and more things are to hang on it"
        )

    def impossible(self) -> Refusal | None:
        """The thing must have a closed handle, and stand on the table."""
        phrase = self.thing.record.phrase
        if not loops_of(self.thing.asset):
            return self.refusal(f"{phrase} has no closed handle to hang it by")
        if self.thing.record.container is not None:
            return self.refusal(f"{phrase} does not stand on the table; put it there first")
        return None

    def examine(self, workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task if an arm can slide the thing over a free peg, else a refusal for each contact point."""
        rack = workplace.by_id[str(self.goal.reference)]
        others = tuple(workplace.others(self.thing.id))
        if (why := _unfit(self.thing, rack, others)) is not None:
            return None, [self.refusal(why)]
        found, refused = dict[int, Feasibility](), list[Refusal]()
        for contact in self.thing.asset.annotation.carrying_points:
            arms, why = self._suitable(contact, workplace.kinematics)
            if arms:
                found[contact.id] = _Hold(self.thing, contact, rack, others).examined(arms, workplace.ground.height)
            else:
                refused.append(self.refusal(why, contact.id))
        findings, others_refused = self.judged(found)
        if not findings:
            return None, [*refused, *others_refused]
        grasps, checks = best_first(findings)
        slots = {"grasps": grasps, "checks": checks, "grasped": self.thing.id}
        identifier = f"{self.thing.id}-hung-on-{rack.id}"
        return self.subtask(identifier, workplace.objects, **slots), [*refused, *others_refused]

    def _suitable(
        self, contact: ContactPoint, kinematics: Mapping[str, ArmKinematics]
    ) -> tuple[dict[str, ArmKinematics], str]:
        """The arms that hold the thing at a contact point level and its handle free; else why there is none."""
        held, loops = f"held at {contact.name!r}, {self.thing.record.phrase}", loops_of(self.thing.asset)
        free = {
            arm: one
            for arm, one in kinematics.items()
            if any(leaves_free(contact, loop, one.arm.gripper) for loop in loops)
        }
        if not free:
            return free, f"{held} has fingers in its handle, through which the peg must pass"
        level = {arm: one for arm, one in free.items() if not sag(self.thing, contact, one.arm.gripper)}
        return level, f"{held} turns between the fingers"


@dataclass(frozen=True)
class _Hold:
    """A thing that is held at a contact point, and slid over a peg among other objects."""

    thing: SceneObject
    contact: ContactPoint
    rack: SceneObject
    others: tuple[SceneObject, ...]

    def examined(self, kinematics: Mapping[str, ArmKinematics], table_height: float) -> Feasibility:
        """The findings for some arms: one must grasp the thing here, and bring it over a peg."""
        wide = opens_wide_enough(self.thing, self.contact, kinematics)
        if not wide.passed:
            return Feasibility([wide], [])
        ways = list(hanging_ways(self.thing, self.rack, self.others))
        reports = {arm: self._report(ways, arm, one, table_height) for arm, one in kinematics.items()}
        return Feasibility.of_arms(self.contact.id, [wide], reports)

    def _report(
        self, ways: Sequence[Sequence[Pose]], arm: str, kinematics: ArmKinematics, table_height: float
    ) -> Report:
        """The checks of an arm, and the score of its straightest grasp with which it reaches a peg."""
        where, found = f"a peg of {self.rack.record.phrase}", list[Check]()
        for pick in picks(self.thing, self.contact.id, self.others, arm, kinematics, table_height):
            if pick.path is None:
                found = found or pick.checks
                continue
            held, start = pick.grasp.in_object, pick.path[-1]
            paths = (follow(kinematics, [pose * held for pose in way], start) for way in ways)
            path = next((path for path in paths if path is not None), None)
            found = [*pick.checks, reach_check("reach_motion", where, path is not None, arm)]
            if path is not None:
                return found, -travel([kinematics.home, *pick.path, *path, kinematics.home])
        return found, None


def _unfit(thing: SceneObject, rack: SceneObject, others: Sequence[SceneObject]) -> str | None:
    """Why a thing is not hung on a rack, whatever an arm can do; None where it may be."""
    name, there = thing.record.phrase, rack.record.phrase
    if not pegs_of(rack.asset):
        return f"{there} has no peg to hang something on"
    free = free_pegs(rack, others)
    if not free:
        return f"every peg of {there} is taken"
    if not any(suits(loop, peg) for loop in loops_of(thing.asset) for peg in free):
        return f"the pegs of {there} are too thick for the handle of {name}"
    return None
