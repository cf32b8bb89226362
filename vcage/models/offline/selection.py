"""Chooses assets for an instruction by how alike its noun phrases and the catalogue's words are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.errors import InfeasibleScene, NoAssetFits
from vcage.models.offline.instruction import SEVERAL, Phrase, Request, parse_instruction
from vcage.models.offline.words import (
    COLOURS,
    DETERMINERS,
    colour_of,
    kinds_of,
    lemma,
    lemmas,
    name_similarity,
    near_names,
    same_word,
    tokens,
)
from vcage.schema.asset import CatalogueEntry, Variant
from vcage.schema.plan import SelectedAsset, Selection

MIN_SCORE = 0.4
"""Below this a name does not answer a phrase."""

MOST_OBJECTS = 40
"""Things that one phrase may ask for; no table holds more."""

CONTEXT_OBJECTS = 2
CONTEXT_FOOTPRINT = 0.03
"""Largest footprint of an object that is there for the occasion only, m²."""

LOOK_ALIKE = frozenset(("bread", "pastry", "fruit", "vegetable", "cutlery"))
"""Kinds whose members resemble each other."""

_SYNONYM = 0.97
_KIND = 0.8
_AMBIGUITY = 0.12
"""Scores this close are told apart by the occasion: shared scene tags and the other words of the instruction."""


@dataclass(frozen=True)
class Candidate:
    """A catalogue entry that may answer a phrase."""

    entry: CatalogueEntry
    score: float
    kind: bool
    """Whether the phrase names a kind of things (bread, fruit) that this entry is one of."""


def names_of(entry: CatalogueEntry) -> list[list[str]]:
    """Lemmas of everything that an entry is called, its proper name first."""
    words = entry.words
    return [lemmas(text) for text in (words.name, words.plural, entry.name, *words.synonyms)]


def score_entry(phrase: Phrase, entry: CatalogueEntry) -> Candidate:
    """How well an entry answers a phrase, by its names, its synonyms, and the kind of thing it is."""
    names = names_of(entry)
    score = max(
        name_similarity(phrase.lemmas, name) * (1.0 if index < 3 else _SYNONYM) for index, name in enumerate(names)
    )
    own = names[0]
    category = lemma(entry.words.category.lower())
    kind = (
        len(phrase.lemmas) == 1
        and not same_word(own[-1], phrase.head)
        and (
            phrase.head in kinds_of(own[-1])
            or phrase.head == category
            or any(name == [phrase.head] for name in names[3:])
        )
    )
    return Candidate(entry, max(score, _KIND) if kind else score, kind)


def candidates(phrase: Phrase, catalogue: Sequence[CatalogueEntry]) -> list[Candidate]:
    """The entries that answer a phrase, best first; ties keep the order of their names."""
    scored = [score_entry(phrase, entry) for entry in catalogue]
    return sorted((c for c in scored if c.score >= MIN_SCORE), key=lambda c: (-c.score, c.entry.name))


def _variants(entry: CatalogueEntry, phrase: Phrase) -> list[Variant]:
    if phrase.colour is None:
        return list(entry.variants)
    return [v for v in entry.variants if phrase.colour in (colour_of(v.colour), colour_of(v.id))]


def _confusable(entry: CatalogueEntry, other: CatalogueEntry) -> bool:
    """Whether the two are called alike or are foods of one kind, which look alike."""
    a, b = names_of(entry)[0][-1], names_of(other)[0][-1]
    return a == b or bool(kinds_of(a) & kinds_of(b) & LOOK_ALIKE)


class _Occasion:
    """What the rest of the instruction says: breaks ties between entries of nearly equal score."""

    def __init__(self, instruction: str, tags: Sequence[str]):
        self.words = [w for w in lemmas(instruction) if len(w) > 3 and w not in DETERMINERS | COLOURS]
        self.tags = frozenset(tags)

    def fit(self, entry: CatalogueEntry) -> float:
        """Larger for entries whose words and scene tags go with the instruction."""
        names = {word for name in names_of(entry) for word in name}
        named = sum(any(n.startswith(w) or w.startswith(n) for n in names if len(n) > 3) for w in self.words)
        described = sum(word in lemmas(entry.words.description) for word in self.words)
        return named + 0.25 * described + 0.5 * len(self.tags & set(entry.words.scene_tags))

    def best(self, found: Sequence[Candidate]) -> Candidate:
        close = [c for c in found if c.score >= found[0].score - _AMBIGUITY]
        return max(close, key=lambda c: (round(self.fit(c.entry), 6), c.score, -found.index(c)))


class Selector:
    """One selection: an instruction against a catalogue."""

    def __init__(self, instruction: str, catalogue: Sequence[CatalogueEntry], rng: np.random.Generator):
        self.instruction = instruction
        self.catalogue = sorted(catalogue, key=lambda entry: entry.name)
        self.rng = rng
        self.requests = parse_instruction(instruction)

    def select(self) -> Selection:
        """Contents, then receptacles, then objects for the occasion.

        Raises:
            NoAssetFits: a phrase of the instruction matches nothing; names it and the nearest names.
            InfeasibleScene: it asks for none of a thing, or for more than any table holds.
        """
        self._require_matches()
        self._require_counts()
        contents = [p for request in self.requests for p in request.contents]
        places = [request.receptacle for request in self.requests if request.receptacle is not None]
        chosen: list[SelectedAsset] = []
        for request in self.requests:
            taken = {c.entry.name for c in self._receptacle_of(request)}
            for phrase in request.contents:
                chosen += self._contents(phrase, _Occasion(self.instruction, self._tags(contents)), taken)
        for request in self.requests:
            for candidate in self._receptacle_of(request):
                if all(s.asset != candidate.entry.name for s in chosen):
                    chosen.append(self._receptacle(request.receptacle, candidate))
        return Selection(objects=chosen + self._context(contents + places, chosen))

    def _receptacle_of(self, request: Request) -> list[Candidate]:
        """The receptacle of a clause, as a list of one or none: entries that can hold things come first."""
        if request.receptacle is None:
            return []
        found = candidates(request.receptacle, self.catalogue)
        holding = [c for c in found if c.entry.functional_points]
        words = " ".join([request.verb, *(p.text for p in request.contents), request.receptacle.text])
        return [_Occasion(words, self._tags(request.contents)).best(holding or found)]

    def _receptacle(self, phrase: Phrase, candidate: Candidate) -> SelectedAsset:
        variants = _variants(candidate.entry, phrase)
        variant = variants[int(self.rng.integers(len(variants)))]
        return SelectedAsset(
            asset=candidate.entry.name, variant=variant.id, role="receptacle", reason=f"the place: {phrase.text!r}"
        )

    def _contents(self, phrase: Phrase, occasion: _Occasion, taken: set[str]) -> list[SelectedAsset]:
        found = [c for c in candidates(phrase, self.catalogue) if c.entry.name not in taken]
        found = [c for c in found if _variants(c.entry, phrase)]
        if not found:
            raise NoAssetFits(
                f"{phrase.text!r} would go to a place that is the same thing: {', '.join(sorted(taken))}",
                hint="name another place for it",
                details={"unmatched": [phrase.text]},
            )
        best = occasion.best(found)
        kinds = [c.entry for c in found if c.kind or c.entry is best.entry]
        several = phrase.count is None or phrase.count > 1
        if several and any(c.kind for c in found) and len(kinds) > 1:
            looks = self._one_of_each(kinds, phrase)
        else:
            looks = self._looks(best.entry, phrase)
        count = min(SEVERAL, max(2, len(looks))) if phrase.count is None else phrase.count
        picked = [looks[i % len(looks)] for i in range(count)]
        return [
            SelectedAsset(asset=entry.name, variant=variant.id, role="content", reason=f"asked for: {phrase.text!r}")
            for entry, variant in picked
        ]

    def _looks(self, entry: CatalogueEntry, phrase: Phrase) -> list[tuple[CatalogueEntry, Variant]]:
        """The variants of one kind in random order, those of a colour not yet seen first."""
        variants = _variants(entry, phrase)
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

    def _tags(self, phrases: Sequence[Phrase]) -> list[str]:
        """Scene tags of what the contents most likely are."""
        tags: set[str] = set()
        for phrase in phrases:
            found = candidates(phrase, self.catalogue)
            tags.update(*(c.entry.words.scene_tags for c in found if c.score == found[0].score))
        return sorted(tags)

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
            and not any(_confusable(entry, other) for other in entries)
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
        phrases = [p for r in self.requests for p in (*r.contents, *([r.receptacle] if r.receptacle else []))]
        missing = [p for p in phrases if not any(_variants(c.entry, p) for c in candidates(p, self.catalogue))]
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
        names = {entry.words.name for entry in self.catalogue}
        near = {p.text: near_names(" ".join(p.lemmas), names) for p in phrases}
        listed = " and ".join(repr(p.text) for p in phrases)
        nearest = "; ".join(f"{text!r}: {', '.join(found)}" for text, found in near.items())
        colours = [
            f"{c.entry.words.name} comes in {', '.join(v.colour for v in c.entry.variants)}"
            for p in phrases
            for c in candidates(p, self.catalogue)[:1]
        ]
        return NoAssetFits(
            f"no asset of the catalogue matches {listed}",
            hint="; ".join(colours) or f"nearest names: {nearest}; `vcage assets list` shows all",
            details={"unmatched": [p.text for p in phrases], "nearest": near, "words": tokens(self.instruction)},
        )
