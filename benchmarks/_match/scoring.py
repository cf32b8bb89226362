"""Score a list of matches against the truth of its picture, and compute the figures of a level."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from benchmarks._match.truth import Truth
from vcage.schema.matches import Match
from vcage.schema.scene import Scene
from vcage.vision.symmetry import smallest_turn

NEAR = 0.04
"""Metres: a match farther than this from every true thing is on none."""

AROUND_TEN = range(8, 13)
"""Numbers of objects of the pictures that count as "about ten objects"."""


@dataclass(frozen=True)
class RightMatch:
    """A match that lies on its object: how far off, metres and radians, and how sure it was."""

    position_error: float
    yaw_error: float
    confidence: float


@dataclass(frozen=True)
class WrongMatch:
    """A match that does not lie on its object.

    Args:
        why: "missing" (the picture does not show the object), "stranger" or "other" (it lies nearest to
            that), "twice" (another match has taken the thing), or "astray" (nearest to its own object, but too far).
    """

    object: str
    why: str
    confidence: float


@dataclass(frozen=True)
class Score:
    """One picture's.

    Args:
        level: of the case.
        objects: number of objects of the scene.
        present: how many of them the target picture shows.
        right, wrong: the matches made; what was kept from the source is neither.
        seconds, cpu_seconds: wall and processor time of the matching.
    """

    level: str
    objects: int
    present: int
    right: list[RightMatch] = field(default_factory=list)
    wrong: list[WrongMatch] = field(default_factory=list)
    seconds: float = 0.0
    cpu_seconds: float = 0.0


@dataclass(frozen=True)
class _Thing:
    """Something that the target picture shows; a stranger has no look."""

    look: tuple[str, str] | None
    position: np.ndarray
    yaw: float
    symmetry: int


def score(
    scene: Scene, truth: Truth, matches: Sequence[Match], seconds: float = 0.0, cpu_seconds: float = 0.0
) -> Score:
    """Judge every match that was made (its method is not ``kept``).

    A match is right when the nearest thing of the target picture, strangers included, is its object or one of the
    same asset and variant, at most :data:`NEAR` away, and no other match lies closer to that thing.
    """
    looks = {o.id: (o.asset, o.variant) for o in scene.objects}
    shown = [o for o in truth.objects if o.present]
    things = [_Thing(looks[o.id], np.array(o.position), o.yaw or 0.0, o.symmetry) for o in shown]
    things += [_Thing(None, np.array(s.position), 0.0, 0) for s in truth.strangers]
    present = {o.id for o in shown}
    result = Score(truth.level, len(scene.objects), len(shown), seconds=seconds, cpu_seconds=cpu_seconds)
    taken: set[int] = set()
    for match, distances in _nearest_first(matches, things):
        index = int(np.argmin(distances)) if len(distances) else -1
        why = _complaint(match, looks, present, things, index, distances, taken)
        if why:
            result.wrong.append(WrongMatch(match.object, why, match.confidence))
            continue
        taken.add(index)
        thing = things[index]
        turned = abs(smallest_turn(match.yaw - thing.yaw, thing.symmetry))
        result.right.append(RightMatch(float(distances[index]), turned, match.confidence))
    return result


def _nearest_first(matches: Sequence[Match], things: Sequence[_Thing]) -> list[tuple[Match, np.ndarray]]:
    """Each match that was made with its distance to every thing, the closest first."""
    places = np.reshape([thing.position for thing in things], (-1, 2))
    made = [match for match in matches if match.method != "kept"]
    pairs = [(match, np.linalg.norm(places - match.position, axis=1)) for match in made]
    return sorted(pairs, key=lambda pair: pair[1].min(initial=np.inf))


def _complaint(
    match: Match,
    looks: dict[str, tuple[str, str]],
    present: set[str],
    things: Sequence[_Thing],
    index: int,
    distances: np.ndarray,
    taken: set[int],
) -> str:
    """Why a match is wrong (see :class:`WrongMatch`); empty when it is right."""
    if match.object not in present:
        return "missing"
    if things[index].look is None:
        return "stranger"
    if things[index].look != looks[match.object]:
        return "other"
    if distances[index] > NEAR:
        return "astray"
    return "twice" if index in taken else ""


# --- figures -------------------------------------------------------------------------------------------


def row(level: str, stack: str, scores: Sequence[Score]) -> dict[str, Any]:
    """One row of the table.

    ``identity``: right matches over all matches. ``recall``: right matches over present objects.
    ``false_matches``: share of matches of a missing object or on another object; matches
    on nothing are only in ``astray``, so identity + false_matches + astray = 1. Errors: over right matches, yaw up to
    the object's symmetry. ``seconds``: median over pictures; ``seconds_10``: over those of about ten objects;
    ``cpu_seconds``: of processor time, which other work on the machine does not lengthen.
    ``wrong_below_median``: whether every wrong match has a lower confidence than the median right one.
    A share of nothing is None.
    """
    right = [match for one in scores for match in one.right]
    wrong = [match for one in scores for match in one.wrong]
    made, astray = len(right) + len(wrong), sum(match.why == "astray" for match in wrong)
    middle = float(np.median([match.confidence for match in right])) if right else 0.0
    below = sum(match.confidence < middle for match in wrong)
    millimetres = [1000 * match.position_error for match in right]
    degrees = [float(np.degrees(match.yaw_error)) for match in right]
    return {
        "level": level,
        "stack": stack,
        "pictures": len(scores),
        "identity": _share(len(right), made),
        "recall": _share(len(right), sum(one.present for one in scores)),
        "false_matches": _share(len(wrong) - astray, made),
        "position_mm_p50": _percentile(millimetres, 50),
        "position_mm_p95": _percentile(millimetres, 95),
        "yaw_deg_p50": _percentile(degrees, 50),
        "yaw_deg_p95": _percentile(degrees, 95),
        "seconds": _percentile([one.seconds for one in scores], 50, 3),
        "seconds_10": _percentile([one.seconds for one in scores if one.objects in AROUND_TEN], 50, 3),
        "cpu_seconds": _percentile([one.cpu_seconds for one in scores], 50, 3),
        "objects": sum(one.objects for one in scores),
        "matches": made,
        "false_count": len(wrong) - astray,
        "astray": _share(astray, made),
        "wrong_below_median": below == len(wrong),
        "wrong_below_median_share": _share(below, len(wrong)),
    }


def _share(part: int, whole: int) -> float | None:
    return round(part / whole, 4) if whole else None


def _percentile(values: Sequence[float], percent: float, digits: int = 2) -> float | None:
    return round(float(np.percentile(values, percent)), digits) if len(values) else None
