"""Chooses assets for an instruction by how alike its noun phrases and the catalogue's words are."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from vcage.base.errors import InfeasibleScene, NoAssetFits
from vcage.models.rules.instruction import Request, parse_instruction
from vcage.models.rules.matching import (
    MIN_SCORE,
    Candidate,
    Occasion,
    Places,
    candidates,
    confusable,
    goes_in,
    places,
    scene_tags,
    score_entry,
    things_meant,
    variants_of,
)
from vcage.models.rules.phrases import SEVERAL, Phrase
from vcage.models.rules.words import ANYTHING, tokens
from vcage.models.search import Search, best_search
from vcage.schema.asset import CatalogueEntry, Variant
from vcage.schema.plan import SelectedAsset, Selection

MOST_OBJECTS = 40
"""Things that one phrase may ask for; no table holds more."""

CONTEXT_OBJECTS = 2
CONTEXT_FOOTPRINT = 0.03
"""Largest footprint of an object that is there for the occasion only, m²."""

SUGGESTIONS = 3
"""Names that a complaint suggests for a phrase that nothing answers."""

UNNAMED_CONTENTS = 2
"""How many things are in a place that is emptied."""

SHARE_OF_PLACE = 0.2
"""Largest share of a place's outer rectangle that one of several things in it at the start takes."""


