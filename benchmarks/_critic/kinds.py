"""Kinds of outcomes that are made by hand of the simulator: what goes wrong, and successes that are ugly."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks._critic.played import Played, Shots
from vcage.base.geometry import Pose
from vcage.plans.actions import HOLDING
from vcage.schema.episodes import Truth
from vcage.schema.plan import TABLE
from vcage.sim.joints import joint_index
from vcage.sim.state import WorldState
from vcage.tasks.reading import reads
from vcage.tasks.scene_objects import SceneObject

Kind = Callable[[Played], Shots | None]
"""Makes an outcome from one that was played; None where that makes no sense, or does not come out as it should."""

RELATED = ("left_of", "right_of", "in_front_of", "behind", "beside", "near")
MOVED = (*HOLDING, *RELATED, "presented", "back", "handed", "weighed")
"""Goals of what is carried or pushed."""

DROP = 0.03
"""Height above where it could lie from which a thing is dropped by hand, metres."""

FLOOR = -3.0
"""Far below the table: what has fallen off it is out of every picture."""

DISTURBED = (0.08, 0.16)
"""How far a thing is moved that has nothing to do with the sub-task, metres."""


def nothing(played: Played) -> Shots:
    """Nothing happened: the robot moved and touched nothing."""
    was = played.shots.before
    moment = played.shots.moment
    if moment is not None and played.goal.relation != "pressed":  # whose hand would reach into what it does not press
        was_there = replace(moment, objects=was.objects, object_joints=was.object_joints)
        return _untrue(played, "nothing was moved", after=was, moment=was_there)
    return _untrue(played, "nothing was moved", after=was, moment=None if moment is None else was)


def lost(played: Played) -> Shots | None:
    """What was carried fell on the way."""
    if played.goal.relation not in MOVED:
        return None
    thing, old, new = _subject(played), *_ends(played)
    share = played.rng.uniform(0.25, 0.75)
    at = old.p + share * (new.p - old.p)
    lying = _tumbled(played, Pose([at[0], at[1], _surface(played, at, thing) + DROP], thing.pose.q))
    return played.instead({thing.id: lying})


def off_table(played: Played) -> Shots | None:
    """What was moved fell off the table."""
    if played.goal.relation not in MOVED:
        return None
    state = played.shots.after
    gone = replace(state, objects={**state.objects, played.goal.subject: Pose([0.0, 0.0, FLOOR])})
    return _untrue(played, "it fell off the table", after=gone, moment=_with_objects(played, gone.objects))


def beside(played: Played) -> Shots | None:
    """It was let go beside its place."""
    if played.goal.relation not in (*HOLDING, "weighed") or played.subtask.receptacle in (None, TABLE):
        return None
    thing, place = _subject(played), _place(played)
    (x0, y0), (x1, _) = place.around_boxes[:, :2]
    half, gap = thing.asset.size[:2].max() / 2, played.rng.uniform(0.01, 0.04)
    middle = (place.around_boxes[0] + place.around_boxes[1]) / 2
    spots = [(x0 - half - gap, middle[1]), (x1 + half + gap, middle[1]), (middle[0], y0 - half - gap)]
    x, y = spots[int(played.rng.integers(len(spots)))]
    return played.instead({thing.id: Pose([x, y, _table(played) + DROP], thing.pose.q)})


def on_the_rim(played: Played) -> Shots | None:
    """It was let go across the rim of its place."""
    if played.goal.relation not in (*HOLDING, "weighed") or played.subtask.receptacle in (None, TABLE):
        return None
    thing, place = _subject(played), _place(played)
    angle = played.rng.uniform(0, 2 * np.pi)
    reach = (place.around_boxes[1] - place.around_boxes[0])[:2] / 2
    at = (place.around_boxes[0] + place.around_boxes[1])[:2] / 2 + reach * [np.cos(angle), np.sin(angle)]
    return played.instead({thing.id: _leaning(played, Pose([*at, place.around_boxes[1, 2] + DROP], thing.pose.q))})


def wrong_object(played: Played) -> Shots | None:
    """Another thing was brought there, one that looks alike if there is one."""
    if played.goal.relation not in MOVED:
        return None
    thing, (old, new) = _subject(played), _ends(played)
    rivals = [o for o in _loose(played) if o.id != thing.id]
    alike = [o for o in rivals if o.record.asset == thing.record.asset] or rivals
    if not alike:
        return None
    other = alike[int(played.rng.integers(len(alike)))]
    return played.instead({thing.id: old, other.id: Pose([new.p[0], new.p[1], new.p[2] + 0.01], other.pose.q)})


def wrong_place(played: Played) -> Shots | None:
    """It was brought to another thing that could hold it, or elsewhere on the table."""
    if played.goal.relation not in MOVED:
        return None
    thing, avoid = _subject(played), {played.goal.subject, played.goal.reference, played.subtask.receptacle}
    tops = [o for o in played.now(played.shots.before).values() if o.id not in avoid]
    tops = [o for o in tops if any(p.link is None for p in o.asset.annotation.functional_points)]
    if not tops or played.rng.random() < 0.3:
        at = played.shots.before.objects[thing.id].p + [*_step(played, (0.08, 0.2)), DROP]
        return played.instead({thing.id: Pose(at, thing.pose.q)})
    other = tops[int(played.rng.integers(len(tops)))]
    point = next(p for p in other.asset.annotation.functional_points if p.link is None)
    opening = other.asset.opening(point)
    at = other.frame(point.id).apply([*opening.centre, opening.floor + DROP])
    return played.instead({thing.id: Pose(at, thing.pose.q)})


def knocked_over(played: Played) -> Shots | None:
    """Its receptacle was knocked over, and what lies in it fell out."""
    if played.goal.relation not in HOLDING or played.subtask.receptacle in (None, TABLE):
        return None
    place = _place(played)
    if place.asset.articulated or place.asset.size[2] < 0.03:
        return None
    axis = [np.sin(np.pi / 4), 0.0, 0.0] if played.rng.random() < 0.5 else [0.0, np.sin(np.pi / 4), 0.0]
    tipped = Pose(
        place.pose.p + [0, 0, max(place.asset.size[:2]) / 2], (place.pose * Pose(q=[np.cos(np.pi / 4), *axis])).q
    )
    return played.instead({place.id: tipped})


def a_third(played: Played) -> Shots | None:
    """A drawer, lid or knob went a third of its way."""
    return _joint_at(played, (0.25, 0.4))


def sprang_back(played: Played) -> Shots | None:
    """It closed again by itself, or opened again."""
    return _joint_at(played, (0.7, 0.95) if played.goal.relation == "closed" else (0.0, 0.1))


def pressed_beside(played: Played) -> Shots | None:
    """The finger came down beside the button."""
    if played.goal.relation != "pressed" or played.shots.moment is None:
        return None
    thing, away = _subject(played), np.array([*_step(played, (0.035, 0.07)), 0.0])
    pressing = played.shots.moment
    poses = {thing.id: Pose(thing.pose.p + away, thing.pose.q)}

    def shifted(state: WorldState) -> WorldState:
        joints = {**state.object_joints, thing.id: np.zeros_like(state.object_joints[thing.id])}
        return replace(state, objects={**state.objects, **poses}, object_joints=joints)

    shots = played.shots
    return _untrue(
        played,
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

    states = {when: turned(getattr(shots, when)) for when in ("before", "moment", "after", "start")}
    return None if _is_read(played, states["moment"]) else _untrue(played, "the code faces elsewhere", **states)


def too_far(played: Played) -> Shots | None:
    """The one was held too far from the other to be read."""
    shots = played.shots
    if _still(played) is None or shots.moment is None:
        return None
    held = str(played.subtask.grasped)
    pose = shots.moment.objects[held]
    away = Pose(pose.p + [*_step(played, (0.1, 0.18)), 0.0], pose.q)
    moment = replace(shots.moment, objects={**shots.moment.objects, held: away})
    return None if _is_read(played, moment) else _untrue(played, "it was held too far away", moment=moment)


def wrong_words(played: Played) -> Shots | None:
    """Something was done, but not what the words say."""
    others = [s for s in played.case.others if s.goals[0] != played.goal]
    near = [s for s in others if s.object == played.subtask.object or s.receptacle == played.subtask.receptacle]
    if not others:
        return None
    pool = near or others
    return played.about(pool[int(played.rng.integers(len(pool)))])


def reversed_order(played: Played) -> Shots | None:
    """The end came first: what should have been brought was taken away."""
    shots = played.shots
    if played.goal.relation in ("scanned", "pressed", "weighed", "handed", "back"):
        return None
    if played.instead(ended=False).truth.success:
        return None  # it was true before too
    return _untrue(
        played,
        "it was undone",
        before=shots.after,
        after=shots.before,
        moment=_with_objects(played, shots.before.objects),
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
    loose = [o for o in _loose(played) if o.id not in mine]
    if not loose or not played.shots.truth.success:
        return None
    other = loose[int(played.rng.integers(len(loose)))]
    at = other.pose.p + [*_step(played, DISTURBED), 0.01]
    shots = played.instead({other.id: Pose(at, other.pose.q)})
    moment = played.shots.moment
    return replace(shots, moment=moment, truth=Truth(success=False, reason=f"{other.id} was moved on the way"))


def one_arm(played: Played) -> Shots | None:
    """One arm put it there by itself; no other took it over."""
    shots = played.shots
    if played.goal.relation != "handed" or shots.moment is None:
        return None
    home = {arm: joints for arm, joints in shots.before.joints.items() if arm != shots.arm}
    moment = replace(shots.moment, joints={**shots.moment.joints, **home})
    return _untrue(played, "no other arm took it", moment=moment)


def weighed_with_another(played: Played) -> Shots | None:
    """Something else lay on the scale too."""
    if played.goal.relation != "weighed":
        return None
    thing, new = _subject(played), _ends(played)[1]
    others = [o for o in _loose(played) if o.id != thing.id and max(o.asset.size[:2]) < 0.12]
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
    slid = Pose(pose.p + [*_step(played, (0.03, 0.05)), 0.0], pose.q)
    moment = replace(shots.moment, objects={**shots.moment.objects, played.goal.subject: slid})
    return _untrue(played, "it did not lie still", moment=moment)


def turned_away(played: Played) -> Shots | None:
    """It was put down with its front elsewhere."""
    if played.goal.relation != "presented":
        return None
    new = _ends(played)[1]
    turn = np.radians(float(played.rng.choice([60.0, 90.0, 180.0, 270.0])))
    return played.instead({played.goal.subject: Pose(new.p, (Pose.from_yaw([0, 0, 0], turn) * Pose(q=new.q)).q)})


def other_side(played: Played) -> Shots | None:
    """It was put down on the wrong side of what it should stand beside, or not quite where it was."""
    thing, new = _subject(played), _ends(played)[1]
    if played.goal.relation == "back":
        return played.instead({thing.id: Pose(new.p + [*_step(played, (0.05, 0.1)), 0.005], new.q)})
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
    "a third": a_third,
    "sprang back": sprang_back,
    "pressed beside": pressed_beside,
    "from behind": from_behind,
    "too far": too_far,
    "wrong words": wrong_words,
    "order swapped": reversed_order,
    "another disturbed": disturbed,
    "one arm": one_arm,
    "not alone on the scale": weighed_with_another,
    "not still": not_still,
    "turned away": turned_away,
    "other side": other_side,
}
"""By name."""


def near_the_rim(played: Played) -> Shots | None:
    """It lies at the edge of its place, turned as it may."""
    return _within(played, lean=False)


def leaning(played: Played) -> Shots | None:
    """It leans in its place."""
    return _within(played, lean=True)


UGLY: Mapping[str, Kind] = {"near the rim": near_the_rim, "leaning": leaning}
"""Successes that are hard to see, by name."""


def _within(played: Played, *, lean: bool) -> Shots | None:
    if played.goal.relation not in HOLDING or played.subtask.receptacle in (None, TABLE):
        return None
    thing, place = _subject(played), _place(played)
    point = place.asset.annotation.functional_point(int(played.subtask.functional_point or 0))
    opening = place.asset.opening(point)
    spare = np.maximum(np.array(opening.size) - np.sort(thing.asset.size[:2])[0], 0) / 2
    x, y = np.array(opening.centre) + spare * played.rng.choice([-1.0, 1.0], 2) * played.rng.uniform(0.5, 1.0, 2)
    at = place.frame(point.id).apply([x, y, opening.floor + (opening.depth / 2 if lean else 0.0) + DROP])
    pose = Pose.from_yaw(at, played.rng.uniform(0, 2 * np.pi))
    return played.instead({thing.id: _leaning(played, pose) if lean else pose})


# --- where things are and go -------------------------------------------------------------------------------


def _untrue(played: Played, reason: str, **states: Any) -> Shots:
    return replace(played.shots, **states, truth=Truth(success=False, reason=reason))


def _with_objects(played: Played, objects: Mapping[str, Pose]) -> WorldState | None:
    moment = played.shots.moment
    return None if moment is None else replace(moment, objects=dict(objects))


def _subject(played: Played) -> SceneObject:
    return played.now(played.shots.before)[played.goal.subject]


def _place(played: Played) -> SceneObject:
    return played.now(played.shots.after)[str(played.subtask.receptacle)]


def _ends(played: Played) -> tuple[Pose, Pose]:
    shots, name = played.shots, played.goal.subject
    return shots.before.objects[name], shots.after.objects[name]


def _table(played: Played) -> float:
    return min(o.aabb[0, 2] for o in played.case.objects.values())


def _surface(played: Played, at: np.ndarray, thing: SceneObject) -> float:
    """How high the tops are above which a thing is dropped."""
    under = [
        o.around_boxes[1, 2]
        for o in played.now(played.shots.before).values()
        if o.id != thing.id and np.all((o.around_boxes[0, :2] <= at[:2]) & (at[:2] <= o.around_boxes[1, :2]))
    ]
    return max([_table(played), *under])


def _loose(played: Played) -> list[SceneObject]:
    """What could be carried, and lies in nothing and under nothing."""
    now = played.now(played.shots.before)
    holding = {o.record.container for o in now.values()}
    return [
        o
        for o in now.values()
        if o.record.container is None and o.id not in holding and o.asset.annotation.carrying_points
    ]


def _step(played: Played, far: tuple[float, float]) -> np.ndarray:
    angle, length = played.rng.uniform(0, 2 * np.pi), played.rng.uniform(*far)
    return length * np.array([np.cos(angle), np.sin(angle)])


def _tumbled(played: Played, pose: Pose) -> Pose:
    """A pose turned by chance, as of what falls."""
    return _leaning(played, Pose(pose.p, Pose.from_yaw([0, 0, 0], played.rng.uniform(0, 2 * np.pi)).q), most=0.6)


def _leaning(played: Played, pose: Pose, most: float = 1.0) -> Pose:
    tilt, angle = played.rng.uniform(0.2, most), played.rng.uniform(0, 2 * np.pi)
    axis = np.sin(tilt / 2) * np.array([np.cos(angle), np.sin(angle), 0.0])
    return Pose(pose.p, (Pose(q=pose.q) * Pose(q=[np.cos(tilt / 2), *axis])).q)


def _joint_at(played: Played, between: tuple[float, float]) -> Shots | None:
    """With the part at a share of its range."""
    if played.goal.relation not in ("open", "closed", "turned") or played.goal.part is None:
        return None
    share = played.rng.uniform(*between)
    thing = _subject(played)
    model = thing.asset.model
    joints = np.array(played.shots.after.object_joints[thing.id], float)
    joints[joint_index(model, played.goal.part)] = share * model.link(played.goal.part).joint.far_end
    return played.instead(joints={thing.id: joints.tolist()})


def _still(played: Played) -> str | None:
    """What stays while it is read."""
    if played.goal.relation != "scanned":
        return None
    return played.goal.subject if played.subtask.grasped == played.subtask.tool else played.subtask.tool


def _is_read(played: Played, moment: WorldState) -> bool:
    now = played.now(moment)
    return any(reads(now[other], now[played.goal.subject]) for other in now if other != played.goal.subject)
