"""Place: a portable object is put in or on another with a place for it, including an open drawer.

Stacking and weighing are placing with a further demand: see :mod:`~vcage.tasks.templates.stack` and
:mod:`~vcage.tasks.templates.weigh`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import permutations
from typing import NamedTuple

import numpy as np

from vcage.base.errors import InfeasibleScene
from vcage.schema.asset import FunctionalPoint
from vcage.schema.goals import Goal, part_words
from vcage.schema.subtasks import Check, PairQuestion, Refusal, Subtask, TemplateName
from vcage.tasks.access import access, open_to_a_hand
from vcage.tasks.feasibility import Transfer, examine, fits, transfers
from vcage.tasks.findings import Feasibility, best_first
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import (
    CONTENT_GAP_M,
    HEADING,
    allocate,
    heading_for,
    kept_in_by,
    lying_in,
    nested_bottom,
    opened_for,
    room_for,
    slot_in,
    stands_flush,
)
from vcage.tasks.stowing import reached
from vcage.tasks.templates.hand_over import examine_detour
from vcage.tasks.templates.proposal import Proposal, stood_up
from vcage.tasks.workplace import Workplace


@dataclass(frozen=True)
class Placing:
    """A template that puts an object in or on another.

    Args:
        name: of the template.
        takes: True for a pair of objects with a functional point of this template.
        word: the goal it achieves besides the placing; None for no other.
        waits: time the object then stays there alone, seconds.
    """

    name: TemplateName
    takes: Callable[[SceneObject, SceneObject, FunctionalPoint], bool]
    word: str | None = None
    waits: float = 0.0

    def proposals(self, objects: Sequence[SceneObject], asked: Collection[Goal]) -> tuple[list[Pair], list[Refusal]]:
        """Pairs with one functional point each, and pairs without the needed points."""
        pairs, refused = [], []
        for target, receptacle in permutations(objects, 2):
            points = receptacle.asset.annotation.functional_points
            if not points and self.name == "place":
                reason = f"{receptacle.record.phrase} has no place to put something in or on"
                refused.append(Refusal(template=self.name, object=target.id, receptacle=receptacle.id, reason=reason))
            mine = [
                Pair(self.name, target, self._goal(target, receptacle, point, asked), self, receptacle, point, asked)
                for point in points
                if self.takes(target, receptacle, point)
            ]
            facing = [goal for goal in asked if goal.relation == HEADING and goal.subject == target.id]
            mine += [replace(pair, facing=goal) for pair in mine for goal in facing if pair.goal in asked]
            if target.asset.annotation.carrying_points:
                pairs += mine
            else:
                refused += [pair.not_carried() for pair in mine]
        return pairs, refused

    def _goal(
        self, target: SceneObject, receptacle: SceneObject, point: FunctionalPoint, asked: Collection[Goal]
    ) -> Goal:
        """The goal of placing an object there: the whole of a receptacle where nobody asked for the compartment."""
        if self.word is not None:
            return Goal(subject=target.id, relation=self.word)
        named, whole = lying(target, receptacle, point), _resting(target, receptacle, point, point.link)
        return whole if whole in asked and named not in asked else named

    def calls(self, subtask: Subtask) -> list[str]:
        """The lines of the script's ``play``; GRASPS is a constant of the script."""
        wait = [f"task.wait({self.waits})"] if self.waits else []
        return [
            f"task.pick({subtask.object!r}, grasps=[(contact, arm) for contact, arm, _ in GRASPS])",
            f"task.place({subtask.receptacle!r}, point={subtask.functional_point})",
            "task.home()",
            *wait,
        ]


def lying(target: SceneObject, receptacle: SceneObject, point: FunctionalPoint) -> Goal:
    """The goal that an object is in or on another, at one of its functional points."""
    return _resting(target, receptacle, point, point.part)


def _resting(target: SceneObject, receptacle: SceneObject, point: FunctionalPoint, part: str | None) -> Goal:
    word = "inside" if point.holds == "in" else "on"
    return Goal(subject=target.id, relation=word, reference=receptacle.id, part=part)


