"""Evidence of an object that one arm, or both, hold in the air at the end."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np

from vcage.models.rules.critic_view import VIEW, CriticView
from vcage.models.rules.evidence.fingers import fingers_touch
from vcage.models.rules.evidence.handed import REACH, arms_out
from vcage.models.rules.evidence.in_hand import in_hand
from vcage.models.rules.evidence.in_the_air import in_the_air
from vcage.models.rules.evidence.judgement import Judged, refused
from vcage.models.rules.evidence.moments import at_end
from vcage.models.rules.pixels import grown
from vcage.schema.goals import Goal


@dataclass(frozen=True)
class HeldUpSettings:
    """Limits that tell an object in the air from an arm.

    Args:
        with_both_m: height over its old place up to which what both arms lift is looked for: higher up their joints may
            look like it.
        with_both_share: share of the pixels that tell it that must look like it then: hands over its old place may look
            like it, by 62 % on a silver pot; such a pot and rolling pins in the air have 68 to 95 %.
        joined_px: parts of an arm that are seen this far apart are joined.
    """

    with_both_m: float = 0.14
    with_both_share: float = 0.65
    joined_px: float = 20.0


SETTINGS = HeldUpSettings()


def judge_held_up(view: CriticView, goal: Goal) -> Judged:
    """Judge if an object is in the air in the end; the arm that still holds it explains what it hides. On a table of
    its colour it changes that as a shadow does."""
    found = in_the_air(view, goal, at_end(view))
    if isinstance(found, Judged):
        return found
    return Judged(found.verdict(view.phrase(goal.subject)), view.around(found.old) | _arm_seen(view))


def judge_held_by_both(view: CriticView, goal: Goal) -> Judged:
    """Judge if an object is level in the air in the end, between the fingers of both arms."""
    end, thing = at_end(view), view.phrase(goal.subject)
    both = None if end is None else replace(end, hand={})  # of each hand below
    found = in_the_air(view, goal, both, SETTINGS.with_both_m, np.inf)
    if isinstance(found, Judged):
        return found
    verdict = found.verdict(thing, SETTINGS.with_both_share)
    judged = Judged(verdict, view.around(found.old) | _arm_seen(view))
    if not verdict.accepted:
        return judged
    arms = arms_out(view.before["customer"], view.after["customer"])
    changed = " and ".join(f"{100 * share:.0f} %" for share in arms)
    if min(arms) < REACH.reaches_share:
        return judged._replace(verdict=refused(f"not both arms reach out: {changed} of their sides changed", 0.8))
    empty = _empty_hand(view, goal.subject)
    if empty is not None:
        return judged._replace(verdict=refused(f"{empty} does not see the {thing} between the fingers", 0.8))
    reason = f"{verdict.reason}, and both arms reach out: {changed} of their sides changed"
    return judged._replace(verdict=verdict.model_copy(update={"reason": reason}))


def _empty_hand(view: CriticView, name: str) -> str | None:
    """The first camera on a hand that does not see an object between its fingers in the end; None where all do."""
    for camera, picture in view.question.uncalibrated.get("after", {}).items():
        hand = in_hand(view, name, {camera: picture})
        if fingers_touch(view.question, {camera: picture}) or (hand is not None and not hand.agrees):
            return camera
    return None


def _arm_seen(view: CriticView) -> np.ndarray:
    """(H, W) bool, the changes that reach an edge of the picture, where no object stands, and what is around them; not
    where the table has come to be seen, which no arm hides."""
    _, labels = cv2.connectedComponents(grown(view.change.all, SETTINGS.joined_px).astype(np.uint8))
    edge = np.concatenate([labels[-1], labels[0], labels[:, 0], labels[:, -1]])  # an arm may leave the picture, too
    arm = np.isin(labels, np.setdiff1d(edge, 0))
    return grown(arm, VIEW.around_px) & ~(view.stood_before & ~view.stands_after)
