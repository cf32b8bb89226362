"""A hand that grips a thing and does not lift it, made from a lift that succeeded in the simulator."""

from __future__ import annotations

from dataclasses import replace

from benchmarks._critic.played import HELD, LIFTS, OPEN, Played, Shots
from vcage.sim.kinematics import kinematics_of
from vcage.sim.state import WorldState


def only_gripped(played: Played) -> Shots | None:
    """The hand closed on it, and it stayed where it stood. None for other goals, without a picture of the moment, and
    where an arm does not reach it so. Of a shake both moments show the same."""
    shots = played.shots
    if played.goal.relation not in LIFTS or shots.moment is None:
        return None
    moments = [_lowered(played, state) for state in shots.moments]
    found = [state for state in moments if state is not None]
    if len(found) < len(moments):
        return None
    after = found[0] if played.goal.relation in HELD else shots.after
    return played.untrue("it was gripped, and not lifted", moments=found, after=after)


def _lowered(played: Played, state: WorldState) -> WorldState | None:
    """A state with the object where it stood, and each hand that is not wide open moved with it; None where one does
    not reach."""
    name, world = played.goal.subject, played.case.build()
    was, held = played.shots.before.objects[name], state.objects[name]
    world.set_state(state)
    joints = dict(state.joints)
    for key, arm in world.arms.items():
        if arm.opening >= OPEN:
            continue
        q = kinematics_of(arm.arm).ik(was * held.inverse() * arm.tool_pose, arm.joints)
        if q is None:
            return None
        order = [joint.name for joint in arm.articulation.active_joints]
        joints[key] = state.joints[key].copy()
        joints[key][[order.index(joint) for joint in arm.arm.joints]] = q
    return replace(state, objects={**state.objects, name: was}, joints=joints)