def _elsewhere(refusal: Refusal) -> bool:
    """True where the hand may get to another place in the receptacle."""
    return any(check.name in ("drop", "reach_place") and not check.passed for check in refusal.checks)


PLACE = Placing("place", takes=lambda target, receptacle, point: not stands_flush(target, receptacle, point))


def _out_of_reach(refusal: Refusal) -> bool:
    """True where an arm that takes the object does not reach its place."""
    return any(check.name == "reach_place" and not check.passed for check in refusal.checks)


class _AtSlot(NamedTuple):
    """Transfers to one slot by contact point, the feasible ones, and refusals of the others."""

    transfers: dict[int, Transfer]
    feasible: list[Feasibility]
    refused: list[Refusal]


@dataclass(frozen=True)
class Pair(Proposal):
    """An ordered pair, the object that is put first, with one functional point.

    Where no arm reaches both ends it changes hands on its way, if that is among the goals in ``asked``. With ``facing``
    it is put there with the heading of that goal.
    """

    template: Placing
    receptacle: SceneObject
    point: FunctionalPoint
    asked: Collection[Goal]
    facing: Goal | None = None

    @cached_property
    def _opened(self) -> SceneObject:
        """The receptacle as required for putting something there: its drawer or lid is open."""
        return opened_for(self.receptacle, self.point.id)

    @property
    def goals(self) -> list[Goal]:
        """Goals it would achieve, its own first."""
        named = lying(self.thing, self.receptacle, self.point)
        whole = _resting(self.thing, self.receptacle, self.point, self.point.link)
        heading = [] if self.facing is None else [self.facing]
        return list(dict.fromkeys([self.goal, named, whole, *heading, *stood_up(self.thing)]))

    @property
    def templates(self) -> tuple[TemplateName, ...]:
        """Its own; and for a plain placing also ``hand_over``, as the object may change hands on its way."""
        return (self.name, "hand_over") if self.name == "place" else (self.name,)

    def offers(self, subtask: Subtask) -> bool:
        """True where a sub-task puts the object there."""
        here = (subtask.object, subtask.receptacle, subtask.functional_point)
        return here == (self.thing.id, self.receptacle.id, self.point.id) and {*subtask.goals} == {*self.goals}

    def impossible(self) -> Refusal | None:
        """Refuse a place that is closed above or too small, or in a drawer above or below the object's own."""
        own = self.thing.record.container_part
        if own is not None and self.thing.record.container == self.receptacle.id:
            needs = {*self._requires(), *open_to_a_hand(self.receptacle, own)}
            if any(g.relation == "open" and g.model_copy(update={"relation": "closed"}) in needs for g in needs):
                return self.refusal(
                    f"it lies in the {part_words(own)}: no hand gets into two drawers, one over the other"
                )
        check = access(self._opened, self.point)
        if check.passed:
            check = fits(self.thing, self.receptacle, self.point)
        if not check.passed:
            return self.refusal(check.message, checks=[check])
        if nested_bottom(self.thing, self.receptacle, self.point) is not None:
            return None
        room = room_for(self.receptacle, self.point.id, [self.thing])
        if np.any(np.sort(room) < np.sort(self.thing.as_standing.asset.footprint)):
            need = f"less than the {CONTENT_GAP_M * 1000:.0f} mm on each side that the robot needs"
            tight = check.model_copy(update={"passed": False, "message": f"{check.message}, but with {need}"})
            return self.refusal(tight.message, checks=[tight])
        return None

    def question(self) -> PairQuestion:
        """The question whether the receptacle can sensibly hold the object."""
        opening = self.receptacle.asset.opening(self.point)
        x, y, z = self.thing.as_standing.asset.size.tolist()
        return PairQuestion(
            object=self.thing.id,
            object_words=f"{self.thing.record.phrase}: {self.thing.asset.annotation.words.description}",
            receptacle=self.receptacle.id,
            receptacle_words=f"{self._place_words()}: {self.receptacle.asset.annotation.words.description}",
            holds=self.point.holds,
            object_size=(x, y, z),
            opening_size=(float(opening.size[0]), float(opening.size[1]), float(opening.depth)),
        )

    def examine(self, workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task of a sensible pair, and a refusal for each contact point that no arm can use.

        Args:
            workplace: with all objects of the scene.
        """
        there = reached(self.thing, workplace.others(self.thing.id))
        others = [self._opened if o.id == self.receptacle.id else o for o in there.others]
        try:
            tried = self._at_some_slot(there.thing, others, workplace)
        except InfeasibleScene as error:
            return None, [self.refusal(error.message)]
        if tried.feasible:
            return self._subtask(workplace.objects, tried.feasible, there.requires), tried.refused
        if self.goal not in self.asked or self.name != "place" or not any(map(_out_of_reach, tried.refused)):
            return None, tried.refused
        passing = replace(self, name="hand_over")
        to, findings = examine_detour(list(tried.transfers.values()), workplace)
        if to is not None:
            return passing._subtask(workplace.objects, findings, there.requires, to), tried.refused
        return None, tried.refused + passing.judged(dict(zip(tried.transfers, findings, strict=False)))[1]

    def _at_some_slot(
        self,
        thing: SceneObject,
        others: Sequence[SceneObject],
        workplace: Workplace,
        slots: int = 12,
        slots_out_of_reach: int = 5,
    ) -> _AtSlot:
        """Examine slots until one is feasible, or more of them would not help.

        Args:
            thing: that is put there.
            others: all other objects.
            workplace: with the arms.
            slots: number to try before a contact point is refused because of its place.
            slots_out_of_reach: the same where the only fault is that no arm reaches the place, and nobody asked for it.

        Raises:
            InfeasibleScene: there is no room for the object.
        """
        present = lying_in(self.receptacle, self.point, others)
        tried = _AtSlot({}, [], [])
        heading = heading_for(self.goals, self._opened, self.point.id)
        headings = {} if heading is None else {self.thing.id: heading}
        for number in range(slots):
            drawn = allocate(self._opened, self.point.id, [self.thing], workplace.rng, present, headings)
            slot = slot_in(self._opened, self.point.id, drawn[self.thing.id], self.goals, self.thing)
            poses = slot.poses({self.receptacle.id: self._opened})
            ways = transfers(thing, self._opened, self.point.id, poses, others)
            found = {contact: examine(way, workplace) for contact, way in ways.items()}
            tried = _AtSlot(ways, *self.judged(found))
            enough = self.goal not in self.asked and number + 1 >= slots_out_of_reach
            far = enough and all(map(_out_of_reach, tried.refused))
            if tried.feasible or far or not any(map(_elsewhere, tried.refused)):
                break
        return tried

    def _place_words(self) -> str:
        phrase = self.receptacle.record.phrase
        return phrase if self.point.part is None else f"{part_words(self.point.part)} of the {phrase}"

    def _requires(self) -> list[Goal]:
        """Goals that must be true before: the drawer or lid of the place is open, with no open drawer over it."""
        part = kept_in_by(self.receptacle, self.point.id)
        return [] if part is None else open_to_a_hand(self.receptacle, part)

    def _subtask(
        self,
        objects: Sequence[SceneObject],
        findings: Sequence[Feasibility],
        taken_from: Sequence[Goal],
        hand_to: str | None = None,
    ) -> Subtask:
        grasps, checks = best_first(findings)
        word = self.template.word or ("into" if self.point.holds == "in" else "onto")
        word = word if hand_to is None else f"handed-{word}"
        several = len(self.receptacle.asset.annotation.functional_points) > 1
        suffix = f"-{self.point.part or self.point.id}" if several else ""
        suffix += "" if self.facing is None else f"-{self.facing.relation}"
        return self.subtask(
            f"{self.thing.id}-{word}-{self.receptacle.id}{suffix}",
            objects,
            receptacle=self.receptacle.id,
            functional_point=self.point.id,
            grasps=grasps,
            hand_to=hand_to,
            requires=list(dict.fromkeys([*self._requires(), *taken_from])),
            goals=self.goals,
            checks=checks,
        )

    def refusal(self, reason: str, contact: int | None = None, checks: Sequence[Check] = ()) -> Refusal:
        """The refusal of it, or of a contact point."""
        where = {"receptacle": self.receptacle.id, "functional_point": self.point.id}
        return super().refusal(reason, contact, checks).model_copy(update=where)
