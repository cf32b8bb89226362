"""Evidence of an object that one arm tilted to and fro in the air, at its first and its last lean.

The hand has swung about it between the two, and it has moved with the hand: its lower edges tell, and where these do
not, the camera on the hand. How far and how often it leaned no picture shows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Pose
from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.drawings import drawn_whole
from vcage.models.rules.evidence.in_hand import held_object
from vcage.models.rules.evidence.in_the_air import in_the_air
from vcage.models.rules.evidence.judgement import Judged, refused, unseen
from vcage.models.rules.evidence.moments import at_later, at_moment
from vcage.models.rules.evidence.raised import Raised
from vcage.models.rules.pixels import changed, grown, share_of
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.vision.colour import distance, smoothed


@dataclass(frozen=True)
class ShakenSettings:
    """Limits that tell a shake.

    Args:
        seen_share: least share of the pixels that tell the object in the air that must look like it: it leans there,
            and is drawn upright.
        around_m: from the middle of the object, within which the hand is.
        beside_px: around the object that is not counted as hand.
        swung_m2: least area that changes there when a hand swings.
        lean_rad, directions: lean to either side, and number of directions, in which the object is drawn.
        hung_share, likely_share, leaned_share: share of its lower edges, as it leans to all sides, that changes from
            side to side: below the first it seems to have hung upright, from the second on it has likely leaned, from
            the third on surely.
        fewest_px: of these edges, else the object is too small or too round to tell.
        upright_if_hung, upright_if_turned, upright_if_open, upright_if_likely: unlikeness of what the hand sees to the
            object that stayed upright, in shares of that to the one that leaned with the hand, from which it leaned all
            the same: where it seems to have hung upright (a lean towards the customer hardly shows from there), where
            it looks as if it had turned in the hand and its edges do not show that it likely leaned; where the edges
            leave that open; and where they show that it likely leaned, or are too few to tell.
        alike_lab: colour distance up to which a pixel of the object looks the same to the hand at both leans.
        kept_share: share of these pixels below which it seems to have turned in the hand.
    """

    seen_share: float = 0.4
    around_m: float = 0.25
    beside_px: float = 4.0
    swung_m2: float = 0.01
    lean_rad: float = float(np.radians(22.0))
    directions: int = 4
    hung_share: float = 0.2
    likely_share: float = 0.5
    leaned_share: float = 0.6
    fewest_px: int = 450
    upright_if_hung: float = 1.2
    upright_if_turned: float = 1.05
    upright_if_open: float = 0.985
    upright_if_likely: float = 0.92
    alike_lab: float = 12.0
    kept_share: float = 0.7


SETTINGS = ShakenSettings()


@dataclass(frozen=True)
class TurnInHand:
    """Measurements of an object at two leans, by the camera on the hand that leans.

    Args:
        upright: how unlike the pictures are to the object that stayed upright, in shares of how unlike to one that
            leaned with the hand.
        kept: share of the object's pixels that look the same at both leans.
    """

    upright: float
    kept: float

    @classmethod
    def of(cls, view: CriticView, name: str) -> TurnInHand | None:
        """Measure an object; None without pictures of such a camera."""
        pictures = (view.question.uncalibrated.get(when, {}) for when in ("moment", "later"))
        there, back = (held_object(view, name, one) for one in pictures)
        if there is None or back is None:
            return None
        hand, shift = there.likeliest()
        middle = there.pose.p + [0.0, 0.0, view.look(name).size[2] / 2]

        def unlike(lean: Pose) -> float:
            both = [there.unlike_leaning(hand, shift, lean), back.unlike_leaning(hand, shift, lean.inverse())]
            held, upright = np.sum(both, axis=0)
            return float(upright) / max(float(held), 1e-6)

        shown = there.shown(hand, shift)
        was, now = there.picture.lab[shown], back.picture.lab[shown]
        brighter = np.median(now - was, axis=0) if shown.any() else 0.0
        same = distance(was + brighter, now) < SETTINGS.alike_lab
        return cls(min(map(unlike, _leans(middle))), float(same.mean()) if shown.any() else 1.0)


@dataclass(frozen=True)
class Shaken:
    """Measurements of a shake.

    Args:
        first, second: of the object in the air, at both sides.
        swung: area that changed beside it between the two, m².
        rocked: share of its lower edges that changed; None where it is too small or too round to tell.
        in_hand: what the pictures of the hand's camera tell; None without such pictures, and where the edges tell.
    """

    first: Raised
    second: Raised
    swung: float
    rocked: float | None
    in_hand: TurnInHand | None

    def verdict(self, thing: str) -> Verdict:
        """Judge by the hand that swung, and the object that leaned with it."""
        verdicts = [one.verdict(thing, SETTINGS.seen_share, leans=True) for one in (self.first, self.second)]
        for one in verdicts:
            if not one.accepted:
                return one
        if self.swung < SETTINGS.swung_m2:
            return refused(f"the hand that holds the {thing} has not swung: {1e4 * self.swung:.0f} cm² changed", 0.8)
        if not self._leaned:
            sure = 0.6 if self.rocked is None else 1 - self.rocked
            return refused(f"the {thing} hung upright while the hand leaned", sure)
        verdict = min(verdicts, key=lambda one: one.confidence)
        words = f"{verdict.reason}; beside it the arm swung, {1e4 * self.swung:.0f} cm² changed"
        return verdict.model_copy(update={"reason": words})

    @property
    def _leaned(self) -> bool:
        """False where its edges, or the pictures of the hand's camera, show that it hung upright."""
        hung = self.rocked is not None and self.rocked < SETTINGS.hung_share
        if self.in_hand is None:
            return not hung
        if hung:
            return self.in_hand.upright >= SETTINGS.upright_if_hung
        likely = self.rocked is not None and self.rocked >= SETTINGS.likely_share
        if self.in_hand.kept < SETTINGS.kept_share and not likely:
            return self.in_hand.upright >= SETTINGS.upright_if_turned
        tells = self.rocked is not None and not likely
        return self.in_hand.upright >= (SETTINGS.upright_if_open if tells else SETTINGS.upright_if_likely)


