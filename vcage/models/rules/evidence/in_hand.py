"""Evidence of an object in a hand: the camera on the hand sees it between the fingers.

From above, an arm hides what it holds, and from the customer's side a part of the arm may look like it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Pose
from vcage.models.protocols import HandView
from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.drawings import Draw, LightRange
from vcage.models.rules.evidence.hand_picture import HandPicture
from vcage.sim.drawer import Drawing
from vcage.vision.colour import distance, to_lab

HELD_LIGHT = LightRange((0.7, 1.45), (0.92, 1.09))


@dataclass(frozen=True)
class InHandSettings:
    """Places of an object in a hand that are drawn, and limits for what a picture of it says.

    Args:
        refined: number of the likeliest grasps of which more drawings are made: an object slips and turns a little.
        rounds: of these drawings.
        steps: the first of them across the fingers and along the approach, metres, and about the closing axis, radians.
        light: in which the picture may be taken. Anything brown passes for anything else that is brown where that is
            left free.
        table_shades: shades of the table's colour that what is behind the object may have.
        apart_lab: colour distance from all of these from which a pixel of the object tells that it is there.
        alike_lab: distance up to which what is seen looks like the object.
        fewest_px, telling_share: least number of telling pixels of the reduced picture, and share of all of the object,
            else colours do not tell.
        held_share, surely_share: share of the telling pixels that must look like the object, and from which it surely
            is in the hand. Of 143 held objects whose colours tell all had 50 % and more.
        least_gain, surely_gain: by how much less unlike the picture must be to the object than to a bare table, in
            shares of the latter (a printed side in the shade may be a little more unlike); and from which the object
            surely is in the hand, where colours do not tell.
    """

    refined: int = 2
    rounds: int = 4
    steps: tuple[float, float, float] = (0.008, 0.008, 0.16)
    light: LightRange = HELD_LIGHT
    table_shades: tuple[float, ...] = (0.7, 0.85, 1.0, 1.15)
    apart_lab: float = 12.0
    alike_lab: float = 18.0
    fewest_px: int = 60
    telling_share: float = 0.25
    held_share: float = 0.45
    surely_share: float = 0.7
    least_gain: float = -0.03
    surely_gain: float = 0.53


SETTINGS = InHandSettings()


@dataclass(frozen=True)
class InHand:
    """Measurements of an object in a hand by the camera on that hand.

    Args:
        share: of the telling pixels, those that look like the object; None where colours do not tell.
        gain: by how much less unlike the picture is to the object than to a bare table, in shares of the latter.
    """

    share: float | None
    gain: float

    @property
    def contradicts(self) -> bool:
        """True where the hand holds something else, or nothing."""
        return self.share is not None and self.share < SETTINGS.held_share

    @property
    def agrees(self) -> bool:
        """True where the picture shows the object rather than a bare table."""
        return not self.contradicts and self.gain >= SETTINGS.least_gain

    @property
    def is_sure(self) -> bool:
        """True where its colours, or its edges, show that the hand holds it."""
        return self.gain >= SETTINGS.surely_gain if self.share is None else self.share >= SETTINGS.surely_share


def in_hand(view: CriticView, name: str, pictures: Mapping[str, np.ndarray]) -> InHand | None:
    """Measure an object in the hand on which a camera is; None where no picture is of such a camera, and where that
    would not see it or balls lie in it.

    Args:
        view, name: of the question, and of the object.
        pictures: (H, W, 3) uint8 RGB by name of the camera, of one moment; one hand acts.
    """
    held = held_object(view, name, pictures)
    return None if held is None else held.found()


def held_object(view: CriticView, name: str, pictures: Mapping[str, np.ndarray]) -> HeldObject | None:
    """An object as the acting hand may hold it: see :func:`in_hand`."""
    question = view.question
    pose = question.planned.get(name)
    if question.grasps is None or question.background is None or pose is None or question.contents.get(name):
        return None
    table = np.median(question.background.reshape(-1, 3), axis=0)
    shades = np.clip(np.outer(SETTINGS.table_shades, table), 0, 255).astype(np.uint8)
    draw = view.draw(name, dict.fromkeys(question.opened.get(name, ()), 1.0))
    for camera, picture in pictures.items():
        hands = list(question.grasps(name, pose, camera))
        if not hands:
            continue
        seen = HandPicture(picture, hands[0].camera, SETTINGS.light)
        if seen.shows:
            return HeldObject(seen, hands, pose, draw, to_lab(shades[None])[0])
    return None


@dataclass(frozen=True)
class HeldObject:
    """An object that may be in the hand of a picture.

    Args:
        picture: of the camera on the hand.
        hands: the ways in which it may be held where it stands.
        pose, draw: of the object there.
        shades: (n, 3) CIELAB of the table behind it.
    """

    picture: HandPicture
    hands: Sequence[HandView]
    pose: Pose
    draw: Draw
    shades: np.ndarray

    def found(self) -> InHand | None:
        """Measure the likeliest way to hold it; None where the camera would not see it."""
        hand, shift = self.likeliest()
        drawing, fingers = self._drawn(hand, shift)
        shown = self.shown(hand, shift)
        if not shown.any():
            return None
        bare = self.picture.unlike_bare(drawing, fingers, shown)
        gain = 1 - self.picture.unlike(drawing, fingers, shown) / max(bare, 1e-6)
        own, seen = to_lab(self.picture.lit(drawing, fingers))[shown], self.picture.lab[shown]
        telling = self._from_table(own) > SETTINGS.apart_lab
        if telling.sum() < max(SETTINGS.fewest_px, SETTINGS.telling_share * shown.sum()):
            return InHand(None, gain)
        alike = distance(seen, own) < np.minimum(self._from_table(seen), SETTINGS.alike_lab)
        return InHand(float(alike[telling].mean()), gain)

    def likeliest(self) -> tuple[HandView, Pose]:
        """The likeliest way to hold the object, and its shift in the gripper frame."""
        rough = sorted((self.unlike(hand, Pose()), number) for number, hand in enumerate(self.hands))
        found = [(*self._refined(self.hands[number], cost), number) for cost, number in rough[: SETTINGS.refined]]
        _, shift, number = min(found)
        return self.hands[number], _shifted(shift)

    def shown(self, hand: HandView, shift: Pose) -> np.ndarray:
        """(h, w) bool, where the object is seen as a hand holds it, see :meth:`likeliest`."""
        drawing, fingers = self._drawn(hand, shift)
        return drawing.covered & ~fingers

    def _refined(self, hand: HandView, cost: float) -> tuple[float, tuple[float, ...]]:
        """The least unlikeness near a grasp, and the object's shift (3,) in the gripper frame."""
        best, steps = (cost, (0.0, 0.0, 0.0)), np.array(SETTINGS.steps)
        for _ in range(SETTINGS.rounds):
            around = [tuple(best[1] + sign * steps * axis) for axis in np.eye(3) for sign in (1, -1)]
            nearby = min((self.unlike(hand, _shifted(shift)), shift) for shift in around)
            best, steps = (nearby, steps) if nearby[0] < best[0] else (best, steps / 2)
        return best

    def unlike(self, hand: HandView, shift: Pose) -> float:
        """Unlikeness of a drawing of the object, shifted in the gripper frame, in shares of that of a bare table."""
        drawing, fingers = self._drawn(hand, shift)
        if not (drawing.covered & ~fingers).any():
            return np.inf
        return self.picture.unlike(drawing, fingers) / max(self.picture.unlike_bare(drawing, fingers), 1e-6)

    def unlike_leaning(self, hand: HandView, shift: Pose, lean: Pose) -> tuple[float, float]:
        """Unlikeness of a drawing of the object as the hand holds it, and of one that leans in it, where either is.

        Args:
            hand, shift: how it is held, see :meth:`likeliest`.
            lean: of the object in the world where it was grasped.
        """
        (held, fingers), (leaning, _) = (self._drawn(hand, shift, pose) for pose in (self.pose, lean * self.pose))
        where = (held.covered | leaning.covered) & ~fingers
        if not where.any():
            return 0.0, 0.0
        return self.picture.unlike(held, fingers, where), self.picture.unlike(leaning, fingers, where)

    def _drawn(self, hand: HandView, shift: Pose, pose: Pose | None = None) -> tuple[Drawing, np.ndarray]:
        """A drawing of the object, which was grasped where it is or at another pose, and the area of the fingers (h, w)
        bool."""
        at = hand.gripper * shift * hand.gripper.inverse() * (pose or self.pose)
        return self.picture.drawing(hand, at, self.draw), self.picture.fingers(hand)

    def _from_table(self, colours: np.ndarray) -> np.ndarray:
        """(n,) distance of colours (n, 3) CIELAB from the nearest shade of the table."""
        return np.min([distance(colours, np.broadcast_to(shade, colours.shape)) for shade in self.shades], axis=0)


def _shifted(shift: Sequence[float]) -> Pose:
    """A shift across the fingers and along the approach, and about the closing axis, in the gripper frame."""
    across, along, turn = shift
    return Pose([across, 0.0, along], [np.cos(turn / 2), 0.0, np.sin(turn / 2), 0.0])
