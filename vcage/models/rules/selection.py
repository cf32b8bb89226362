"""Chooses assets for an instruction by how alike its noun phrases and the catalogue's words are."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vcage.base.errors import NoAssetFits
from vcage.base.words import ANYTHING, tokens
from vcage.models.rules.catalogue_match import (
    MIN_SCORE,
    Occasion,
    Places,
    candidates,
    goes_in,
    scene_tags,
    score_entry,
    things_meant,
    variants_of,
)
from vcage.models.rules.instruction import Request, parse_instruction
from vcage.models.rules.naming import words_of
from vcage.models.rules.phrases import SEVERAL, Phrase
from vcage.models.rules.refusals import require_answers, require_counts
from vcage.models.search import Search, best_search
from vcage.objects.names import confusable
from vcage.schema.asset import CatalogueEntry, Variant
from vcage.schema.plan import SelectedAsset, Selection
from vcage.schema.scene import Role

CONTEXT_OBJECTS = 2
CONTEXT_FOOTPRINT = 0.03
"""Largest footprint of an object that is there for the occasion only, m²."""

UNNAMED_CONTENTS = 2
"""How many things are in a place that is emptied."""

TOOLS = {"scan": "barcode scanner", "weigh": "electronic scale"}
"""What it takes to do so."""

SHARE_OF_PLACE = 0.2
"""Largest share of a place's outer rectangle that one of several things in it at the start takes."""


def select_assets(
    instruction: str,
    catalogue: Sequence[CatalogueEntry],
    rng: np.random.Generator,
    search: Callable[[], Search] = best_search,
) -> Selection:
    """Contents, then receptacles, then what contents start in, tools, and objects for the occasion.

    Args:
        search: makes the search by meaning that suggests names for a phrase that nothing answers.

    Raises:
        NoAssetFits: a phrase of the instruction matches nothing; names it and the nearest names.
        InfeasibleScene: it asks for none of a thing, or for more than any table holds.
    """
    catalogue = sorted(catalogue, key=lambda entry: entry.name)
    requests = parse_instruction(instruction, words_of(catalogue), lambda phrase: _holds_things(phrase, catalogue))
    require_answers(instruction, requests, catalogue, search)
    require_counts(instruction, requests)
    return _Selector(instruction, requests, catalogue, rng).select()


@dataclass(frozen=True)
class _Start:
    """Where a thing is at the start: in the instruction's words, and what of the catalogue that is, if any."""

    place: str
    source: CatalogueEntry | None

    def trouble(self, kinds: Sequence[CatalogueEntry]) -> str:
        """Why things of these kinds cannot lie there; "" when they can."""
        if self.source is None:
            return f"nothing called {self.place!r} holds things"
        if self.source.functional_points[0].link is not None:
            return f"the {self.source.words.name} is closed then"
        large = [kind.words.name for kind in kinds if not goes_in(kind, self.source)]
        return f"the {self.source.words.name} is too small for the {' and the '.join(large)}" if large else ""


def _holds_things(phrase: Phrase, catalogue: Sequence[CatalogueEntry]) -> bool:
    """Whether what a phrase most likely means is a place too."""
    found = candidates(phrase, catalogue) if phrase.lemmas else []
    return bool(found) and bool(found[0].entry.functional_points)


def moved_things(requests: Sequence[Request]) -> list[tuple[Phrase, Request]]:
    """Every phrase for things that something is done to, with the request that says where it goes, if one does.

    'the mug' after 'the red mug' is that mug, and no other one.
    """
    found: dict[Phrase, Request] = {}
    named: list[Phrase] = []
    for request in requests:
        places = [request.place] if request.place is not None else []
        for phrase in request.things if request.asked != "leave" else ():
            same = [other for other in named if other.head == phrase.head and other != phrase]
            if (
                same
                and phrase.quantity == "the"
                and phrase.colour is None
                and len(phrase.lemmas) == 1
                and not phrase.plural
            ):
                continue
            goes = request.asked == "put" and request.place is not None
            if phrase not in found or (goes and found[phrase].asked != "put"):
                found[phrase] = request
        named += [*request.things, *places]
    return list(found.items())


