"""The moments at which pictures show an object in the air."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from vcage.models.rules.critic_view import CriticView
from vcage.vision.protocols import View


@dataclass(frozen=True)
class Moment:
    """Pictures of an object in the air.

    Args:
        views: by calibrated camera.
        hand: (H, W, 3) uint8 RGB by name, of the camera on the acting hand.
        is_end: True where the object is still in the air afterwards; else it is put down.
    """

    views: Mapping[str, View]
    hand: Mapping[str, np.ndarray]
    is_end: bool = False


def at_moment(view: CriticView) -> Moment | None:
    """The moment of a lift; None where a picture of it is missing."""
    return _moment(view, view.moment, "moment")


def at_later(view: CriticView) -> Moment | None:
    """The second moment; None where a picture of it is missing."""
    return _moment(view, view.later, "later")


def at_end(view: CriticView) -> Moment | None:
    """The end, when something is still held up; None where a picture is missing."""
    moment = _moment(view, view.after, "after", is_end=True)
    acting = view.question.uncalibrated.get("moment", {})  # of both hands, the one that acts
    return moment and replace(moment, hand={name: p for name, p in moment.hand.items() if name in acting})


def _moment(view: CriticView, views: Mapping[str, View], when: str, is_end: bool = False) -> Moment | None:
    if any(not {"customer", "top"} <= shown.keys() for shown in (view.before, views, view.after)):
        return None
    return Moment(views, view.question.uncalibrated.get(when, {}), is_end)
