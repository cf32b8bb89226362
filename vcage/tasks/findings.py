"""Findings of feasibility checks: the checks of the best arm, and the grasps of all arms that can do it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from vcage.schema.subtasks import Check, Grasp

Report = tuple[Sequence[Check], float | None]
"""The checks of one arm up to the first that failed, and the score of its motion; None where it cannot do it."""


@dataclass(frozen=True)
class Feasibility:
    """The checks of the best arm up to the first failure, and the capable arms, best first."""

    checks: list[Check]
    grasps: list[Grasp]

    @classmethod
    def of_arms(cls, contact: int, before: Sequence[Check], reports: Mapping[str, Report]) -> Feasibility:
        """Return the grasps of the arms that can do it, and the checks of the best; of the furthest if none can.

        Args:
            contact: id of the contact point; of a push its direction.
            before: checks that do not depend on the arm, all of them passed.
            reports: by arm, at least one.
        """
        scores = {arm: score for arm, (_, score) in reports.items() if score is not None}
        grasps = [Grasp(contact=contact, arm=arm, score=round(score, 4)) for arm, score in scores.items()]
        grasps.sort(key=lambda grasp: (-grasp.score, grasp.arm))
        shown = grasps[0].arm if grasps else max(reports, key=lambda arm: _progress(reports[arm][0]))
        return cls([*before, *reports[shown][0]], grasps)

    @property
    def feasible(self) -> bool:
        """True if some arm can do it."""
        return bool(self.grasps)

    @property
    def reason(self) -> str:
        """The reason if it is not feasible; empty if it is."""
        return "" if self.feasible else next(c.message for c in reversed(self.checks) if not c.passed)


def best_first(findings: Sequence[Feasibility]) -> tuple[list[Grasp], list[Check]]:
    """All grasps of feasible findings, the best first, and the checks of the best."""
    grasps = [grasp for finding in findings for grasp in finding.grasps]
    grasps.sort(key=lambda grasp: (-grasp.score, grasp.contact, grasp.arm))
    return grasps, next(f for f in findings if grasps[0] in f.grasps).checks


def _progress(checks: Sequence[Check]) -> tuple[int, bool]:
    """The number of checks that an arm passed, and True if it is long enough for its place to be examined."""
    return sum(check.passed for check in checks), any(check.name == "drop" for check in checks)


def travel(path: Sequence[np.ndarray]) -> float:
    """Length of a joint path, radians: the largest joint change of each leg, which rules how long it takes."""
    return float(sum(np.abs(b - a).max() for a, b in pairwise(path)))


def reach_check(
    name: Literal["reach_grasp", "reach_place", "reach_motion"], where: str, reached: bool, arm: str
) -> Check:
    verb = "reaches" if reached else "does not reach"
    return Check(name=name, passed=reached, message=f"the {arm} arm {verb} {where}")


def hand_check(how: Literal["around", "at"], where: str, blocked: str | None) -> Check:
    """The check of the room for a hand, with the phrase of the object in its way, if any."""
    message = (
        f"the hand has room {how} {where}" if blocked is None else f"{blocked} is in the way of the hand at {where}"
    )
    return Check(name="way_free", passed=blocked is None, message=message)
