"""Effects of sub-tasks on the truth of goals: a small STRIPS world (Fikes and Nilsson, 1971) whose facts are goals.

A state is the set of true goals. Making one true makes others false: an object is in one place at a time, a
part is open or closed.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass

from vcage.goals import KINDS
from vcage.schema.goals import Description, Goal

State = frozenset[Goal]
AT_START = "back"
"""Word of an object that stands where it stood at the start."""

HOLDING = ("inside", "on")
"""Words that say what an object lies in or stands on, of goals and of relations."""

SLID = {"hung_on": "hung", "inserted_in": "inserted"}
"""Words of goals whose thing must come from the table, and is not taken again → their participles."""


@dataclass(frozen=True)
class Action:
    """A sub-task as the planner sees it.

    Args:
        name: id of the sub-task.
        requires: what must be true before it.
        adds: goals true after it, or events done by it.
        moves: the carried object: nothing may lie on it, and it leaves its old place.
        empty: an object that nothing may lie in or on before: the scale, when something else is weighed.
        along: True if contents of the carried object may stay in it and move along; else it must be empty.
        object: the object that it is about, which no hand may hold before.
        vacant: an object that must have left its starting place before.
        spare: number of arms that may hold something up meanwhile.
        pours: a vessel, and the object in which its contents lie afterwards.
    """

    name: str
    requires: State
    adds: State
    moves: str | None = None
    empty: str | None = None
    along: bool = False
    object: str | None = None
    vacant: str | None = None
    spare: int = 0
    pours: tuple[str, str] | None = None

    def obstacle(self, state: State) -> str:
        """Why it cannot be done in a state; "" when it can."""
        missing = sorted(map(str, self.requires - state))
        if missing:
            return f"{' and '.join(missing)} must be true first"
        if any(g.relation == AT_START and g.subject == self.vacant for g in state):
            return f"{self.vacant} must leave its place first"
        return self._held(state) or self._laden(state)

    def _held(self, state: State) -> str:
        """Why the hands are not free for it; "" when they are."""
        held = sorted(g.subject for g in state if g.kind.fleeting)
        if len(held) > self.spare:
            return f"it takes the hand that holds {' or '.join(held)}"
        return f"{self.object} is in a hand" if self.object in held else ""

    def _laden(self, state: State) -> str:
        """Why an object that must be bare is not; "" when it is."""
        bare = [name for name in (self.moves, self.empty) if name is not None]
        carried = self._carried(state)
        laden = [g for g in state if g.relation in HOLDING and g.reference in bare and g.subject not in carried]
        needs = sorted(f"{g.subject} must be taken off {g.reference}" for g in laden)
        return f"{' and '.join(needs)} first" if needs else ""

    def after(self, state: State) -> State:
        """The state that it leads to."""
        kept = (g for g in state if not any(overrides(new, g) for new in self.adds))
        if self.moves is not None:
            moved = {self.moves, *self._carried(state)}
            kept = (g for g in kept if g.kind.event or not moved & {*_placed(g)} or _within(g, moved))
        return self.adds.union(kept if self.pours is None else self._poured([*kept], *self.pours))

    def _poured(self, state: Sequence[Goal], vessel: str, target: str) -> Iterator[Goal]:
        """Goals that are true after the contents of a vessel were poured into a target."""
        out = {g.subject for g in state if g.relation in HOLDING and g.reference == vessel}
        for goal in state:
            if goal.kind.event or not out & {*_placed(goal)}:
                yield goal
        yield from (Goal(subject=name, relation="inside", reference=target) for name in out)

    def _carried(self, state: State) -> set[str]:
        """Name the objects that move along: the contents of the moved object, and theirs."""
        if not self.along:
            return set()
        lying = {g.subject: g for g in state if g.relation in HOLDING}
        found: set[str] = set()
        while more := {name for name, g in lying.items() if name not in found and self._is_within_group(g, found)}:
            found |= more
        return found

    def _is_within_group(self, lies: Goal, carried: set[str]) -> bool:
        inside = lies.reference == self.moves and lies.relation == "inside" and lies.part is None
        return inside or lies.reference in carried


def _within(goal: Goal, moved: set[str]) -> bool:
    """Check if a goal gives the place of an object among those moved together."""
    return goal.relation in HOLDING and goal.subject in moved and goal.reference in moved


def _placed(goal: Goal) -> tuple[str | None, ...]:
    """The objects whose places make a goal true: where the former owner of a place is now does not matter."""
    if _opposite(goal) is not None:
        return ()
    return (goal.subject,) if goal.relation == "in_place_of" else (goal.subject, goal.reference)


def overrides(new: Goal | Description, old: Goal | Description) -> bool:
    """True where ``new`` cannot be true together with ``old``."""
    if new == old or new.subject != old.subject:
        return False
    opposite = _opposite(new)
    if opposite is not None:
        return old.relation == opposite and old.part == new.part
    return new.relation in HOLDING and old.relation in HOLDING


def supersedes(later: Goal, goal: Goal) -> bool:
    """True where a later goal excuses an earlier one of the same object from being true at the end."""
    if later.subject != goal.subject or goal.kind.event:
        return False
    if _opposite(goal) is not None:
        return _opposite(later) is not None and later.part == goal.part
    return not later.kind.event and _opposite(later) is None


def _opposite(stated: Goal | Description) -> str | None:
    """The word that is true of a part where this one is false; None of a place, which has no opposite."""
    return KINDS[stated.relation].opposite if stated.relation in KINDS else None


def open_at_start(steps: Iterable[Collection[Goal]]) -> set[tuple[str, str]]:
    """(object, part) of every part that is to be closed, or turned back, before anything opens or turns it: it must be
    open, or on, then."""
    first: dict[tuple[str, str], Goal] = {}
    for goal in (goal for step in steps for goal in step if _opposite(goal) is not None and goal.part is not None):
        first.setdefault((goal.subject, str(goal.part)), goal)
    return {part for part, goal in first.items() if goal.kind.rests}


def lasting(steps: Iterable[Collection[Goal]]) -> list[Goal]:
    """The goals of all steps that must be true at the end, always in the same order."""
    found: list[Goal] = []
    for step in steps:
        found = [g for g in found if not any(supersedes(later, g) for later in step)] + sorted(step, key=str)
    return [goal for goal in found if not goal.kind.event]
