"""The common part of opening, closing, pressing and turning: a hand brings a moving part to a position."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from vcage.schema.asset import ContactPoint, Joint
from vcage.schema.goals import Goal, part_that, part_words
from vcage.schema.subtasks import Check, Refusal, Subtask, TemplateName
from vcage.sim.joints import carried_by, joint_positions
from vcage.sim.kinematics import ArmKinematics, follow
from vcage.tasks.access import shut_above
from vcage.tasks.feasibility import opens_wide_enough
from vcage.tasks.findings import Feasibility, Report, hand_check, reach_check, travel
from vcage.tasks.grasps import hand_boxes
from vcage.tasks.primitives.handles import Handle, operating_ways
from vcage.tasks.scene_objects import SceneObject, SolidBox, first_met
from vcage.tasks.templates.proposal import Proposal
from vcage.tasks.workplace import Workplace


def examine_operation(thing: SceneObject, contact: ContactPoint, target: float, workplace: Workplace) -> Feasibility:
    """All checks of moving the part with a contact point to a joint position.

    Args:
        thing: the object, its joints where they are before.
        contact: on the part.
        target: position of the joint, metres or radians.
        workplace: with the other objects.
    """
    others, kinematics = workplace.others(thing.id), workplace.kinematics
    width = thing.asset.grasp_width(contact)
    handle = Handle(contact, thing.asset.model, thing.pose, joint_positions(thing.asset.model, thing.joints), width)
    met = _part_meets(thing.moved(thing.pose, tuple(handle.joints_at(target))), str(contact.link), others)
    if met is not None:
        message = f"{met} is in the way of the {part_words(str(contact.link))} of {thing.record.phrase}"
        return Feasibility([Check(name="way_free", passed=False, message=message)], [])
    wide = opens_wide_enough(thing, contact, kinematics)
    if contact.use == "grasp" and not wide.passed:
        return Feasibility([wide], [])
    reports = {arm: _examine_ways(handle, thing, target, others, arm, k) for arm, k in kinematics.items()}
    return Feasibility.of_arms(contact.id, [wide] if contact.use == "grasp" else [], reports)


def _examine_ways(
    handle: Handle,
    thing: SceneObject,
    target: float,
    others: Sequence[SceneObject],
    arm: str,
    kinematics: ArmKinematics,
) -> Report:
    """The checks of the path that got furthest, and the score of the first that an arm can follow."""
    gripper = kinematics.arm.gripper
    where = f"{handle.contact.name!r} of {thing.record.phrase}"
    furthest: list[Check] = []
    for way in operating_ways(handle, target, gripper, thing.box.bottom):
        boxes = hand_boxes(gripper, way.opening, min(handle.width, way.opening))
        checks = [hand_check("at", where, _phrase_of(first_met([SolidBox(box, way.grasp) for box in boxes], others)))]
        if checks[-1].passed:
            reached = follow(kinematics, [way.before, way.grasp], kinematics.home)
            checks.append(reach_check("reach_grasp", where, reached is not None, arm))
            if reached is not None:
                moved = follow(kinematics, [*way.motion, way.after], reached[-1])
                checks.append(reach_check("reach_motion", f"{where} all along its way", moved is not None, arm))
                if moved is not None:
                    return checks, -travel([kinematics.home, *reached, *moved, kinematics.home])
        furthest = checks if len(checks) > len(furthest) else furthest
    return furthest, None


def _part_meets(thing: SceneObject, link: str, others: Sequence[SceneObject]) -> str | None:
    """The phrase of the first object that a part, or another one moving with it, would touch at its present position.

    The contents of the object move with it.
    """
    parts = [thing.part_box(name) for name in carried_by(thing.asset.model, link)]
    return _phrase_of(first_met(parts, [o for o in others if o.record.container != thing.id]))


def _phrase_of(thing: SceneObject | None) -> str | None:
    return None if thing is None else thing.record.phrase


@dataclass(frozen=True)
class Operated:
    """A template for parts that are operated.

    Args:
        name: of the template.
        action: which parts: those that ``open``, are ``press``-ed, or ``turn``-ed.
        word: the goal that it brings about.
        closes: True if the joint goes from its far end to rest, else the other way.
        opposite: the goal that must be true before.
    """

    name: TemplateName
    action: str
    word: str
    closes: bool = False
    opposite: str | None = None

    def ends(self, joint: Joint) -> tuple[float, float]:
        """Positions of a joint before and after, metres or radians."""
        return (joint.far_end, 0.0) if self.closes else (0.0, joint.far_end)

    def proposals(
        self, objects: Sequence[SceneObject], asked: Collection[Goal]
    ) -> tuple[list[Operable], list[Refusal]]:
        """Every part of the kind with each of its contact points, and the parts that have none."""
        found, refused = [], []
        for thing in objects:
            for part in (link.name for link in thing.asset.model.links if part_that(self.action, link.name)):
                contacts = [c for c in thing.asset.annotation.contact_points if c.link == part]
                goal = Goal(subject=thing.id, relation=self.word, part=part)
                if not contacts:
                    reason = f"{thing.record.phrase} has no contact point on its {part} to {self.name} it by"
                    refused.append(Refusal(template=self.name, object=thing.id, goal=goal, reason=reason))
                found += [Operable(self.name, thing, goal, self, part, contact) for contact in contacts]
        return found, refused

    def calls(self, subtask: Subtask) -> list[str]:
        """The line of the script's ``play``; GRASPS is a constant of the script."""
        return [f"task.operate({subtask.object!r}, GRASPS[0][0], {subtask.target}, arms=[arm for _, arm, _ in GRASPS])"]


@dataclass(frozen=True)
class Operable(Proposal):
    """A part of an object with a contact point on it."""

    template: Operated
    part: str
    contact: ContactPoint

    @property
    def candidates(self) -> int:
        """One: a contact point."""
        return 1

    def offers(self, subtask: Subtask) -> bool:
        """True where a sub-task brings the part there."""
        _, target = self.template.ends(self.thing.asset.model.link(self.part).joint)
        return super().offers(subtask) and subtask.target == round(target, 4)

    def examine(self, workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task if an arm can follow the part's motion, else the refusal."""
        start, target = self.template.ends(self.thing.asset.model.link(self.part).joint)
        before = self.thing.with_part(self.part, start)
        finding = examine_operation(before, self.contact, target, workplace)
        if not finding.feasible:
            return None, [self.refusal(finding.reason, self.contact.id, finding.checks)]
        return (
            self.subtask(
                f"{self.name}-{self.thing.id}-{self.part}",
                workplace.objects,
                target=round(target, 4),
                grasps=finding.grasps,
                requires=self._requires(),
                checks=finding.checks,
            ),
            [],
        )

    def _requires(self) -> list[Goal]:
        """Goals that must be true before: the other position, and no open drawer above the hand."""
        opposite = self.template.opposite
        if opposite is None:
            return []
        return [Goal(subject=self.thing.id, relation=opposite, part=self.part), *shut_above(self.thing, self.part)]
