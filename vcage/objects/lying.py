"""Objects on their sides: another look of a tall kind, whose frame is that of the lying body, made on demand.

A lying look has files, points and an origin (the centre of its bottom) of its own, so that all that places, draws and
grasps an object takes it as it lies. :attr:`vcage.objects.asset.Asset.stands` tells how it stands.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull

from vcage.base.files import atomic_folder, cache_dir, cache_path
from vcage.base.geometry import Pose, frame_from_axes
from vcage.base.hold import one_at_a_time
from vcage.objects.asset import Asset
from vcage.objects.convex import centre_of_mass
from vcage.objects.model import read_model, write_turned
from vcage.objects.painting import lying_look
from vcage.schema.asset import Annotation, ContactPoint, PhysicalModel, Variant


@dataclass(frozen=True)
class LyingSettings:
    """Limits for objects that lie on their side to be stood up, and where a hand holds them.

    Args:
        slope_rad: its side is at most this far from upright: it lies on that, not on a shoulder.
        stable_m: least distance of its middle from the edges of the side that it lies on, seen from above: half the
            width of a flat strip along a round body is 4 to 7 mm.
        one_side_rad: normals that differ by less belong to one side.
        towards_head_rad: a hand that comes down on it leans towards its head by this, so that it is above the table
            when the object stands.
        along_m: where it is held: distances from its middle towards its head, metres.
        foot_m: it is held at least this far from its bottom.
        plane_m: points this near to a plane lie in it.
    """

    slope_rad: float = float(np.radians(15.0))
    stable_m: float = 0.0013
    one_side_rad: float = float(np.radians(1.0))
    towards_head_rad: float = float(np.radians(30.0))
    along_m: tuple[float, ...] = (0.0, 0.015, 0.03)
    foot_m: float = 0.03
    plane_m: float = 1e-4


SETTINGS = LyingSettings()

UNABLE = "is not tall, or would not lie still on its side"
"""A refusal of things that cannot be stood up."""

LIES = "a bottle, a can, a cup or a juice carton"
"""Things that lie on their side, for hints."""


def standing_in_lying(asset: Asset) -> Pose | None:
    """The frame of a standing object in that of the same object on its side; None where it does not lie stably.

    Its head points along y then, and its bottom towards -y.
    """
    points = np.concatenate([piece.vertices for piece in asset.pieces])
    if asset.articulated or asset.ball_radius or not asset.entry().tall:
        return None
    middle = centre_of_mass(asset.pieces)
    sides = [(_spare(points, middle, normal), normal) for normal in _sides(points)]
    spare, normal = max(sides, key=lambda found: round(found[0], 4), default=(0.0, np.zeros(3)))
    if spare < SETTINGS.stable_m:
        return None
    turn = frame_from_axes([0, 0, 0], -normal, [0, 0, 1]).inverse()
    corners = turn.apply(points)
    lower, upper = corners.min(axis=0), corners.max(axis=0)
    return Pose([*-(lower + upper)[:2] / 2, -lower[2]], turn.q)


def laid(standing: Asset, stands: Pose, variant: Variant) -> Asset:
    """The asset on its side.

    Args:
        standing: the same, standing.
        stands: of :func:`standing_in_lying`.
        variant: its lying look.
    """
    annotation = standing.annotation.model_copy(
        update={
            "variants": [lying_look(one) for one in standing.annotation.variants],
            "any_colour": None,
            "front": False,
            "contact_points": _contact_points(standing, stands),
            "functional_points": [],
            "faces": [],
        }
    )
    return Asset(annotation, variant, _model(annotation, variant, standing.model, stands), standing, stands)


def _sides(points: np.ndarray) -> Iterator[np.ndarray]:
    """(3,) outward normals of the steep sides of a hull of points (n, 3), each once, the first towards -y."""
    normals = ConvexHull(points).equations[:, :3]
    steep = normals[np.abs(normals[:, 2]) <= np.sin(SETTINGS.slope_rad)]
    found: list[np.ndarray] = []
    for normal in sorted(steep, key=lambda one: (round(float(one[1]), 2), round(float(one[0]), 2))):
        if not any(normal @ other > np.cos(SETTINGS.one_side_rad) for other in found):
            found.append(normal)
    yield from found


def _spare(points: np.ndarray, middle: np.ndarray, normal: np.ndarray) -> float:
    """How far inside a side of a hull its middle is, seen along the normal, metres; negative outside."""
    heights = points @ normal
    side = points[heights >= heights.max() - SETTINGS.plane_m]
    along = np.array([-normal[1], normal[0], 0.0]) / np.hypot(*normal[:2])
    axes = np.stack([along, np.cross(normal, along)])
    flat = side @ axes.T
    if len(flat) < 3 or np.linalg.matrix_rank(flat - flat[0], tol=SETTINGS.plane_m) < 2:
        return -np.inf
    edges = ConvexHull(flat).equations
    return float(-(edges[:, :2] @ (axes @ middle) + edges[:, 2]).max())


def _contact_points(standing: Asset, stands: Pose) -> list[ContactPoint]:
    """Points along the axis of a lying object at which a hand closes across it, the nearest to its middle first."""
    lean, height = SETTINGS.towards_head_rad, centre_of_mass(standing.pieces)[2]
    heights = sorted({max(float(height) + along, SETTINGS.foot_m) for along in SETTINGS.along_m})
    found = []
    for number, at in enumerate(heights):
        position = stands.apply([0.0, 0.0, at])
        found.append(
            ContactPoint(
                id=number,
                name=f"lying body, {100 * at:.1f} cm from its bottom",
                position=tuple(position.round(6).tolist()),
                approach=(0.0, -float(np.sin(lean)), -float(np.cos(lean))),
                closing=(1.0, 0.0, 0.0),
            )
        )
    return found


def _model(annotation: Annotation, variant: Variant, standing: PhysicalModel, stands: Pose) -> PhysicalModel:
    """The model of a lying look, from the cache or made into it."""
    recipe = f"{_recipe_hash()}/{standing.visual}/{stands.p.round(7).tolist()}/{stands.q.round(7).tolist()}"
    digest = hashlib.sha256(recipe.encode()).hexdigest()[:16]
    made = cache_path("assets", f"{annotation.name}-{variant.id}-{digest}")
    if not made.is_dir():
        cache_dir("assets")  # in which the lock lies
        with one_at_a_time(made):
            if not made.is_dir():
                with atomic_folder(made) as part:
                    write_turned(standing, stands, part)
    return read_model(made)


@cache
def _recipe_hash() -> str:
    """Hash of the sources that decide a lying model."""
    here = Path(__file__).parent
    return hashlib.sha256(b"\0".join((here / f"{name}.py").read_bytes() for name in ("lying", "model"))).hexdigest()