class _Selector:
    """The choice among what answers an instruction; every random draw is in here."""

    def __init__(
        self,
        instruction: str,
        requests: Sequence[Request],
        catalogue: Sequence[CatalogueEntry],
        rng: np.random.Generator,
    ):
        self.instruction = instruction
        self.requests = requests
        self.catalogue = catalogue
        self.rng = rng
        self._entries = {entry.name: entry for entry in catalogue}
        self._places = Places(catalogue)

    def select(self) -> Selection:
        chosen: list[SelectedAsset] = []
        notes: list[str] = []
        for phrase, request in moved_things(self.requests):
            contents, note = self._contents(phrase, request)
            chosen += contents
            notes += [note] if note else []
        for choose in (self._receptacles, self._sources, self._tools, self._left_alone, self._context):
            chosen += choose(chosen)
        return Selection(objects=chosen, notes=list(dict.fromkeys(notes)))

    def _contents(self, phrase: Phrase, request: Request) -> tuple[list[SelectedAsset], str]:
        """What a phrase for moved things means, and why it does not start where the instruction says; or ""."""
        kinds = self._kinds(phrase, request)
        start = self._start_of(phrase, request)
        source = None if start is None else start.source
        if source is not None and len(kinds) > 1:
            kinds = _small_enough(kinds, source)
        trouble = "" if start is None else start.trouble(kinds)
        starts_in = None if source is None or trouble else source.name
        looks = self._one_of_each(self._suiting(kinds, request), phrase)
        looks = [look for look in looks if not any(self._answers(look, but, phrase) for but in phrase.but)] or looks
        several = UNNAMED_CONTENTS if source is not None and phrase.head in ANYTHING else SEVERAL
        count = min(several, max(2, len(looks))) if phrase.count is None else phrase.count
        reason = f"asked for: {self._typed(phrase)!r}"
        picked = [_chosen(*looks[i % len(looks)], "content", reason, starts_in) for i in range(count)]
        return picked, f"{self._typed(phrase)!r} starts on the table: {trouble}" if trouble else ""

    def _typed(self, phrase: Phrase) -> str:
        return phrase.as_typed(self.instruction)

    def _kinds(self, phrase: Phrase, request: Request) -> list[CatalogueEntry]:
        """The kinds that a phrase for moved things means; never that of the place where they go."""
        place, named = self._places.of(request, self.catalogue), request.place
        apart = named is not None and named.colour is not None and named.colour != phrase.colour
        taken = [] if place is None or apart else [place.name]
        tags = scene_tags((p for p, _ in moved_things(self.requests)), self.catalogue)
        kinds = things_meant(phrase, self.catalogue, Occasion(self.instruction, tags), taken)
        if not kinds:
            raise NoAssetFits(
                f"{self._typed(phrase)!r} would go to a place that is the same thing: {', '.join(taken)}",
                hint="name another place for it",
                details={"unmatched": [self._typed(phrase)]},
            )
        return kinds

    def _start_of(self, phrase: Phrase, request: Request) -> _Start | None:
        """Where the instruction says that a thing is at the start; None where it does not."""
        place = dict(request.sources).get(phrase)
        if place is None:
            return None
        found = self._places.of(replace(request, things=(phrase,), place=place), self.catalogue)
        return _Start(self._typed(place), found if found is not None and found.functional_points else None)

    def _receptacles(self, chosen: Sequence[SelectedAsset]) -> list[SelectedAsset]:
        """The places where things go, but for what is chosen already."""
        found: list[SelectedAsset] = []
        for request in self.requests:
            entry, phrase = self._places.of(request, self.catalogue), request.place
            if entry is None or phrase is None or phrase in request.things:
                continue
            looks = [variant.id for variant in variants_of(entry, phrase)]
            if all(c.asset != entry.name or c.variant not in looks for c in (*chosen, *found)):
                variant = self._any_of(variants_of(entry, phrase))
                found.append(_chosen(entry, variant, "receptacle", f"the place: {self._typed(phrase)!r}"))
        return found

    def _sources(self, chosen: Sequence[SelectedAsset]) -> list[SelectedAsset]:
        """What contents start in; nothing goes into it, so it is context, unless it is a receptacle too."""
        phrases = {
            start.source.name: place
            for request in self.requests
            for phrase, place in request.sources
            if (start := self._start_of(phrase, request)) is not None and start.source is not None
        }
        found = []
        for name, place in phrases.items():
            entry = self._entries[name]
            if _is_new(entry, chosen):
                variant = self._any_of(variants_of(entry, place))
                found.append(
                    _chosen(entry, variant, "context", f"where things are at the start: {self._typed(place)!r}")
                )
        return found

    def _tools(self, chosen: Sequence[SelectedAsset]) -> list[SelectedAsset]:
        """What the instruction works with, named or not: nothing is scanned without a scanner."""
        found: list[SelectedAsset] = []
        named = [phrase for request in self.requests for phrase in request.tools]
        implied = [Phrase(TOOLS[r.asked], tuple(TOOLS[r.asked].split())) for r in self.requests if r.asked in TOOLS]
        for phrase in (*named, *implied):
            entry = Occasion(self.instruction, ()).best(candidates(phrase, self.catalogue)).entry
            if _is_new(entry, (*chosen, *found)):
                found.append(_chosen(*self._looks(entry, phrase)[0], "context", f"the tool: {self._typed(phrase)!r}"))
        return found

    def _left_alone(self, chosen: Sequence[SelectedAsset]) -> list[SelectedAsset]:
        """What the instruction names only to leave it where it is: 'all the pens but the red one'."""
        phrases = [p for r in self.requests if r.asked == "leave" and not r.preposition for p in r.things]
        phrases += [
            replace(but, lemmas=phrase.lemmas) if but.lemmas in ((), ("one",)) else but
            for phrase, _ in moved_things(self.requests)
            for but in phrase.but
        ]
        found: list[SelectedAsset] = []
        for phrase in phrases:
            answers = candidates(phrase, self.catalogue)
            entry = Occasion(self.instruction, ()).best(answers).entry if answers else None
            if entry is None or any(c.asset == entry.name and self._is(c, phrase) for c in (*chosen, *found)):
                continue
            for look in self._looks(entry, phrase)[:1]:  # what there is not cannot be left out: the goals are refused
                found.append(_chosen(*look, "context", f"to be left alone: {self._typed(phrase)!r}"))
        return found

    def _answers(self, look: tuple[CatalogueEntry, Variant], but: Phrase, phrase: Phrase) -> bool:
        """Whether a look is one of those that an exception names: 'the red one' of the phrase's own kind."""
        entry, variant = look
        own = but.lemmas in ((), ("one",))
        named = own or any(c.entry.name == entry.name for c in candidates(but, self.catalogue)[:1])
        return named and variant in variants_of(entry, but)

    def _is(self, chosen: SelectedAsset, phrase: Phrase) -> bool:
        """Whether a chosen object has the colour that a phrase names."""
        return any(v.id == chosen.variant for v in variants_of(self._entries[chosen.asset], phrase))

    def _context(self, chosen: Sequence[SelectedAsset]) -> list[SelectedAsset]:
        """Small objects from where the contents belong, which cannot be taken for what the instruction names."""
        entries = [self._entries[s.asset] for s in chosen]
        tags = {
            tag
            for s, entry in zip(chosen, entries, strict=True)
            if s.role == "content"
            for tag in entry.words.scene_tags
        }
        named = self._named()
        small = [e for e in self.catalogue if e.size[0] * e.size[1] <= CONTEXT_FOOTPRINT]
        fitting = [e for e in small if tags & set(e.words.scene_tags) and not _mistakable(e, entries, named)]
        looks = {s.variant for s in chosen}
        found = []
        for entry in (fitting[i] for i in self.rng.permutation(len(fitting))[:CONTEXT_OBJECTS]):
            variant = self._any_of([v for v in entry.variants if v.id not in looks] or entry.variants)
            shared = ", ".join(sorted(tags & set(entry.words.scene_tags)))
            found.append(_chosen(entry, variant, "context", f"belongs to {shared}"))
        return found

    def _named(self) -> list[Phrase]:
        """Every phrase of the instruction."""
        requests = self.requests
        return [
            *(phrase for request in requests for phrase in request.things),
            *(request.place for request in requests if request.place is not None),
            *(place for request in requests for _, place in request.sources),
            *(phrase for request in requests for phrase in request.tools),
        ]

    def _suiting(self, kinds: Sequence[CatalogueEntry], request: Request) -> list[CatalogueEntry]:
        """Those of a kind that are smaller than the place and belong to the scene, as far as there are several."""
        tags: set[str] = set()
        place = self._places.of(request, self.catalogue)
        if place is not None:
            small = [entry for entry in kinds if goes_in(entry, place)]
            kinds = small if len(small) > 1 else kinds
            tags |= self._scene(place)
        for tool in request.tools:
            tags |= set(candidates(tool, self.catalogue)[0].entry.words.scene_tags)
        return Occasion(self.instruction, tags).suiting(kinds)

    def _scene(self, place: CatalogueEntry) -> set[str]:
        """Scene tags of a place; of several only those that the instruction names, where it names one."""
        tags = set(place.words.scene_tags)
        named = {tag for tag in tags if set(tokens(tag)) & set(tokens(self.instruction))}
        return named or tags

    def _any_of(self, variants: Sequence[Variant]) -> Variant:
        return variants[int(self.rng.integers(len(variants)))]

    def _looks(self, entry: CatalogueEntry, phrase: Phrase) -> list[tuple[CatalogueEntry, Variant]]:
        """The variants of one kind in random order, those of a colour not yet seen first."""
        variants = variants_of(entry, phrase)
        shuffled = [variants[i] for i in self.rng.permutation(len(variants))]
        first = {variant.colour: variant.id for variant in reversed(shuffled)}
        return [(entry, v) for v in sorted(shuffled, key=lambda v: first[v.colour] != v.id)]

    def _one_of_each(self, kinds: Sequence[CatalogueEntry], phrase: Phrase) -> list[tuple[CatalogueEntry, Variant]]:
        """Kinds in random order, one variant of each before a second of any."""
        looks = [self._looks(kinds[i], phrase) for i in self.rng.permutation(len(kinds))]
        return [look[k] for k in range(max(map(len, looks))) for look in looks if k < len(look)]


