"""Evidence of standing up: the object left the place where it lay, and is seen on its bottom, not on a side or its
head."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Pose
from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.evidence.judgement import Judged, decided, unseen
from vcage.models.rules.evidence.moved import Moved, judge_moved
from vcage.models.rules.standing import Sought, Standing
from vcage.schema.goals import Goal


@dataclass(frozen=True)
class UprightSettings:
    """When pictures show an object on its bottom.

    Args:
        headings: in which it may lie, tried at the place where it is.
        unlike_lab: mean colour distance to drawings of it from which on it is not seen to stand.
        on_side_lab, on_head_lab: by this much drawings of it in other attitudes must be less like the pictures: of a
            white cup on its side by 1.4 to 2.0, of a can, which differs by its label only, on its head by 0.7 to 1.2.
        sure_lab: a drawing on its side that is less like the pictures by this much makes a yes certain.
    """

    headings: int = 8
    unlike_lab: float = 14.0
    on_side_lab: float = 0.5
    on_head_lab: float = 0.3
    sure_lab: float = 10.0


SETTINGS = UprightSettings()


def judge_upright(view: CriticView, goal: Goal) -> Judged:
    """Judge whether an object that lay on its side was put down on its bottom."""
    name, thing = goal.subject, view.phrase(goal.subject)
    if name not in view.question.stood_up:
        return unseen(view, f"that the {thing} lay on its side")
    moved, (verdict, explained) = Moved.of(view, name), judge_moved(view, goal)
    held = any(one.subject == name and one.reference in view.question.planned for one in view.question.goals)
    if moved.new is None or not (verdict.accepted or held):  # another goal tells whether it is in or on a thing
        return Judged(verdict, explained)
    stands = view.stood_up(name).near(_around(moved.new), view.after).unlike
    on_side = _lying(view, name, moved.new).unlike - stands
    on_head = _on_its_head(view, name).near(_around(moved.new), view.after).unlike - stands
    seen = (
        f"drawings of the {thing} on its side are less like the pictures by {on_side:.1f}, on its head by {on_head:.1f}"
    )
    clear = on_side >= SETTINGS.on_side_lab and on_head >= SETTINGS.on_head_lab and stands <= SETTINGS.unlike_lab
    confidence = 0.5 + 0.5 * min(1.0, on_side / SETTINGS.sure_lab)
    return Judged(decided(clear, f"{seen} in colour", confidence, "astray"), explained)


def _around(there: Standing) -> list[Pose]:
    """The pose of an object, at headings all around."""
    turns = 2 * np.pi * np.arange(SETTINGS.headings) / SETTINGS.headings
    return [Pose.from_yaw(there.pose.p, there.pose.yaw + turn) for turn in turns]


def _lying(view: CriticView, name: str, there: Standing) -> Standing:
    """The object on its side about where something stands: its middle there, or its bottom."""
    turns = [2 * np.pi * number / SETTINGS.headings for number in range(SETTINGS.headings)]
    thing, length = view.sought(name), view.look(name).size[1]
    starts = [
        Pose.from_yaw(there.pose.p + share * length * np.array([-np.sin(turn), np.cos(turn), 0.0]), turn)
        for turn in turns
        for share in (0.0, 0.5)
    ]
    return thing.near(starts, view.after)


def _on_its_head(view: CriticView, name: str) -> Sought:
    """The object upside down."""
    return view.stood_up(name, Pose([0.0, 0.0, view.question.stood_up[name].look.size[2]], [0.0, 1.0, 0.0, 0.0]))