def judge_shaken(view: CriticView, goal: Goal) -> Judged:
    """Judge if an object was tilted to and fro in the air."""
    thing = view.phrase(goal.subject)
    moment, later = at_moment(view), at_later(view)
    if moment is not None and later is None:
        return unseen(view, f"the last lean of the {thing}; a run that is collected anew has it")
    first = in_the_air(view, goal, moment, alike_lab=np.inf)
    if isinstance(first, Judged):
        return first
    second = in_the_air(view, goal, later, alike_lab=np.inf)
    if isinstance(second, Judged):
        return second
    swung, rocked = _swung(view, goal.subject, first)
    edges_tell = rocked is not None and rocked >= SETTINGS.leaned_share
    found = Shaken(first, second, swung, rocked, None if edges_tell else TurnInHand.of(view, goal.subject))
    return Judged(found.verdict(thing), view.around(first.old, first.new))


def _swung(view: CriticView, name: str, found: Raised) -> tuple[float, float | None]:
    """The area beside an object that changed between the customer's two pictures, m², and the share of its lower edges;
    None where these are too small."""
    there, back = view.moment["customer"], view.later["customer"]
    camera, size, stood = there.camera, found.old.size, found.old.pose
    raised = Pose(stood.p + [0.0, 0.0, found.height], stood.q)
    middle = raised.p + [0.0, 0.0, size[2] / 2]
    scale = float(np.linalg.norm(camera.pose.p - middle)) / camera.focal
    rows, columns = np.mgrid[: camera.height, : camera.width]
    u, v = camera.project(middle[None])[0]
    near = np.hypot(columns - u, rows - v) < SETTINGS.around_m / scale
    poses = (raised, *(lean * raised for lean in _leans(middle)))
    outlines = [drawn_whole(view.sought(name).draw, pose, camera).covered for pose in poses]
    own = np.any(outlines, axis=0)
    change = changed(smoothed(there.picture), smoothed(back.picture))
    edges = own & ~np.all(outlines, axis=0) & (rows > v)  # the hand hides the upper ones
    rocked = share_of(change, edges) if edges.sum() >= SETTINGS.fewest_px else None
    return float((change & near & ~grown(own, SETTINGS.beside_px)).sum() * scale**2), rocked


def _leans(middle: np.ndarray) -> list[Pose]:
    """Leans about a point (3,) of the world to all sides."""
    half, angles = SETTINGS.lean_rad / 2, np.arange(2 * SETTINGS.directions) * np.pi / SETTINGS.directions
    turns = [Pose(q=[np.cos(half), np.sin(half) * np.cos(a), np.sin(half) * np.sin(a), 0.0]) for a in angles]
    return [Pose(middle) * turn * Pose(-middle) for turn in turns]
