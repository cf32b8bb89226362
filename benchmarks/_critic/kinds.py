"""Ways to fail that are made by hand of the simulator."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks._critic.grips import only_gripped
from benchmarks._critic.hangs import fell_beside, leans_on_it, still_in_the_hand, stood_beside
from benchmarks._critic.hits import hit_another, hit_beside, not_down
from benchmarks._critic.inserts import block_pushed, half_in, lies_before_the_hole, lies_beside, lies_on_top
from benchmarks._critic.played import DROP, HELD, LIFTS, Kind, Played, Shots
from benchmarks._critic.pours import (
    half_beside,
    missed,
    poured_elsewhere,
    poured_half,
    poured_nothing,
    vessel_dropped,
)
from benchmarks._critic.shakes import hung_plumb, hung_still, leaned_once
from benchmarks._critic.supports import beside, knocked_over, on_the_rim, pushed_away, slid_off
from benchmarks._critic.tools import dropped_tool, swept
from benchmarks._critic.uprights import fell_over, on_its_head, still_held, still_lying
from benchmarks._critic.wipes import wiped_above, wiped_another, wiped_beside, wiped_spot
from vcage.base.geometry import Pose
from vcage.plans.actions import HOLDING
from vcage.schema.episodes import Truth
from vcage.schema.subtasks import Subtask
from vcage.sim.joints import joint_index
from vcage.sim.state import WorldState
from vcage.tasks.reading import reads

RELATED = ("row_left_of", "left_of", "right_of", "in_front_of", "behind", "beside", "near")
MOVED = (
    *HOLDING, *RELATED, "centred", "presented", "back", "handed", "weighed", "lifted", "shaken", "held_up",
    "held_by_both", "moved_away", "facing_robot", "in_place_of", "upright",
)  # fmt: skip
"""Goals of what is carried or pushed."""

FLOOR = -3.0
"""Far below the table: what has fallen off it is out of every picture."""

DISTURBED = (0.08, 0.16)
"""Range of the distance by which an unrelated thing is moved, metres."""


def nothing(played: Played) -> Shots:
    """Nothing happened: the robot moved and touched nothing."""
    was = played.shots.before
    if played.goal.relation == "pressed":  # whose hand would hit an object outside the press
        return played.untrue("nothing was moved", after=was, moment=None if played.shots.moment is None else was)
    return played.untrue("nothing was moved", moments=played.with_objects_as(was).moments, after=was)


def lost(played: Played) -> Shots | None:
    """The carried thing fell on the way."""
    if played.goal.relation not in MOVED:
        return None
    thing, old, new = played.subject, *played.ends
    share = played.rng.uniform(0.25, 0.75)
    at = old.p + share * (new.p - old.p)
    lying = played.tumbled(Pose([at[0], at[1], played.surface(at, thing) + DROP], thing.pose.q))
    return played.instead({thing.id: lying})


def off_table(played: Played) -> Shots | None:
    """The moved thing fell off the table."""
    if played.goal.relation not in MOVED:
        return None
    state = played.shots.after
    gone = played.closed(replace(state, objects={**state.objects, played.goal.subject: Pose([0.0, 0.0, FLOOR])}))
    return played.untrue("it fell off the table", moments=played.with_objects_as(gone).moments, after=gone)


def wrong_object(played: Played) -> Shots | None:
    """Another object was put there, a look-alike if there is one."""
    if played.goal.relation not in MOVED:
        return None
    thing, (old, new) = played.subject, played.ends
    rivals = [o for o in played.loose if o.id != thing.id]
    alike = [o for o in rivals if o.record.asset == thing.record.asset] or rivals
    if not alike:
        return None
    other = alike[int(played.rng.integers(len(alike)))]
    return played.instead({thing.id: old, other.id: Pose([new.p[0], new.p[1], new.p[2] + 0.01], other.pose.q)})


def wrong_place(played: Played) -> Shots | None:
    """It was brought to another thing that could hold it, or elsewhere on the table."""
    if played.goal.relation not in MOVED:
        return None
    thing, avoid = played.subject, {played.goal.subject, played.goal.reference, played.subtask.receptacle}
    tops = [o for o in played.now(played.shots.before).values() if o.id not in avoid]
    tops = [o for o in tops if any(p.link is None for p in o.asset.annotation.functional_points)]
    if not tops or played.rng.random() < 0.3:
        at = played.shots.before.objects[thing.id].p + [*played.step((0.08, 0.2)), DROP]
        return played.instead({thing.id: Pose(at, thing.pose.q)})
    other = tops[int(played.rng.integers(len(tops)))]
    point = next(p for p in other.asset.annotation.functional_points if p.link is None)
    opening = other.asset.opening(point)
    at = other.frame(point.id).apply([*opening.centre, opening.floor + DROP])
    return played.instead({thing.id: Pose(at, thing.pose.q)})


def a_third(played: Played) -> Shots | None:
    """A drawer, lid or knob went a third of its way."""
    return _joint_at(played, (0.25, 0.4))


def sprang_back(played: Played) -> Shots | None:
    """It closed again by itself, or opened again."""
    return _joint_at(played, (0.7, 0.95) if played.goal.kind.rests else (0.0, 0.1))


def pressed_beside(played: Played) -> Shots | None:
    """The finger came down beside the button."""
    if played.goal.relation != "pressed" or played.shots.moment is None:
        return None
    thing, away = played.subject, np.array([*played.step((0.035, 0.07)), 0.0])
    pressing = played.shots.moment
    poses = {thing.id: Pose(thing.pose.p + away, thing.pose.q)}

    def shifted(state: WorldState) -> WorldState:
        joints = {**state.object_joints, thing.id: np.zeros_like(state.object_joints[thing.id])}
        return replace(state, objects={**state.objects, **poses}, object_joints=joints)

    shots = played.shots
    return played.untrue(
        "it was pressed beside the button",
        before=shifted(shots.before),
        moment=shifted(pressing),
        after=shifted(shots.after),
        start=shifted(shots.start),
    )


def from_behind(played: Played) -> Shots | None:
    """The code was turned away from the scanner."""
    shots, still = played.shots, _still(played)
    if still is None or shots.moment is None:
        return None
    turn = np.radians(float(played.rng.choice([90.0, 180.0, 270.0])))

    def turned(state: WorldState) -> WorldState:
        pose = state.objects[still]
        round_ = Pose(pose.p, (Pose.from_yaw([0, 0, 0], turn) * Pose(q=pose.q)).q)
        return replace(state, objects={**state.objects, still: round_})

    states: dict[str, Any] = {when: turned(getattr(shots, when)) for when in ("before", "moment", "after", "start")}
    return None if _is_read(played, states["moment"]) else played.untrue("the code faces elsewhere", **states)


def too_far(played: Played) -> Shots | None:
    """The one was held too far from the other to be read."""
    shots = played.shots
    if _still(played) is None or shots.moment is None:
        return None
    held = str(played.subtask.grasped)
    pose = shots.moment.objects[held]
    away = Pose(pose.p + [*played.step((0.1, 0.18)), 0.0], pose.q)
    moment = replace(shots.moment, objects={**shots.moment.objects, held: away})
    return None if _is_read(played, moment) else played.untrue("it was held too far away", moment=moment)


def wrong_words(played: Played) -> Shots | None:
    """Something was done, but not what the words say. What happened to the same object on the way may be true: a shake
    is a lift, too."""
    others = [s for s in played.case.others if s.goals[0] != played.goal and not _may_have_happened(played, s)]
    near = [s for s in others if s.object == played.subtask.object or s.receptacle == played.subtask.receptacle]
    if not others:
        return None
    pool = near or others
    return played.about(pool[int(played.rng.integers(len(pool)))])


def reversed_order(played: Played) -> Shots | None:
    """The end came first: what should have been brought was taken away."""
    shots = played.shots
    if played.goal.relation in (
        "scanned",
        "pressed",
        "weighed",
        "handed",
        "back",
        "lifted",
        "shaken",
        "hit",
        "wiped",
        "poured",
        *HELD,
    ):
        return None
    if played.instead(ended=False).truth.success:
        return None  # it was true before too
    return played.untrue(
        "it was undone",
        moments=played.with_objects_as(shots.before).moments,
        before=shots.after,
        after=shots.before,
    )


def disturbed(played: Played) -> Shots | None:
    """It was done, and another thing was moved on the way."""
    mine = {
        played.goal.subject,
        played.goal.reference,
        played.subtask.receptacle,
        played.subtask.tool,
        played.subtask.object,
    }
    loose = [o for o in played.loose if o.id not in mine]
    if not loose or not played.shots.truth.success:
        return None
    other = loose[int(played.rng.integers(len(loose)))]
    at = other.pose.p + [*played.step(DISTURBED), 0.01]
    shots = played.instead({other.id: Pose(at, other.pose.q)})
    truth = Truth(success=False, reason=f"{other.id} was moved on the way")
    return replace(shots, moment=played.shots.moment, later=played.shots.later, truth=truth)


def one_arm(played: Played) -> Shots | None:
    """One arm did it by itself; no other took it over, or helped."""
    shots = played.shots
    if played.goal.relation not in ("handed", "held_by_both") or shots.moment is None:
        return None
    arm = shots.arm or str(played.rng.choice(sorted(shots.before.joints)))
    home = {name: joints for name, joints in shots.before.joints.items() if name != arm}
    moment = replace(shots.moment, joints={**shots.moment.joints, **home})
    after = moment if played.goal.relation == "held_by_both" else shots.after
    return played.untrue("no other arm took it", moment=moment, after=after)


def not_lifted(played: Played) -> Shots | None:
    """It stayed on the table under the closed hand."""
    shots = played.shots
    if played.goal.relation not in LIFTS or shots.moment is None:
        return None
    moments = played.with_objects_as(shots.before).moments
    after = moments[0] if played.goal.relation in HELD else shots.after
    return played.untrue("it was not lifted", moments=moments, after=after)


def weighed_with_another(played: Played) -> Shots | None:
    """Something else lay on the scale too."""
    if played.goal.relation != "weighed":
        return None
    thing, new = played.subject, played.ends[1]
    others = [o for o in played.loose if o.id != thing.id and max(o.asset.size[:2]) < 0.12]
    if not others:
        return None
    other = others[int(played.rng.integers(len(others)))]
    return played.instead({other.id: Pose(new.p + [0.02, 0.01, thing.asset.size[2] + 0.01], other.pose.q)})


def not_still(played: Played) -> Shots | None:
    """It slid while it was weighed."""
    shots = played.shots
    if played.goal.relation != "weighed" or shots.moment is None:
        return None
    pose = shots.moment.objects[played.goal.subject]
    slid = Pose(pose.p + [*played.step((0.03, 0.05)), 0.0], pose.q)
    moment = replace(shots.moment, objects={**shots.moment.objects, played.goal.subject: slid})
    return played.untrue("it did not lie still", moment=moment)


def turned_away(played: Played) -> Shots | None:
    """It was put down with its front elsewhere."""
    if played.goal.relation not in ("presented", "facing_robot"):
        return None
    new = played.ends[1]
    turn = np.radians(float(played.rng.choice([60.0, 90.0, 180.0, 270.0])))
    return played.instead({played.goal.subject: Pose(new.p, (Pose.from_yaw([0, 0, 0], turn) * Pose(q=new.q)).q)})


def other_side(played: Played) -> Shots | None:
    """It was put down on the wrong side of what it should stand beside, or not quite where it was."""
    thing, new = played.subject, played.ends[1]
    if played.goal.relation == "back":
        return played.instead({thing.id: Pose(new.p + [*played.step((0.05, 0.1)), 0.005], new.q)})
    if played.goal.relation == "moved_away":
        inwards = 2 * played.ends[0].p - new.p
        return played.instead({thing.id: Pose([inwards[0], new.p[1], new.p[2] + 0.005], new.q)})
    if played.goal.relation == "in_place_of":
        return played.instead({thing.id: Pose(new.p + [*played.step((0.06, 0.12)), 0.005], new.q)})
    if played.goal.relation == "centred":
        return played.instead({thing.id: Pose(new.p + [*played.step((0.14, 0.22)), 0.005], new.q)})
    if played.goal.relation not in RELATED:
        return None
    reference = played.now(played.shots.after)[str(played.goal.reference)].pose.p
    far = 1.0 if played.goal.relation not in ("beside", "near") else 3.0
    at = reference - far * (new.p - reference)
    return played.instead({thing.id: Pose([at[0], at[1], new.p[2] + 0.005], new.q)})


FAILURES: Mapping[str, Kind] = {
    "nothing happened": nothing,
    "lost on the way": lost,
    "off the table": off_table,
    "beside": beside,
    "on the rim": on_the_rim,
    "wrong object": wrong_object,
    "wrong place": wrong_place,
    "knocked over": knocked_over,
    "support pushed away": pushed_away,
    "slid off": slid_off,
    "a third": a_third,
    "sprang back": sprang_back,
    "pressed beside": pressed_beside,
    "from behind": from_behind,
    "too far": too_far,
    "wrong words": wrong_words,
    "order swapped": reversed_order,
    "another disturbed": disturbed,
    "one arm": one_arm,
    "not lifted": not_lifted,
    "only gripped": only_gripped,
    "hung still": hung_still,
    "leaned once": leaned_once,
    "hung plumb": hung_plumb,
    "not alone on the scale": weighed_with_another,
    "not still": not_still,
    "turned away": turned_away,
    "other side": other_side,
    "hit beside": hit_beside,
    "not down": not_down,
    "another hit": hit_another,
    "tool dropped": dropped_tool,
    "swept away": swept,
    "wiped above": wiped_above,
    "wiped at one spot": wiped_spot,
    "wiped beside": wiped_beside,
    "another wiped": wiped_another,
    "nothing poured": poured_nothing,
    "half poured": poured_half,
    "container missed": missed,
    "half beside": half_beside,
    "vessel dropped": vessel_dropped,
    "poured elsewhere": poured_elsewhere,
    "still lying": still_lying,
    "on its head": on_its_head,
    "fell over": fell_over,
    "still held": still_held,
    "stands beside the rack": stood_beside,
    "fell beside the rack": fell_beside,
    "leans on the rack": leans_on_it,
    "still in the hand": still_in_the_hand,
    "beside the block": lies_beside,
    "before the hole": lies_before_the_hole,
    "on the block": lies_on_top,
    "half in": half_in,
    "block pushed": block_pushed,
}
"""By name."""


def _joint_at(played: Played, between: tuple[float, float]) -> Shots | None:
    """With the part at a share of its range."""
    if played.goal.kind.acts_on not in ("open", "turn") or played.goal.part is None:
        return None
    share = played.rng.uniform(*between)
    thing = played.subject
    model = thing.asset.model
    joints = np.array(played.shots.after.object_joints[thing.id], float)
    joints[joint_index(model, played.goal.part)] = share * model.link(played.goal.part).joint.far_end
    return played.instead(joints={thing.id: joints.tolist()})


def _still(played: Played) -> str | None:
    """The thing that does not move while a code is read."""
    if played.goal.relation != "scanned":
        return None
    return played.goal.subject if played.subtask.grasped == played.subtask.tool else played.subtask.tool


def _is_read(played: Played, moment: WorldState) -> bool:
    now = played.now(moment)
    return any(reads(now[other], now[played.goal.subject]) for other in now if other != played.goal.subject)


def _may_have_happened(played: Played, other: Subtask) -> bool:
    """True for an event of the object that was handled, which the state at the end does not tell."""
    return other.object == played.subtask.object and any(goal.kind.event for goal in other.goals)
