"""Reasons why objects have no place, and the ways out that were proven by solving.

``details`` of the error: ``objects`` (without a place), ``missing_area_m2`` (always more than 0), ``needed_area_m2``,
``available_area_m2``, ``drop`` (ids without which all others were placed), ``enlarge_m`` (x and y by which the
workspace or opening must grow for all to be placed, null when growing does not help), ``container`` (whose opening is
too small, null for the table).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.errors import InfeasibleScene
from vcage.layout.placement.free_region import TOLERANCE
from vcage.layout.placement.plane import Plane, Stance
from vcage.layout.placement.search import Outcome, pack_in_corners


@dataclass(frozen=True)
class ProofSettings:
    """Settings of the search for a way out.

    Args:
        passes: orders that are packed to prove a way out.
        largest: how many times longer the workspace is tried, at most.
        halvings: bisection steps for the smallest sufficient growth.
        slack_share: the workspace is made longer than the smallest growth by this, so that the next search does not
            need luck.
        area_tolerance_m2: area that may be missing by rounding.
    """

    passes: int = 6
    largest: float = 4.0
    halvings: int = 5
    slack_share: float = 0.02
    area_tolerance_m2: float = 1e-6


SETTINGS = ProofSettings()


def require_room(plane: Plane) -> None:
    """Refuse an item that fits nowhere even alone, and a total area above the free area.

    Raises:
        InfeasibleScene: names the item, the missing area and a way out.
    """
    for k in plane.order:
        if all(plane.alone(stance).is_empty for stance in plane.stances[k]):
            raise _fits_nowhere(plane, k)
    missing = plane.needed - plane.available
    if missing > SETTINGS.area_tolerance_m2:
        needs = f"{len(plane.items)} objects with margins need {plane.needed:.3f} m²"
        raise _infeasible(plane, f"{needs}, {plane.where} has {plane.available:.3f} m²", plane.order, missing)


def no_place(plane: Plane, outcome: Outcome) -> InfeasibleScene:
    """The error for the items that a search left over."""
    names = ", ".join(plane.items[k].id for k in outcome.left)
    where = f"in {plane.where}" if plane.container else "on the table"
    message = f"no collision-free place {where} for {names} ({len(outcome.left)} of {len(plane.items)} objects)"
    missing = float(plane.areas[outcome.left].sum())
    return _infeasible(plane, message, outcome.left, missing, drop=outcome.left)


def _fits_nowhere(plane: Plane, k: int) -> InfeasibleScene:
    item, room = plane.items[k], plane.bounds[1] - plane.bounds[0]
    excess, stance = min(((_excess(s, room), s) for s in plane.stances[k]), key=lambda pair: pair[0].sum())
    size, too_long = 2 * stance.half, excess.max() > 2 * TOLERANCE
    message = (
        f"{item.id} ({_metres(size)}) fits nowhere in {plane.where} ({_metres(room)}), {_reason(plane, k, too_long)}"
    )
    if too_long:
        message += "; it is too large by " + " and ".join(
            f"{by:.3f} m along {axis}" for by, axis in zip(excess, "xy", strict=True) if by > 0
        )
    missing = float(size.prod() - np.minimum(size, room.clip(min=0)).prod()) if too_long else stance.area
    return _infeasible(plane, message, [k], max(missing, SETTINGS.area_tolerance_m2))


def _excess(stance: Stance, room: np.ndarray) -> np.ndarray:
    """(2,) by how much a rectangle is longer than the room, metres."""
    return (2 * stance.half - room).clip(min=0)


def _reason(plane: Plane, k: int, too_long: bool) -> str:
    item = plane.items[k]
    if too_long:
        return "even alone"
    limits = []
    if item.allowed is not None:
        limits.append("where an arm reaches it")
    if item.within is not None:
        limits.append("where all of it is seen")
    if not limits and plane.stances[k][0].unions:
        limits.append("where its contents are reached and seen")
    if len(plane.obstacles):
        limits.append("beside what stands there already")
    return " and ".join(limits) or "even alone"


def _infeasible(
    plane: Plane, message: str, left: Sequence[int], missing: float, drop: Sequence[int] = ()
) -> InfeasibleScene:
    dropped, enlarge = [plane.items[k].id for k in _drop(plane, drop)], _growth(plane)
    return InfeasibleScene(
        f"{message}: {max(missing, 1e-4):.4f} m² are missing",
        hint=_hint(dropped, enlarge, plane),
        details={
            "objects": [plane.items[k].id for k in left],
            "missing_area_m2": round(missing, 6),
            "needed_area_m2": round(plane.needed, 6),
            "available_area_m2": round(plane.available, 6),
            "drop": dropped,
            "enlarge_m": None if enlarge is None else [round(float(value), 3) for value in enlarge],
            "container": plane.container,
        },
    )


def _hint(dropped: Sequence[str], enlarge: np.ndarray | None, plane: Plane) -> str:
    rest, container = len(plane.items) - len(dropped), plane.container
    proof = {0: "", 1: " (the other one fits)"}.get(rest, f" (the other {rest} fit)")
    ways = [f"drop {', '.join(dropped)}{proof}"]
    if container:
        ways.append(f"place them beside {container}")
    if enlarge is not None:
        room = f"take a {container} whose opening is" if container else "make the workspace"
        ways.append(f"{room} {_metres(enlarge)} larger (then all fit)")
    return ", or ".join([*ways, "take smaller objects"])


def _metres(size: np.ndarray) -> str:
    return f"{size[0]:.3f} x {size[1]:.3f} m"


def _drop(plane: Plane, left: Sequence[int]) -> list[int]:
    """Indices, with ``left``, of items without which a few orders suffice, so that other seeds find places too."""
    dropped = list(left)
    while True:
        rest = [k for k in range(len(plane.items)) if k not in dropped]
        over = pack_in_corners(plane.only(rest), SETTINGS.passes, np.random.default_rng(0)).left
        if not over:
            return dropped
        dropped += [rest[i] for i in over]


def _growth(plane: Plane) -> np.ndarray | None:
    """(2,) metres, whole millimetres, by which longer bounds hold all items; None when growing does not help."""
    extent = (plane.bounds[1] - plane.bounds[0]).clip(min=1e-3)

    def by(share: float) -> np.ndarray:
        return np.ceil(extent * share * 1000) / 1000

    def suffices(share: float) -> bool:
        larger = plane.enlarged(by(share))
        # A few orders, and twice: other seeds must find places too.
        return not any(pack_in_corners(larger, SETTINGS.passes, np.random.default_rng(seed)).left for seed in (0, 1))

    lower, upper = 0.0, 0.125
    while not suffices(upper):
        lower, upper = upper, 2 * upper
        if upper > SETTINGS.largest:
            return None
    for _ in range(SETTINGS.halvings):
        middle = (lower + upper) / 2
        lower, upper = (lower, middle) if suffices(middle) else (middle, upper)
    return by(upper + SETTINGS.slack_share if suffices(upper + SETTINGS.slack_share) else upper)