class Selector:
    """One selection: an instruction against a catalogue.

    Args:
        search: makes the search by meaning that suggests names for a phrase that nothing answers.
    """

    def __init__(
        self,
        instruction: str,
        catalogue: Sequence[CatalogueEntry],
        rng: np.random.Generator,
        search: Callable[[], Search] = best_search,
    ):
        self.instruction = instruction
        self.catalogue = sorted(catalogue, key=lambda entry: entry.name)
        self.rng = rng
        self.requests = parse_instruction(instruction)
        self._search = search
        self._places = Places(self.catalogue)
        self._notes: list[str] = []

    def select(self) -> Selection:
        """Contents, then receptacles, then tools and objects for the occasion.

        Raises:
            NoAssetFits: a phrase of the instruction matches nothing; names it and the nearest names.
            InfeasibleScene: it asks for none of a thing, or for more than any table holds.
        """
        self._notes = []
        self._require_matches()
        self._require_counts()
        places_named = [request.receptacle for request in self.requests if request.receptacle is not None]
        contents = [p for request in self.requests for p in request.contents]
        tools = [p for request in self.requests for p in request.tools]
        chosen: list[SelectedAsset] = []
        for request in self.requests:
            taken = {c.entry.name for c in self._receptacle_of(request)}
            for phrase in request.contents:
                chosen += self._contents(phrase, request, taken)
        for request in self.requests:
            for candidate in self._receptacle_of(request):
                if all(s.asset != candidate.entry.name for s in chosen):
                    chosen.append(self._receptacle(request.receptacle, candidate))
        chosen += self._sources(chosen)
        chosen += self._tools(tools, chosen)
        sources = [place for request in self.requests for _, place in request.sources]
        chosen += self._context([*contents, *places_named, *sources, *tools], chosen)
        return Selection(objects=chosen, notes=list(dict.fromkeys(self._notes)))

    def _receptacle_of(self, request: Request) -> list[Candidate]:
        """The receptacle of a clause, as a list of one or none."""
        found = self._places.of(request, self.catalogue)
        return [] if found is None else [found]

    def _receptacle(self, phrase: Phrase, candidate: Candidate) -> SelectedAsset:
        variants = variants_of(candidate.entry, phrase)
        variant = variants[int(self.rng.integers(len(variants)))]
        return SelectedAsset(
            asset=candidate.entry.name, variant=variant.id, role="receptacle", reason=f"the place: {phrase.text!r}"
        )

    def _contents(self, phrase: Phrase, request: Request, taken: set[str]) -> list[SelectedAsset]:
        tags = scene_tags((p for r in self.requests for p in r.contents), self.catalogue)
        kinds = things_meant(phrase, self.catalogue, Occasion(self.instruction, tags), taken)
        if not kinds:
            raise NoAssetFits(
                f"{phrase.text!r} would go to a place that is the same thing: {', '.join(sorted(taken))}",
                hint="name another place for it",
                details={"unmatched": [phrase.text]},
            )
        source = self._source_of(phrase, request)
        if source is not None and len(kinds) > 1:
            kinds = self._small_enough(kinds, source)
        starts_in = None
        if source is not None:
            trouble = _no_start(kinds, source)
            starts_in = None if trouble else source.name
            self._notes += [f"{phrase.text!r} starts on the table: {trouble}"] if trouble else []
        if len(kinds) > 1:
            looks = self._one_of_each(self._suiting(kinds, request), phrase)
        else:
            looks = self._looks(kinds[0], phrase)
        several = UNNAMED_CONTENTS if source is not None and phrase.head in ANYTHING else SEVERAL
        count = min(several, max(2, len(looks))) if phrase.count is None else phrase.count
        picked = [looks[i % len(looks)] for i in range(count)]
        return [
            SelectedAsset(
                asset=entry.name,
                variant=variant.id,
                role="content",
                reason=f"asked for: {phrase.text!r}",
                starts_in=starts_in,
            )
            for entry, variant in picked
        ]

    def _source_of(self, phrase: Phrase, request: Request) -> CatalogueEntry | None:
        """What a thing is in or on at the start, where the instruction says so and the catalogue has it."""
        place = dict(request.sources).get(phrase)
        if place is None:
            return None
        found = self._places.of(replace(request, contents=(phrase,), again=(), receptacle=place), self.catalogue)
        if found is None or not found.entry.functional_points:
            self._notes.append(f"{phrase.text!r} starts on the table: nothing called {place.text!r} holds things")
            return None
        return found.entry

    def _small_enough(self, kinds: Sequence[CatalogueEntry], source: CatalogueEntry) -> list[CatalogueEntry]:
        """Those of which several go into the place, else the smallest."""
        room = SHARE_OF_PLACE * source.size[0] * source.size[1]
        areas = {kind.name: kind.size[0] * kind.size[1] for kind in kinds}
        small = [kind for kind in kinds if areas[kind.name] <= room and goes_in(kind, source) and kind is not source]
        return small or [min(kinds, key=lambda kind: areas[kind.name])]

    def _sources(self, chosen: Sequence[SelectedAsset]) -> list[SelectedAsset]:
        """What contents start in; nothing goes into it, so it is context, unless it is a receptacle too."""
        entries = {entry.name: entry for entry in self.catalogue}
        phrases = {
            entry.name: place
            for request in self.requests
            for phrase, place in request.sources
            if (entry := self._source_of(phrase, request)) is not None
        }
        found = []
        for name, place in phrases.items():
            if all(s.asset != name for s in chosen):
                variants = variants_of(entries[name], place)
                variant = variants[int(self.rng.integers(len(variants)))]
                reason = f"where things are at the start: {place.text!r}"
                found.append(SelectedAsset(asset=name, variant=variant.id, role="context", reason=reason))
        return found

    def _suiting(self, kinds: Sequence[CatalogueEntry], request: Request) -> list[CatalogueEntry]:
        """Those of a kind that are smaller than the place and belong to the scene, as far as there are several."""
        tags: set[str] = set()
        for candidate in self._receptacle_of(request):
            small = [entry for entry in kinds if goes_in(entry, candidate.entry)]
            kinds = small if len(small) > 1 else kinds
            tags |= self._scene(candidate.entry)
        for tool in request.tools:
            tags |= set(candidates(tool, self.catalogue)[0].entry.words.scene_tags)
        return Occasion(self.instruction, tags).suiting(kinds)

    def _scene(self, place: CatalogueEntry) -> set[str]:
        """Scene tags of a place; of several only those that the instruction names, where it names one."""
        tags = set(place.words.scene_tags)
        named = {tag for tag in tags if set(tokens(tag)) & set(tokens(self.instruction))}
        return named or tags

    def _looks(self, entry: CatalogueEntry, phrase: Phrase) -> list[tuple[CatalogueEntry, Variant]]:
        """The variants of one kind in random order, those of a colour not yet seen first."""
        variants = variants_of(entry, phrase)
        shuffled = [variants[i] for i in self.rng.permutation(len(variants))]
        seen: set[str] = set()
        first, rest = [], []
        for variant in shuffled:
            (rest if variant.colour in seen else first).append((entry, variant))
            seen.add(variant.colour)
        return first + rest

    def _one_of_each(self, kinds: Sequence[CatalogueEntry], phrase: Phrase) -> list[tuple[CatalogueEntry, Variant]]:
        """Several kinds in random order, one variant of each before a second of any."""
        looks = [self._looks(kinds[i], phrase) for i in self.rng.permutation(len(kinds))]
        return [look[k] for k in range(max(map(len, looks))) for look in looks if k < len(look)]

    def _tools(self, phrases: Sequence[Phrase], chosen: Sequence[SelectedAsset]) -> list[SelectedAsset]:
        """What the instruction works with. No sub-task moves it yet, so it stands by as context."""
        found: list[SelectedAsset] = []
        for phrase in phrases:
            best = Occasion(self.instruction, ()).best(candidates(phrase, self.catalogue))
            if any(s.asset == best.entry.name for s in (*chosen, *found)):
                continue
            entry, variant = self._looks(best.entry, phrase)[0]
            found.append(
                SelectedAsset(asset=entry.name, variant=variant.id, role="context", reason=f"the tool: {phrase.text!r}")
            )
        return found

    def _context(self, phrases: Sequence[Phrase], chosen: Sequence[SelectedAsset]) -> list[SelectedAsset]:
        """Small objects from where the contents belong, which cannot be taken for what the instruction names."""
        by_name = {entry.name: entry for entry in self.catalogue}
        entries = [by_name[s.asset] for s in chosen]
        tags = {tag for s in chosen if s.role == "content" for tag in by_name[s.asset].words.scene_tags}
        fitting = [
            entry
            for entry in self.catalogue
            if tags & set(entry.words.scene_tags)
            and entry.size[0] * entry.size[1] <= CONTEXT_FOOTPRINT
            and not any(confusable(entry, other) for other in entries)
            and all(score_entry(phrase, entry).score < MIN_SCORE for phrase in phrases)
        ]
        picked = [fitting[i] for i in self.rng.permutation(len(fitting))[:CONTEXT_OBJECTS]]
        return [self._context_object(entry, chosen, tags) for entry in picked]

    def _context_object(self, entry: CatalogueEntry, chosen: Sequence[SelectedAsset], tags: set[str]) -> SelectedAsset:
        """One variant of the entry, of a look that no chosen object has where that can be had."""
        looks = {s.variant for s in chosen}
        variants = [v for v in entry.variants if v.id not in looks] or entry.variants
        variant = variants[int(self.rng.integers(len(variants)))]
        shared = ", ".join(sorted(tags & set(entry.words.scene_tags)))
        return SelectedAsset(asset=entry.name, variant=variant.id, role="context", reason=f"belongs to {shared}")

    def _require_matches(self) -> None:
        if not any(request.contents for request in self.requests):
            raise NoAssetFits(
                f"the instruction {self.instruction!r} names nothing to move",
                hint="write it like 'Put the blocks on the plate'",
            )
        missing = []
        for request in self.requests:
            named = [(p, candidates(p, self.catalogue)) for p in (*request.contents, *request.tools)]
            if request.receptacle is not None:
                named.append((request.receptacle, places(request.receptacle, self.catalogue)))
            missing += [p for p, found in named if not any(variants_of(c.entry, p) for c in found)]
        if missing:
            raise self._no_asset(missing)

    def _require_counts(self) -> None:
        for phrase in (p for request in self.requests for p in request.contents):
            if phrase.count is not None and not 0 < phrase.count <= MOST_OBJECTS:
                raise InfeasibleScene(
                    f"the instruction asks for {phrase.count} × {phrase.text!r}",
                    hint=f"ask for 1 to {MOST_OBJECTS} of them",
                )

    def _no_asset(self, phrases: Sequence[Phrase]) -> NoAssetFits:
        search = self._search()
        near = {
            p.text: [entry.words.name for entry, _ in search.search(p.text, self.catalogue, SUGGESTIONS)]
            for p in phrases
        }
        listed = " and ".join(repr(p.text) for p in phrases)
        nearest = "; ".join(f"{text!r}: {', '.join(found)}" for text, found in near.items())
        colours = [
            f"{c.entry.words.name} comes in {', '.join(v.colour for v in c.entry.variants)}"
            for p in phrases
            for c in candidates(p, self.catalogue, MIN_SCORE)[:1]
            if not variants_of(c.entry, p)
        ]
        return NoAssetFits(
            f"no asset of the catalogue matches {listed}",
            hint="; ".join(colours) or f"nearest in meaning: {nearest}; `vcage assets list` shows all",
            details={"unmatched": [p.text for p in phrases], "nearest": near, "words": tokens(self.instruction)},
        )


def _no_start(kinds: Sequence[CatalogueEntry], source: CatalogueEntry) -> str | None:
    """Why things of these kinds cannot lie in or on a place at the start; None when they can."""
    if source.functional_points[0].link is not None:
        return f"the {source.words.name} is closed then"
    large = [kind.words.name for kind in kinds if not goes_in(kind, source)]
    return f"the {source.words.name} is too small for the {' and the '.join(large)}" if large else None
