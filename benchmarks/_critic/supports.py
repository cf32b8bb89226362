"""Ways to fail to bring a thing to its support: a receptacle, a top, a scale, or what it is stacked on."""

from __future__ import annotations

import numpy as np

from benchmarks._critic.played import DROP, Played, Shots
from vcage.base.geometry import Pose, world_aabb
from vcage.plans.actions import HOLDING
from vcage.schema.plan import TABLE

PUSHED = (0.06, 0.18)
"""Range of the distance by which a support is pushed away, metres."""

DIRECTIONS = 12
"""Ways to push it of which one is looked for that is free."""

CLEAR, STRAY = 0.005, 0.1
"""Room between things that are put beside each other, and how far a support may stray from all that stands, metres."""

LOWEST = 0.03
"""Height of a support that can tip over, and that a thing can slide off and lean against, metres."""

CUBE = 0.1
"""An object whose sides differ by less than this share stands on each of them alike."""


def beside(played: Played) -> Shots | None:
    """It was let go beside its place."""
    if not _has_support(played):
        return None
    thing, place = played.subject, played.place
    (x0, y0), (x1, _) = place.around_boxes[:, :2]
    half, gap = thing.asset.size[:2].max() / 2, played.rng.uniform(0.01, 0.04)
    middle = (place.around_boxes[0] + place.around_boxes[1]) / 2
    spots = [(x0 - half - gap, middle[1]), (x1 + half + gap, middle[1]), (middle[0], y0 - half - gap)]
    x, y = spots[int(played.rng.integers(len(spots)))]
    return played.instead({thing.id: Pose([x, y, played.table + DROP], thing.pose.q)})


def on_the_rim(played: Played) -> Shots | None:
    """It was let go across the rim of its place."""
    if not _has_support(played):
        return None
    thing, place = played.subject, played.place
    angle = played.rng.uniform(0, 2 * np.pi)
    reach = (place.around_boxes[1] - place.around_boxes[0])[:2] / 2
    at = (place.around_boxes[0] + place.around_boxes[1])[:2] / 2 + reach * [np.cos(angle), np.sin(angle)]
    return played.instead({thing.id: played.leaning(Pose([*at, place.around_boxes[1, 2] + DROP], thing.pose.q))})


def knocked_over(played: Played) -> Shots | None:
    """Its receptacle was knocked over, and what lies in it fell out."""
    if played.goal.relation not in HOLDING or played.subtask.receptacle in (None, TABLE):
        return None
    place = played.place
    size = place.asset.size
    if place.asset.articulated or size[2] < LOWEST or np.ptp(size) < CUBE * size.max():  # a cube has no wrong side
        return None
    axis = [np.sin(np.pi / 4), 0.0, 0.0] if played.rng.random() < 0.5 else [0.0, np.sin(np.pi / 4), 0.0]
    tipped = Pose(
        place.pose.p + [0, 0, max(place.asset.size[:2]) / 2], (place.pose * Pose(q=[np.cos(np.pi / 4), *axis])).q
    )
    return played.instead({place.id: tipped})


def pushed_away(played: Played) -> Shots | None:
    """Its support was pushed away, and it ended beside that."""
    if not _has_support(played):
        return None
    thing, place = played.subject, played.place
    for _ in range(DIRECTIONS):
        way = played.step(PUSHED)
        box = place.around_boxes[:, :2] + way
        if _is_free(played, box):
            break
    else:
        return None
    heading = -way / np.linalg.norm(way)
    size = world_aabb(thing.asset.bounds, thing.pose)
    half, middle = (size[1] - size[0])[:2] / 2, box.mean(axis=0)
    reach = (box[1] - box[0]) / 2 + half + CLEAR
    at = middle + heading * float(np.min(reach / np.maximum(np.abs(heading), 1e-6)))
    carried = {o.id for o in played.case.objects.values() if o.record.container == place.id and o.id != thing.id}
    poses = played.shots.after.objects
    moved = {name: Pose(poses[name].p + [*way, 0.0], poses[name].q) for name in (place.id, *carried)}
    return played.instead({**moved, thing.id: Pose([*at, played.table + CLEAR], thing.pose.q)})


def slid_off(played: Played) -> Shots | None:
    """It slid off its support, and leans against that or lies beside it."""
    if not _has_support(played) or played.place.around_boxes[1, 2] - played.table < LOWEST:
        return None
    thing, box = played.subject, played.place.around_boxes
    side = int(played.rng.integers(4))
    axis, outwards = side // 2, 1.0 if side % 2 else -1.0
    tilt = -outwards * played.rng.uniform(0.3, 1.1) / 2  # the top towards the support
    turn = [0.0, np.sin(tilt), 0.0] if axis == 0 else [-np.sin(tilt), 0.0, 0.0]
    turned = (Pose(q=[np.cos(tilt), *turn]) * Pose(q=thing.pose.q)).q
    outline = world_aabb(thing.asset.bounds, Pose([0, 0, 0], turned))
    at = np.array([*box.mean(axis=0)[:2], played.table + CLEAR - outline[0, 2]])
    at[axis] = box[1, axis] + CLEAR - outline[0, axis] if outwards > 0 else box[0, axis] - CLEAR - outline[1, axis]
    return played.instead({thing.id: Pose(at, turned)})


def _has_support(played: Played) -> bool:
    return played.goal.relation in (*HOLDING, "weighed") and played.subtask.receptacle not in (None, TABLE)


def _is_free(played: Played, box: np.ndarray) -> bool:
    """True when a support (2, 2) touches nothing else there and is still among the objects on the table."""
    now = played.now(played.shots.after)
    mine = {played.goal.subject, str(played.subtask.receptacle)}
    others = [o.around_boxes[:, :2] for o in now.values() if o.id not in mine]
    others = [o for o in others if not _overlap(o, played.place.around_boxes[:, :2])]  # what lies in it goes along
    everything = np.stack([o.around_boxes[:, :2] for o in now.values()])
    inside = np.all(box[0] >= everything[:, 0].min(0) - STRAY) and np.all(box[1] <= everything[:, 1].max(0) + STRAY)
    return bool(inside) and not any(_overlap(o, box) for o in others)


def _overlap(one: np.ndarray, other: np.ndarray) -> bool:
    return bool(np.all(one[0] < other[1]) and np.all(other[0] < one[1]))
