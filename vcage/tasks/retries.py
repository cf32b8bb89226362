"""The order of the choices of an attempt, after those before it failed.

In a further attempt a choice that is to blame is made last, and one that is not is kept: what was lost on the way is
held otherwise and goes to the same slot, what came to lie on a rim goes to another slot by the same grasp. Where nobody
knows what went wrong, grasp and slot both change. What failed together is not done again before all else was tried.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeVar

import numpy as np

from vcage.schema.episodes import AttemptStage, Failure
from vcage.tasks.slots import Slot

Choice = Literal["grasp", "arm", "slot"]

BLAMED_FOR: Mapping[Failure, frozenset[Choice]] = {
    "lost": frozenset({"grasp"}),
    "astray": frozenset({"slot"}),
    "disturbed": frozenset({"arm", "slot"}),
}
"""Choices to blame for a failure that the critic reports."""

CHOICES_BLAMED_BY_STAGE: Mapping[AttemptStage, frozenset[Choice]] = {
    "plan": frozenset({"arm"}),
    "grasp": frozenset({"grasp"}),
    "place": frozenset({"slot"}),
}
"""Choices to blame for an attempt that no critic judged, by the stage at which it ended."""

UNKNOWN: frozenset[Choice] = frozenset({"grasp", "slot"})
"""Choices to change if the failure is unknown."""

SAME = 1e-3
"""Slots closer than this are the same, metres: objects stand slightly differently in a rebuilt world."""

Grasp = TypeVar("Grasp", bound="tuple[int | None, str]")
"""Contact point and arm; a push has no contact point."""

Place = TypeVar("Place", bound="Slot | None")
"""A slot, or None for what is put nowhere."""


def blamed(stage: AttemptStage, failure: Failure | None) -> frozenset[Choice]:
    """The choices to blame for a failed attempt.

    Args:
        stage: how far it came.
        failure: the critic's reason, if it was asked and gave one.
    """
    return CHOICES_BLAMED_BY_STAGE.get(stage, UNKNOWN) if failure is None else BLAMED_FOR[failure]


@dataclass(frozen=True)
class Failed:
    """A failed attempt: its choices, and those to blame."""

    contact: int | None
    arm: str | None
    slot: Slot | None
    blamed: frozenset[Choice]

    def took(self, slot: Slot | None) -> bool:
        """True where it had this slot, or one at the same place; None stands for no slot."""
        if slot is None or self.slot is None:
            return slot is self.slot
        mine, other = self.slot, slot
        apart = np.abs(np.concatenate([mine.pose.p - other.pose.p, mine.pose.q - other.pose.q])).max()
        return (mine.receptacle, mine.point) == (other.receptacle, other.point) and bool(apart < SAME)


@dataclass(frozen=True)
class Retry:
    """The order in which an attempt tries its choices.

    Args:
        failed: the attempts at the same sub-task before it.
    """

    failed: tuple[Failed, ...] = ()

    def choices(self, grasps: Sequence[Grasp], slots: Iterable[Place]) -> Iterator[tuple[Place, list[Grasp]]]:
        """Slots in the order to try them, each with its grasps, best first.

        A slot comes twice if some of the grasps failed with it before: those come at the very end.

        Args:
            grasps: (contact point, arm), in the order of a first attempt.
            slots: in the order of a first attempt; a single None for an object without a target.
        """
        ordered, again = sorted(grasps, key=self._blame), list[tuple[Place, list[Grasp]]]()
        for slot in sorted(slots, key=self._blame_of_slot):
            known = {(one.contact, one.arm) for one in self.failed if one.took(slot)}
            left = [grasp for grasp in ordered if grasp not in known]
            if left or not grasps:
                yield slot, left
            if len(left) < len(ordered):
                again.append((slot, [grasp for grasp in ordered if grasp in known]))
        yield from again

    def _blame(self, grasp: tuple[int | None, str]) -> tuple[int, int]:
        """Count how often the arm of a grasp was to blame, and the grasp itself."""
        contact, arm = grasp
        by_arm = [one for one in self.failed if one.arm == arm]
        arms = sum("arm" in one.blamed for one in by_arm)
        return arms, sum("grasp" in one.blamed and one.contact == contact for one in by_arm)

    def _blame_of_slot(self, slot: Slot | None) -> int:
        return sum("slot" in one.blamed and one.took(slot) for one in self.failed)
