"""Chooses objects of the catalogue for a sentence so that it can be read with them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NoReturn

import numpy as np

from vcage.base.words import tokens
from vcage.models.occasion import Look, Occasion, one_of_each
from vcage.models.quantifiers import quantified
from vcage.models.rules.absent import kinds_by_head, require_part, require_size, to_leave_out
from vcage.models.rules.command_needs import RECEIVERS, UNSAID, Good, is_side_by_side, part_of, role_and_test
from vcage.models.rules.commands import Command, nouns_of
from vcage.models.rules.full_names import with_full_names
from vcage.models.rules.goals import Goals
from vcage.models.rules.meanings import BESIDE
from vcage.models.rules.nouns import Doubt, Noun
from vcage.models.rules.readings import agreed, in_words
from vcage.models.rules.tools import TOOLS
from vcage.models.search import best_search, no_asset
from vcage.models.selection_check import entries_of, name_objects
from vcage.objects.bystanders import bystanders
from vcage.objects.names import HEAD, colour_level
from vcage.objects.painting import with_look
from vcage.schema.asset import CatalogueEntry, Variant
from vcage.schema.goals import Reading
from vcage.schema.plan import SelectedAsset, Selection
from vcage.schema.scene import Role

_ROLES: tuple[Role, ...] = ("content", "receptacle", "tool", "context")


def select_assets(
    instruction: str,
    catalogue: Sequence[CatalogueEntry],
    rng: np.random.Generator,
    scene: str = "table",
) -> Selection:
    """Contents, receptacles and tools of a sentence, what tells them apart, and small objects of the occasion.

    Args:
        instruction: a sentence of one of the forms of docs/instructions.md.
        catalogue: all kinds.
        rng: of all choices.
        scene: name of the scene template: its kinds are preferred.

    Raises:
        UnreadInstruction: the sentence has no known form, or is ambiguous.
        NoAssetFits: nothing has a requested name, or comes in that colour.
    """
    seed = int(rng.integers(2**32))
    entries = {entry.name: entry for entry in sorted(catalogue, key=lambda entry: entry.name)}

    def ground(commands: tuple[Command, ...]) -> tuple[Selection, Reading]:
        chosen = _Selector(instruction, entries, np.random.default_rng(seed), scene, commands).select()
        named = name_objects(chosen, catalogue)
        lying = {o.id: o.starts_in for o in named if o.starts_in is not None}
        return chosen, Goals(entries_of(named, catalogue), lying, commands).read()

    return agreed(instruction, ground, lambda found: in_words(found[1]))[0]


@dataclass
class _Selector:
    """The choice for one reading of a sentence."""

    instruction: str
    entries: Mapping[str, CatalogueEntry]
    rng: np.random.Generator
    scene: str
    commands: Sequence[Command]
    _chosen: list[SelectedAsset] = field(default_factory=list)
    _there: list[CatalogueEntry] = field(default_factory=list)
    _of: dict[Noun, CatalogueEntry] = field(default_factory=dict)
    _side_by_side: bool = True

    def __post_init__(self) -> None:
        self.commands = with_full_names(self.commands, self.entries)
        self._nouns = [noun for c in self.commands for noun in (*c.things, c.place) if noun is not None]

    def select(self) -> Selection:
        """Select the objects that the commands need, contents first.

        Raises:
            Doubt: a row or a tower is of other things than those that are named.
        """
        for command in self.commands:
            if not command.things:
                raise Doubt(command.words, "it is not one of the things that are named")
            loose = any(n.several or len(self._kinds(n)) > 1 for n in command.things)
            for choose in (self._place, self._things) if loose else (self._things, self._place):
                choose(command)
            self._fill(command)
        catalogue, everything = list(self.entries.values()), quantified(self.instruction)
        clear = bystanders([self.instruction], self._there, catalogue)
        may = {entry.name for entry in clear if not (entry.loose or any(q.covers(entry) for q in everything))}
        self._chosen += self._occasion().standing_by(catalogue, lambda entry: entry.name not in may, self.rng)
        return Selection(objects=sorted(self._chosen, key=lambda chosen: _ROLES.index(chosen.role)))

    def _fill(self, command: Command) -> None:
        """Choose what lies in a vessel that is poured, or the vessel, where the sentence does not name it."""
        things = [self._of[noun] for noun in command.things if noun in self._of]
        if command.verb != "pour" or not things:
            return
        if not things[0].loose:
            self._fill_with_balls(command, things[0])
        elif command.source is None and not any(noun.relations for noun in command.things) and not self._vessels():
            self._put_in_a_cup(command, {entry.name for entry in things})

    def _fill_with_balls(self, command: Command, vessel: CatalogueEntry) -> None:
        noun = Noun(words=("ball",), plural=True, text=f"what is in {command.things[0].text!r}", at=-1)
        first = len(self._chosen)
        self._draw(noun, "context", lambda e: e.loose, None)
        self._start(slice(first, None), vessel.name)

    def _put_in_a_cup(self, command: Command, balls: Collection[str]) -> None:
        noun = Noun(words=("cup",), text=f"what {command.things[0].text!r} are in", at=-1)
        vessel = self._draw(noun, "content", lambda e: e.holds_loose and e.can_be_carried, None)
        for number, one in enumerate(self._chosen):
            if one.asset in balls:
                self._start(slice(number, number + 1), vessel.name)

    def _vessels(self) -> list[CatalogueEntry]:
        """The chosen kinds that a hand takes and tips."""
        picked = [self._of[noun] for c in self.commands if c.verb in ("pick", "lift") for noun in c.things]
        return [entry for entry in picked if entry.holds_loose and entry.can_be_carried]

    def _start(self, which: slice, vessel: str) -> None:
        """Let some of the chosen objects start in a vessel."""
        self._chosen[which] = [one.model_copy(update={"starts_in": vessel}) for one in self._chosen[which]]

    def _occasion(self) -> Occasion:
        """Scene tags of the chosen objects; those named by the sentence, if any."""
        tags = {tag for c in self._chosen if c.role != "context" for tag in self.entries[c.asset].words.scene_tags}
        return Occasion(self.scene, frozenset({t for t in tags if t in tokens(self.instruction)} or tags))

    def _things(self, command: Command) -> None:
        role, good = role_and_test(command)
        place, self._side_by_side = self._receiver(command), is_side_by_side(command)
        for noun in command.things:
            if noun.of_table and not self._kinds(noun):
                raise Doubt(noun.text, "the table itself stays as it is; name a thing on it")
            self._take_sources(noun, command)
            sign = command.verb == "show" and all(entry.words.category == "sign" for entry, _ in self._kinds(noun))
            self._take(noun, "tool" if sign else role, good, place)

    def _receiver(self, command: Command) -> CatalogueEntry | None:
        """The object that the things of a command go in or on; None if they go beside it, or if it is a tool."""
        place = command.place
        if place is None or command.verb in TOOLS or command.how in BESIDE:
            return None
        return part_of(place, self._of.get(place))

    def _take_sources(self, noun: Noun, command: Command) -> None:
        """Choose what a thing lies on, in or beside at the start."""
        sources = noun.relations or ([("to", command.source)] if command.source is not None else [])
        role: Role = "content" if command.verb == "pour" else "context"
        for how, source in (one for one in sources if not one[1].of_table):
            self._take(source, role, lambda e, how=how: how in BESIDE or bool(e.functional_points))

    def _place(self, command: Command) -> None:
        """Choose the target, the neighbour, or the tool of a command."""
        noun, verb = command.place, command.verb
        if noun is None and verb in UNSAID:
            noun = Noun(words=tuple(UNSAID[verb].split()), text=UNSAID[verb], at=-1)
        if noun is not None and verb in TOOLS:
            self._take(noun, "tool", TOOLS[verb])
        elif noun is not None and not noun.of_table and not noun.pronoun:
            self._require_one_meaning(noun, command)
            self._take(noun, "receptacle", RECEIVERS.get(command.verb) or self._roomy(noun, command))
            for other in (one for _, one in noun.relations if not one.of_table):
                self._take(other, "context")

    def _require_one_meaning(self, noun: Noun, command: Command) -> None:
        """Refuse to put a mug on "the rack", on which it may be hung as well.

        Raises:
            Doubt: names the kinds that are meant.
        """
        if (command.verb, command.how) != ("put", "on") or any(self._same(noun, entry) for entry in self._there):
            return
        kinds = [entry for entry, _ in self._kinds(noun)]
        names = sorted({entry.words.name for entry in kinds})
        hangs = any(entry.hangs for thing in command.things for entry, _ in self._kinds(thing))
        if hangs and len(names) > 1 and any(entry.pegs for entry in kinds):
            raise Doubt(noun.text, f"it may be the {' or the '.join(names)}; say hang, or give the full name")

    def _roomy(self, noun: Noun, command: Command) -> Good:
        """Tells of a kind if the contents go in, on or to it, and have room there."""
        contents = [self._of[thing] for thing in command.things if thing in self._of]
        fits, how = self._occasion().goes_in, command.how

        def roomy(entry: CatalogueEntry) -> bool:
            free = (point.holds for point in entry.functional_points if point.link is None)
            takes = noun.part is not None or any(how in (holds, "to") for holds in free)
            return how in BESIDE or (takes and all(fits(content, entry) for content in contents))

        return roomy

    def _take(self, noun: Noun, role: Role, good: Good = lambda e: True, place: CatalogueEntry | None = None) -> None:
        """Choose objects for a noun, unless they were chosen before."""
        again = [entry for other, entry in self._of.items() if (other.at, other.name) == (noun.at, noun.name)]
        apart = [self._of[other] for other in self._beside(noun) if other in self._of]
        free = (entry for entry in self._there if all(entry is not other for other in apart))
        known = [*again, *(entry for entry in free if self._same(noun, entry)), None][0]
        self._of[noun] = known or self._draw(noun, role, good, place)
        for but in noun.but:
            self._take(but, "context")

    def _beside(self, noun: Noun) -> list[Noun]:
        """The other nouns of its command, each for one thing, none of which is what it means."""
        # Of a pouring also the vessel in which the balls lie: it is not the one that they go into.
        commands = (
            nouns_of([c]) if c.verb == "pour" else [n for n in (*c.things, c.place) if n is not None]
            for c in self.commands
        )
        nouns = [other for named in commands if noun in named for other in named if other != noun]
        return [other for other in nouns if not (other.several or noun.several or other.pronoun)]

    def _same(self, noun: Noun, entry: CatalogueEntry) -> bool:
        """Check if a chosen object is meant again: 'the mug' after 'the red mug', the other drawer of a cabinet."""
        if not noun.definite:
            return False
        if noun.several and noun.part is None:
            return self._are_named_before(noun, entry)
        own = max(colour_level(look, noun.colour) for look in self.entries[entry.name].variants)
        if noun.part is None and all(colour_level(look, noun.colour) < own for look in entry.variants):
            return False
        if noun.part is not None and not noun.words[1:] and noun.owns(entry)[0] > 0:
            return True
        return noun.fit(entry)[0] >= HEAD and not self._means_another(noun, entry)

    def _are_named_before(self, noun: Noun, entry: CatalogueEntry) -> bool:
        """Check if several things are meant again, the first of which is given: "the cans" after "two cans"."""
        return any(
            chosen is entry and other.several and (other.name, other.colour) == (noun.name, noun.colour)
            and noun.count in (None, other.count) and not (noun.but or other.but or noun.relations or other.relations)
            for other, chosen in self._of.items()
        )  # fmt: skip

    def _means_another(self, noun: Noun, entry: CatalogueEntry) -> bool:
        """True where nothing named a chosen object, and a noun names another kind better: "the block" no peg block."""
        unsaid = any(other.at < 0 and chosen is entry for other, chosen in self._of.items())
        return unsaid and any(noun.fit(other)[0] > noun.fit(entry)[0] for other in self.entries.values())

    def _kinds(self, noun: Noun) -> list[tuple[CatalogueEntry, list[Variant]]]:
        """The kinds that a noun means, with the matching looks."""
        return [(self.entries[name], looks) for name, looks in noun.named(self.entries).items()]

    def _draw(self, noun: Noun, role: Role, good: Good, place: CatalogueEntry | None) -> CatalogueEntry:
        """Choose objects for a noun; the first of its kinds."""
        _require_no_pronoun(noun)
        taken = [(entry.name, entry.variants) for entry in self._there]
        told_apart = noun.positions(self._nouns)
        count = self._count(noun, told_apart)
        # "move the blocks, and stack the red on the blue one"
        told = self._told_by_colour(noun) if count is None else []
        looks = self._meant(noun, told, one_of_each(self._able(noun, good, place, count), self.rng))
        fresh = [(entry, look) for entry, look in looks if (entry.name, [look]) not in taken] or looks
        before = len(self._there)
        for number in range(count or len(told) or self._several(place, fresh)):
            entry, look = fresh[number % len(fresh)]
            asked: Role = role if noun.position is None or number < len(told_apart) else "context"
            reason = f"asked for: {noun.text!r}"
            self._chosen.append(SelectedAsset(asset=entry.name, variant=look.id, role=asked, reason=reason))
            self._there.append(with_look(entry, look))
        return self._there[before]

    def _several(self, place: CatalogueEntry | None, looks: Sequence[Look]) -> int:
        """The number of objects that are chosen where no number is said."""
        return self._occasion().several(place if self._side_by_side else None, [entry for entry, _ in looks])

    def _meant(self, noun: Noun, told: Sequence[Noun], looks: Sequence[Look]) -> Sequence[Look]:
        """The looks of the colours that tell several things apart; of others those that can be seen in vessels."""
        if told:
            return [look for look in looks if any(one.fit(with_look(*look))[0] for one in told)]
        return looks if noun.colour else self._visible_in_vessels(looks)

    def _visible_in_vessels(self, looks: Sequence[Look]) -> Sequence[Look]:
        """Leave out balls in the colour of a vessel that is there, or vessels in that of a ball, if others are left."""
        balls, vessels = (
            {word for entry in self._there if test(entry) for look in entry.variants for word in look.colour.split()}
            for test in (lambda e: e.loose, lambda e: e.holds_loose)
        )

        def hidden(entry: CatalogueEntry, look: Variant) -> bool:
            others = vessels if entry.loose else balls if entry.holds_loose else ()
            return not set(look.colour.split()).isdisjoint(others)

        return [look for look in looks if not hidden(*look)] or looks

    def _told_by_colour(self, noun: Noun) -> list[Noun]:
        """The nouns for one thing each that name all of several things by their colours; none where there is one."""
        alike = [one for one in self._nouns if one.name == noun.name and one.colour and not one.several]
        told = list({one.colour: one for one in alike}.values())
        return told if noun.definite and noun.colour is None and len(told) > 1 else []

    def _count(self, noun: Noun, told_apart: Sequence[str]) -> int | None:
        """The number that a noun asks for; None if it says only "several"."""
        if noun.position is not None and noun.part is None:
            return 3 if "middle" in told_apart else max(2, len(told_apart))
        return noun.number if noun.part is None else noun.count or 1

    def _able(
        self, noun: Noun, good: Good, place: CatalogueEntry | None, count: int | None
    ) -> list[tuple[CatalogueEntry, list[Variant]]]:
        """The kinds to draw from: the plainest, or, for several objects, all suitable ones."""
        kinds = noun.named(self.entries)
        able = [entry for entry, _ in self._kinds(noun) if good(entry)] or [self.entries[name] for name in kinds]
        if not able:
            self._refuse(noun)
        able = [entry for entry in able if not self._answers_another(noun, entry)] or able
        able = self._occasion().suiting(able, place, noun.several, least=min(2, count or 2))
        able = [able[i] for i in self.rng.permutation(len(able))] if noun.several else able[:1]
        return [(entry, kinds[entry.name]) for entry in able]

    def _refuse(self, noun: Noun) -> NoReturn:
        """Refuse a noun that no kind is called by.

        Raises:
            NoAssetFits: says why: for its part, its size, its look or its name.
            Doubt: it names no kind.
        """
        require_part(noun, self.entries)
        require_size(noun, self.entries)
        bare = [entry for entry, _ in self._kinds(replace(noun, colour=None))]
        bare = bare or kinds_by_head(noun, self.entries)
        error = no_asset(noun.text, bare, list(self.entries.values()), best_search())
        error.hint = "; ".join(filter(None, (to_leave_out(noun, self.entries), error.hint)))
        raise error

    def _answers_another(self, noun: Noun, entry: CatalogueEntry) -> bool:
        """True for a kind that people call by another noun too: a paper clip box is stationery, and "the box"."""
        others = (other for other in self._nouns if other.words and other.name != noun.name)
        return any(other.fit(entry)[0] >= HEAD for other in others)


def _require_no_pronoun(noun: Noun) -> None:
    """Refuse "its lid" where no chosen thing has such a part.

    Raises:
        Doubt: the owner is only named by a pronoun.
    """
    if noun.part is not None and noun.text.lower().startswith("its "):
        raise Doubt(noun.text, "nothing named before it has one")
