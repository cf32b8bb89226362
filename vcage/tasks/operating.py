"""Feasibility of operating a part: a hand follows the motion of a drawer, lid, button or knob."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from vcage.schema.asset import ContactPoint
from vcage.schema.goals import part_words
from vcage.schema.subtasks import Check
from vcage.sim.joints import carried_by, joint_positions
from vcage.sim.kinematics import ArmKinematics, follow
from vcage.tasks.feasibility import opens_wide_enough
from vcage.tasks.findings import Feasibility, Report, hand_check, reach_check, travel
from vcage.tasks.grasps import hand_boxes
from vcage.tasks.primitives.handles import Handle, operating_ways
from vcage.tasks.scene_objects import SceneObject, SolidBox, first_met


def examine_operation(
    thing: SceneObject,
    contact: ContactPoint,
    target: float,
    others: Sequence[SceneObject],
    kinematics: Mapping[str, ArmKinematics],
) -> Feasibility:
    """All checks of bringing the part that a contact point is on to a joint position.

    Args:
        thing: the object, its joints where they are before.
        contact: on the part.
        target: position of the joint, metres or radians.
        others: the other objects of the scene.
        kinematics: by arm.
    """
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
    """The checks of the way that came furthest, and the score of the first that an arm can follow."""
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
    """The phrase of the first object that a part, or another that moves with it, would touch where it is now.

    The contents of the object move with it.
    """
    parts = [thing.part_box(name) for name in carried_by(thing.asset.model, link)]
    return _phrase_of(first_met(parts, [o for o in others if o.record.container != thing.id]))


def _phrase_of(thing: SceneObject | None) -> str | None:
    return None if thing is None else thing.record.phrase
