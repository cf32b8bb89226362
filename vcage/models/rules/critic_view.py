"""The one view of a question shared by all judgements of the offline critic."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np

from vcage.base.errors import InputFileError
from vcage.base.geometry import Camera, Pose
from vcage.models.protocols import CriticQuestion
from vcage.models.rules.drawings import Draw
from vcage.models.rules.pixels import Change, grown, salience
from vcage.models.rules.standing import Sought, Standing
from vcage.vision.protocols import Reference


@dataclass(frozen=True)
class ViewSettings:
    """Limits shared by the judgements.

    Args:
        around_px: margin around an outline that belongs to it.
        alike_share: most by which the sides of objects differ, in shares of the longer, for one to be taken for the
            other.
    """

    around_px: float = 8.0
    alike_share: float = 0.2


VIEW = ViewSettings()

Found = TypeVar("Found")


class CriticView:
    """Pictures, cameras and references of a question, with the findings shared by several judgements.

    Args:
        question: to the critic.

    Attributes:
        question: as given.
        before, after, moment, later, start: views by camera, see :class:`vcage.models.protocols.CriticQuestion`.
    """

    def __init__(self, question: CriticQuestion):
        self.question = question
        self.before, self.after = question.before, question.after
        self.moment, self.later, self.start = question.moment, question.later, question.start
        if "top" not in self.before or "top" not in self.after:
            raise InputFileError("the critic needs a 'top' view before and after", hint="render the top camera")
        self._found: dict[Hashable, object] = {}

    @property
    def camera(self) -> Camera:
        """The camera of the views from above."""
        return self.before["top"].camera

    @cached_property
    def change(self) -> Change:
        """Changes from before to after, seen from above."""
        return Change.between(self.before["top"], self.after["top"])

    @cached_property
    def stood_before(self) -> np.ndarray:
        """(H, W) bool, where something stood before."""
        return salience(self.before["top"].picture, self.question.background) > 0.5

    @cached_property
    def stands_after(self) -> np.ndarray:
        """(H, W) bool, where something stands afterwards."""
        return salience(self.after["top"].picture, self.question.background) > 0.5

    @property
    def metres_per_pixel(self) -> float:
        """Of the table, seen from above."""
        return (self.camera.pose.p[2] - self.question.table_height) / self.camera.focal

    @property
    def nowhere(self) -> np.ndarray:
        """(H, W) bool, no pixel of the view from above."""
        return np.zeros(self.before["top"].picture.shape[:2], bool)

    def around(self, *standing: Standing | None) -> np.ndarray:
        """(H, W) bool, where some things stand, and a little around them."""
        masks = [one.covered for one in standing if one is not None]
        return grown(np.any(masks, axis=0), VIEW.around_px) if masks else self.nowhere

    def look(self, name: str) -> Reference:
        """The reference picture of an object.

        Raises:
            InputFileError: there is no picture of it.
        """
        if name not in self.question.references:
            raise InputFileError(f"no reference picture of {name!r}", hint="render one for each object of the scene")
        return self.question.references[name]

    def phrase(self, name: str) -> str:
        """The words for an object."""
        return self.look(name).phrase

    def draw(self, name: str, shares: Mapping[str, float]) -> Draw:
        """Draws an object with its parts at shares of their ranges.

        Raises:
            InputFileError: nothing draws the scene's objects.
        """
        draw = self.question.draw
        if draw is None:
            raise InputFileError(f"nothing draws {name!r}", hint="give the run's scene, as collect and verify do")
        return lambda pose, camera, window: draw(name, pose, camera, window, shares)

    def sought(self, name: str, *, upon: bool = False) -> Sought:
        """An object with its parts as they are by the plan; with ``upon`` it may stand on another."""
        tops = self.question.tops if upon else ()
        return replace(self._planned(name), tops=tops, rivals=[self._planned(other) for other in self._alike(name)])

    def stood_up(self, name: str, turn: Pose | None = None) -> Sought:
        """An object that lies at the start as it stands later, wherever; any other as :meth:`sought`.

        Args:
            turn: of the standing object in its own frame, to look for it in another attitude.
        """
        stands, thing = self.question.stood_up.get(name), self.sought(name)
        if stands is None:
            return thing
        way, draw = (turn or Pose()) * stands.lying, thing.draw
        return replace(
            thing, look=stands.look, draw=lambda pose, camera, window: draw(pose * way, camera, window), planned=None
        )

    def _planned(self, name: str) -> Sought:
        asked = self.question
        draw = self.draw(name, dict.fromkeys(asked.opened.get(name, ()), 1.0))
        return Sought(self.look(name), draw, asked.background, asked.table_height, planned=asked.planned.get(name))

    def _alike(self, name: str) -> list[str]:
        """The other planned objects that are about as large: one of another colour may be taken for it."""
        others = [other for other in self.question.planned if other != name]
        return [other for other in others if _as_large(self.look(name).size, self.look(other).size)]

    def once(self, key: Hashable, find: Callable[[], Found]) -> Found:
        """Return the result of ``find``, called once for a key: several goals may be about one object."""
        if key not in self._found:
            self._found[key] = find()
        return self._found[key]  # pyrefly: ignore[bad-return]


def _as_large(one: Sequence[float], other: Sequence[float]) -> bool:
    """True where the sorted sides of two boxes differ by no more than a share of the longer."""
    sides = np.sort([one, other])
    return bool((np.ptp(sides, axis=0) <= VIEW.alike_share * sides.max(axis=0)).all())