def _chosen(
    entry: CatalogueEntry, variant: Variant, role: Role, reason: str, starts_in: str | None = None
) -> SelectedAsset:
    return SelectedAsset(asset=entry.name, variant=variant.id, role=role, reason=reason, starts_in=starts_in)


def _is_new(entry: CatalogueEntry, chosen: Iterable[SelectedAsset]) -> bool:
    return all(thing.asset != entry.name for thing in chosen)


def _mistakable(entry: CatalogueEntry, others: Sequence[CatalogueEntry], named: Sequence[Phrase]) -> bool:
    """Whether an entry looks like one of the others, or answers one of the phrases."""
    return any(confusable(entry, other) for other in others) or any(
        score_entry(phrase, entry).score >= MIN_SCORE for phrase in named
    )


def _small_enough(kinds: Sequence[CatalogueEntry], source: CatalogueEntry) -> list[CatalogueEntry]:
    """Those of which several go into the place, else the smallest."""
    room = SHARE_OF_PLACE * source.size[0] * source.size[1]
    areas = {kind.name: kind.size[0] * kind.size[1] for kind in kinds}
    small = [kind for kind in kinds if areas[kind.name] <= room and goes_in(kind, source) and kind is not source]
    return small or [min(kinds, key=lambda kind: areas[kind.name])]
