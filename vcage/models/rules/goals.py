"""Goals that the commands of one reading of a sentence ask for in a scene."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

from vcage.models.rules.arms import with_arms
from vcage.models.rules.commands import JOINT, USING, Command, nouns_of
from vcage.models.rules.meanings import Meanings, Things
from vcage.models.rules.nouns import Conflict, Doubt, Noun
from vcage.models.rules.order import must_follow
from vcage.models.rules.slid import INSERTS, Slid
from vcage.models.rules.tools import TOOLS, Tools
from vcage.models.rules.vessels import Vessels, is_dumped
from vcage.objects.names import names_of
from vcage.plans.consistency import inconsistencies, unordered_contradictions
from vcage.schema.goals import AskedGoal, Reading, goal_of, part_that

ACTS = {"open": "open", "close": "open", "turn": "turn", "turn_off": "turn", "press": "press"}
"""Commands → actions on moving parts (:func:`part_that`)."""
_DONE = {"open": "open", "close": "closed", "turn": "turned", "turn_off": "turned_back", "press": "pressed"}
_EVENTS = {
    "scan": "scanned", "weigh": "weighed", "show": "presented", "lift": "lifted", "shake": "shaken", "hold": "held_up",
    "hit": "hit", "wipe": "wiped",
    "in_hands": "held_up", "hold_with_both": "held_by_both", "away": "moved_away", "face": "facing_robot",
    "stand_up": "upright",
}  # fmt: skip
_IN_A_HAND = ("lift", "shake", "hold", "in_hands", "hold_with_both", "away", "face", "stand_up")
"""Commands about a thing that a hand carries."""
_BRINGING = ("put", "hand", "tower", "show", "hang", "insert", "together")
"""Commands that take a thing somewhere, which is lifted for it."""


@dataclass
class Goals:
    """The goals that the commands of one reading ask for."""

    things: Things
    lying: Mapping[str, str]
    commands: Sequence[Command]
    _added: list[AskedGoal] = field(default_factory=list)
    _picked: dict[str, Command] = field(default_factory=dict)
    _unfinished: dict[str, Command] = field(default_factory=dict)
    _arms: dict[str, str] = field(default_factory=dict)
    _moved: set[str] = field(default_factory=set)
    _used: set[str] = field(default_factory=set)
    _held: set[str] = field(default_factory=set)

    def read(self) -> Reading:
        """The goals in their order: commands of one group in any, unless one of them needs another.

        Raises:
            Doubt: a noun means nothing or too much here, or something cannot be done so.
        """
        self.commands = with_arms(self.commands)
        nouns = [noun for c in self.commands for noun in (*c.things, c.place) if noun is not None]
        self._meanings = found = Meanings(self.things, self.lying, nouns)
        self._vessels, self._slid = Vessels(self.things, self.lying, found), Slid(self.things, found)
        self._tools = Tools(self.things, found)
        goals: list[AskedGoal] = []
        for _, group in itertools.groupby(self.commands, lambda command: command.group):
            goals += self._in_steps(list(group), max((asked.step + 1 for asked in goals), default=1))
        subjects = {asked.goal.subject for asked in goals}
        if command := next(iter(self._unfinished.values()), None):
            raise Doubt(command.words, "picking up is no goal by itself; say where it goes, or to hold it up")
        self._require_stood_up({asked.goal.subject for asked in goals if asked.goal.relation == "upright"})
        descriptions = list(found.descriptions.values())
        if clashes := inconsistencies(goals, descriptions):
            raise Conflict("", "; ".join(clashes))
        untouched = [name for name in dict.fromkeys(found.excepted) if name not in subjects]
        return Reading(goals=goals, untouched=untouched, descriptions=descriptions)

    def _require_stood_up(self, stood_up: set[str]) -> None:
        """Refuse to call a thing fallen over that is not stood up.

        Raises:
            Doubt: names it, and what to ask for.
        """
        lying = (noun for noun in nouns_of(self.commands) if noun.lies)
        for noun in (noun for noun in lying if not stood_up.issuperset(self._meanings.objects(noun))):
            example = "stand it up, or put it upright on the tray"
            raise Doubt(noun.text, f"only what is stood up lies on its side at the start; say so, as in: {example}")

    def _in_steps(self, group: Sequence[Command], first: int) -> list[AskedGoal]:
        """The goals of commands that no word puts in order: as said, if one of them needs another."""
        added: list[list[AskedGoal]] = []
        for command in group:
            self._added = []
            getattr(self, f"_{command.verb}", self._event)(command)
            added.append(self._added)
        goals = list(itertools.chain(*added))
        arms = {asked.arm for asked in goals if asked.goal.relation != "handed"}
        complaints = unordered_contradictions([asked.goal for asked in goals])
        if None in arms and len(arms) > 1:
            complaints.append("say for each thing that is done which arm does it")
        if complaints:
            raise Conflict("", "; ".join(complaints))
        ordered = any(must_follow(before, after) for before, after in itertools.combinations(added, 2))
        ordered |= not self._used.isdisjoint(asked.goal.subject for asked in goals)
        steps = enumerate(filter(None, added))
        return [a.model_copy(update={"step": first + number * ordered}) for number, several in steps for a in several]

    def _add(self, command: Command, subject: str, relation: str, *rest: str | None, arm: str | None = None) -> None:
        if arm is None and subject not in self._moved:
            self._require_holder(command, subject)
        self._unfinished.pop(subject, None)
        if self.things[subject].loose:
            raise Doubt(command.words, f"{subject} rolls, and balls are only poured")
        goal, arm = goal_of([subject, relation, *rest]), arm or command.arm or self._arms.get(subject)
        if goal.reference in self._meanings.excepted:
            raise Doubt(command.words, f"{goal.reference} is excepted")
        if goal.kind.acts_on is None and not goal.kind.event:
            self._moved.add(subject)
        if goal not in [asked.goal for asked in self._added]:
            words = _joined(self._picked.get(subject, command), command)
            self._added.append(AskedGoal(goal=goal, step=1, words=words, arm=arm))

    def _require_holder(self, command: Command, name: str) -> None:
        """Refuse to use a thing with another arm than that which has it, if one does.

        Raises:
            Conflict: names both arms.
        """
        if (holder := self._arms.get(name)) is not None and command.arm not in (None, holder):
            why = f"the {holder} arm has {name}; hand it to the {command.arm} arm before"
            raise Conflict(command.words, why)

    def _named(self, command: Command, besides: Collection[str] = (), least: int = 1) -> list[str]:
        """The objects of a command's nouns for things, and where they are taken from."""
        found = [name for noun in command.things for name in self._meanings.objects(noun, besides)]
        names = list(dict.fromkeys(found))
        if command.source is not None:
            for name in names:
                self._meanings.lies(name, command.source_how, command.source)
        if len(names) < least:
            raise Doubt(command.words, f"it takes {least} things")
        return names

    def _pick(self, command: Command) -> None:
        picked = dict.fromkeys(self._named(command), command)
        if command.source is None and command.words.lower().endswith(" out") and self._moved.isdisjoint(picked):
            raise Doubt(command.words, "say what it is taken out of, as in: take the lemon out of the basket")
        self._picked, self._unfinished = picked | self._picked, self._unfinished | picked
        self._arms |= {name: command.arm for name in self._named(command) if command.arm is not None}

    def _fallen(self, command: Command) -> None:
        """No goal: what has fallen over must be stood up, which is asked for later."""
        self._named(command)

    def _lift(self, command: Command) -> None:
        """Lifting what a later command brings somewhere is picking it up."""
        (self._pick if self._is_brought_later(command) else self._event)(command)

    def _hold(self, command: Command) -> None:
        if self._is_brought_later(command):
            raise Conflict(command.words, "what a hand holds up stays in it to the end; leave out that it is held")
        self._event(command)
        self._held |= {asked.goal.subject for asked in self._added}

    def _is_brought_later(self, command: Command) -> bool:
        """True where a later command brings a thing of this one somewhere, or uses it as a tool."""
        later = self.commands[self.commands.index(command) + 1 :]
        nouns = [noun for c in later if c.verb in _BRINGING for noun in c.things]
        nouns += [c.place for c in later if c.verb in USING and c.place is not None]
        brought = {(noun.name, noun.colour) for noun in nouns}
        return bool(brought & {(noun.name, noun.colour) for noun in command.things})

    def _put(self, command: Command, most: int | None = None) -> None:
        """The counted objects in, on or beside their target, or in a hole of it."""
        assert command.place is not None
        if command.place.but and command.place.definite:
            raise Doubt(command.place.text, "nothing can be left out of it")
        if command.how != "in" and INSERTS.search(command.words):
            raise Doubt(command.words, "things are inserted in something, not on it or beside it")
        if is_dumped(command):
            self._vessels.require_none(command, self._named(command))
        if block := self._slid.block(command):
            self._slide(command, "inserted_in", block)
        else:
            self._set_down(command, command.place, most)

    def _set_down(self, command: Command, place: Noun, most: int | None) -> None:
        """The counted objects in, on or beside a place; of several drawers each gets one in turn."""
        loose = any(noun.several for noun in command.things)  # "everything" is all but the place
        spots = self._meanings.spots(place, command.how, [] if loose else self._named(command))
        names = self._named(command, [spot.name for spot in spots], least=len(spots))
        for name, spot in zip(names[:most], itertools.cycle(spots), strict=False):
            if spot.relation in ("inside", "on") and not self.things[name].can_be_carried:
                raise _not_lifted(command, name)
            self._add(command, name, spot.relation, spot.name or None, spot.part)

    def _tower(self, command: Command) -> None:
        """Things on each other, the first of them on the place that is named."""
        if command.place is not None:
            self._put(command, most=1)
        for below, above in itertools.pairwise(self._named(command, least=1 if command.place else 2)):
            spot = self._meanings.spot_of(below, "to", command.things[0])
            self._add(command, above, spot.relation, spot.name)

    def _stamp(self, command: Command) -> None:
        for name in self._named(command):
            if names_of(self.things[name]).words[-1] != "stamp":
                raise Doubt(command.words, f"{name} is no stamp")
        self._put(command)

    def _in_hands(self, command: Command) -> None:
        if len(self._named(command)) != 2:
            raise Doubt(command.words, "each of two arms holds one thing: name two things")
        self._hold(command)

    def _hold_with_both(self, command: Command) -> None:
        if len(self._named(command)) != 1:
            raise Doubt(command.words, "both arms hold one thing together; of two things say: one in each hand")
        self._hold(command)

    def _swap(self, command: Command) -> None:
        names = self._named(command)
        if len(names) != 2:
            raise Doubt(command.words, "two things change places: name two")
        if moved := [name for name in names if name in self._moved]:
            why = f"{moved[0]} is moved before, and things change the places that they have at the start"
            raise Conflict(command.words, f"{why}; say where each of them goes")
        for name, other in (names, names[::-1]):
            if not self.things[name].can_be_carried:
                raise _not_lifted(command, name)
            self._add(command, name, "in_place_of", other)

    def _together(self, command: Command) -> None:
        """Of two things beside each other one is brought to the other, a thing that can be carried if one can."""
        names = self._named(command)
        if len(names) != 2:
            raise Doubt(command.words, "two things are put beside each other; of more say what goes beside which")
        brought, other = sorted(names, key=lambda name: not self.things[name].can_be_carried)
        self._add(command, brought, command.how, other)

    def _row(self, command: Command) -> None:
        for left, right in itertools.pairwise(self._named(command, least=2)):
            self._add(command, left, "row_left_of", right)

    def _hand(self, command: Command) -> None:
        for name in self._named(command):
            if name not in self._moved:
                self._require_holder(command, name)
            giver = command.arm or self._arms.get(name)
            if command.how in ("any", giver):
                raise Doubt(command.words, "say which arm gets it: left or right")
            self._add(command, name, "handed", command.how, arm=giver)
            self._arms[name] = command.how

    def _use(self, command: Command) -> None:
        """Hitting takes a tool with a head, and wiping one with a pad, which keeps the arm that took it."""
        tool = self._tools.of(command, [name for name in self._picked if name not in self._moved])
        if tool not in self._moved:
            self._require_holder(command, tool)
        arm, taken = self._arms.get(tool), self._picked.pop(tool, command)
        named = command.place or taken.things[0]
        self._unfinished.pop(tool, None)
        self._used.add(tool)
        self._event(replace(command, arm=command.arm or arm, words=_joined(taken, command)))
        subjects = [asked.goal.subject for asked in self._added]
        self._tools.require_one(command, named, subjects, self._held)

    _hit = _wipe = _use

    def _pour(self, command: Command) -> None:
        """Pouring tips the vessel that is named, that balls are poured out of, or that was picked up for it."""
        assert command.place is not None
        if command.how != "in":
            raise Doubt(command.words, "things are poured into what is open at the top")
        held = [taken for name, taken in self._picked.items() if name not in self._moved]
        vessels = self._vessels.emptied(command, self._named(command), held)
        (spot,) = self._meanings.spots(command.place, "in", vessels)
        if spot.part is not None:
            raise Doubt(command.place.text, "things are poured into what stands there, not into a part of it")
        for name in vessels:
            taken = self._picked.pop(name, command)
            self._vessels.require(command, name)
            arm = command.arm or self._arms.get(name)
            self._add(replace(command, arm=arm, words=_joined(taken, command)), name, "poured", spot.name)

    def _hang(self, command: Command) -> None:
        """Hanging brings a peg of the named place, or of the only rack, through the closed handle of each thing."""
        self._slide(command, "hung_on", self._slid.rack(command))

    def _insert(self, command: Command) -> None:
        """Inserting things without saying where takes the only thing with holes."""
        self._slide(command, "inserted_in", self._slid.only_block(command))

    def _slide(self, command: Command, relation: str, place: str) -> None:
        """Each thing is slid over or into a spot of its own at a place."""
        names = self._named(command)
        self._slid.require(command, relation, names, place)
        for name in names:
            self._add(command, name, relation, place)

    def _event(self, command: Command) -> None:
        """Add the goal of an act on a part of a thing, or on a thing with a tool."""
        if command.verb in ACTS:
            for noun in command.things:
                for name, part in self._meanings.parts(noun, lambda _, part: part_that(ACTS[command.verb], part)):
                    self._add(command, name, _DONE[command.verb], None, part)
            return
        able = TOOLS.get(command.verb, lambda e: False)
        tools = [name for name, entry in self.things.items() if able(entry)]
        named = self._meanings.objects(command.place) if command.place is not None else tools
        if command.verb in TOOLS and not set(named) & set(tools):
            raise Doubt(command.words, f"there is nothing to {command.verb} with")
        self._meanings.tools += tools
        for name in self._named(command, tools):
            if command.verb in _IN_A_HAND and not self.things[name].can_be_carried:
                raise _not_lifted(command, name)
            self._add(command, name, _EVENTS[command.verb])


def _not_lifted(command: Command, name: str) -> Doubt:
    """The refusal of a thing that no hand lifts; a conflict where its pronoun may mean another one."""
    if command.may_be:
        return Conflict(command.words, f"it may be {' or '.join(command.may_be)}; name the one that is meant")
    return Doubt(command.words, f"{name} cannot be lifted")


def _joined(before: Command, command: Command) -> str:
    """The words of a command with those of the one by which its thing or its tool was taken, if that is another."""
    if before is command:
        return command.words
    begins = command.typed.find(command.words, before.at)
    between = command.typed[before.at + len(before.words) : begins]
    # Other commands may stand between the two.
    return f"{before.words}{between if JOINT.fullmatch(between) else ' and '}{command.words}"
