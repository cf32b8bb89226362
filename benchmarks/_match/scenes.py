"""Scenes of real objects: which ones, where they stand, and where they are moved to, some of them touching."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import affinity
from shapely.geometry.base import BaseGeometry

from benchmarks._match.views import Look, alike, library
from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose
from vcage.layout.items import Placement, TableItem
from vcage.layout.placement.place import place
from vcage.objects.asset import Asset
from vcage.schema.scene import Table, Workspace

SIBLING = 0.3
"""Chance that the next object is one of the scene's in another colour."""

AREA_SHARE = 0.55
"""Largest share of the workspace that the objects' rectangles may take, so that there is room to turn and move them."""

YAWS = 6
"""Headings drawn for each object, of which the placement may take any."""

MARGIN = 0.012
"""Smallest gap between the boxes of objects that do not touch, metres."""

TRIES = 40
"""Draws of objects and places before a scene is given up."""

CONTACT_STEP, CONTACT_PRECISION = 0.004, 0.0004
"""Step and allowed gap with which two objects are brought together, metres."""


@dataclass(frozen=True)
class Thing:
    """An object that is to stand on the table."""

    id: str
    asset: Asset

    @property
    def centre(self) -> np.ndarray:
        """(2,) middle of the footprint in the object frame, metres."""
        return self.asset.bounds[:, :2].mean(axis=0)


# --- which objects -------------------------------------------------------------------------------------


def choose_looks(count: int, workspace: Workspace, rng: np.random.Generator) -> list[Look]:
    """``count`` different looks that fit the workspace together; kinds in several colours are welcome.

    Of looks that differ in a label on their side only, which the camera above does not see, one at most is taken.

    Raises:
        InfeasibleScene: no such set was found.
    """
    room = np.prod(np.subtract(workspace.upper, workspace.lower)) * AREA_SHARE
    looks = library().variants()
    for _ in range(TRIES):
        chosen: list[Look] = []
        while len(chosen) < count:
            siblings = [look for look in looks if look not in chosen and look[0] in {name for name, _ in chosen}]
            pool = siblings if siblings and rng.random() < SIBLING else [look for look in looks if look not in chosen]
            drawn = pool[int(rng.integers(len(pool)))]
            if not any(drawn[0] == other[0] and alike(drawn, other) for other in chosen):
                chosen.append(drawn)
        if sum(_area(library().asset(*look)) for look in chosen) <= room:
            return chosen
        looks = _without_largest(looks)
    raise InfeasibleScene(f"no {count} objects of the library fit the workspace", hint="enlarge the workspace")


def _area(asset: Asset) -> float:
    """Mean area of the axis-aligned rectangle of a turned object over all turns, m²."""
    (width, depth), margin = asset.footprint, MARGIN
    return float(width * depth + (width**2 + depth**2) / np.pi + margin * (width + depth))


def _without_largest(looks: Sequence[Look]) -> list[Look]:
    """The looks without the largest twentieth, so that crowded scenes are made of smaller objects."""
    ordered = sorted(looks, key=lambda look: _area(library().asset(*look)))
    return sorted(ordered[: max(60, int(len(ordered) * 0.95))])


# --- where they stand ----------------------------------------------------------------------------------


def scatter(
    things: Sequence[Thing],
    workspace: Workspace,
    table: Table,
    rng: np.random.Generator,
    groups: Sequence[Sequence[str]] = (),
) -> dict[str, Pose]:
    """Upright poses at any yaw without collision; the members of a group touch each other.

    Raises:
        InfeasibleScene: there is no room.
    """
    by_id = {thing.id: thing for thing in things}
    grouped = {name for group in groups for name in group}
    clusters = [_touching([by_id[name] for name in group], rng) for group in groups]
    clusters += [{thing.id: Pose([*-thing.centre, 0.0])} for thing in things if thing.id not in grouped]
    items, local = [], {}
    for cluster in clusters:
        name = next(iter(cluster))
        centre, size = _rectangle(cluster, by_id)
        local[name] = {member: Pose([*-centre, 0.0]) * pose for member, pose in cluster.items()}
        yaws = tuple(float(yaw) for yaw in rng.uniform(-np.pi, np.pi, YAWS))
        items.append(TableItem(name, (float(size[0]), float(size[1]), 1.0), yaws))
    spots = place(items, np.array([workspace.lower, workspace.upper]), rng, margin=MARGIN)
    poses = {
        member: _standing(spots[name], table) * pose
        for name, members in local.items()
        for member, pose in members.items()
    }
    return {thing.id: poses[thing.id] for thing in things}


def _standing(spot: Placement, table: Table) -> Pose:
    return Pose.from_yaw([spot.x, spot.y, table.height], spot.yaw)


def _rectangle(cluster: Mapping[str, Pose], things: Mapping[str, Thing]) -> tuple[np.ndarray, np.ndarray]:
    """Middle and size (2,) of the axis-aligned rectangle around objects at poses."""
    bounds = np.array([_outline(things[name].asset, pose).bounds for name, pose in cluster.items()])
    lower, upper = bounds[:, :2].min(axis=0), bounds[:, 2:].max(axis=0)
    return (lower + upper) / 2, upper - lower


def _touching(members: Sequence[Thing], rng: np.random.Generator) -> dict[str, Pose]:
    """Poses at which each object touches the ones before it, seen from above."""
    poses: dict[str, Pose] = {}
    union = shapely.Polygon()
    for thing in members:
        yaw, heading = rng.uniform(-np.pi, np.pi, 2)
        shape = _outline(thing.asset, Pose.from_yaw([0, 0, 0], yaw))
        shift = _contact(union, shape, np.array([np.cos(heading), np.sin(heading)])) if poses else np.zeros(2)
        poses[thing.id] = Pose.from_yaw([*shift, 0.0], yaw)
        union = union.union(affinity.translate(shape, *shift))
    return poses


def _contact(still: BaseGeometry, moved: BaseGeometry, direction: np.ndarray) -> np.ndarray:
    """(2,) shift along ``direction`` at which ``moved``, coming from afar, first touches ``still``."""

    def meets(distance: float) -> bool:
        return still.intersects(affinity.translate(moved, *(direction * distance)))

    far = _reach(still) + _reach(moved) + CONTACT_STEP
    while far > 0 and not meets(far - CONTACT_STEP):
        far -= CONTACT_STEP
    near = far - CONTACT_STEP
    while far - near > CONTACT_PRECISION:
        middle = (near + far) / 2
        near, far = (middle, far) if meets(middle) else (near, middle)
    return direction * far


def _reach(shape: BaseGeometry) -> float:
    return float(np.abs(shape.bounds).max() * np.sqrt(2))


def _outline(asset: Asset, pose: Pose) -> BaseGeometry:
    """Footprint of an object, seen from straight above."""
    parts = [shapely.MultiPoint(pose.apply(piece.vertices)[:, :2]).convex_hull for piece in asset.pieces]
    return shapely.union_all(parts)
