"""The objects that a noun may mean, and the check that the instruction identifies them."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from vcage.base.text import listed
from vcage.base.words import HANDLING, tokens
from vcage.models.checked_reading import CheckedReading
from vcage.objects.mentions import Noun
from vcage.objects.names import has_colour, names_of
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import Description
from vcage.schema.plan import TABLE

_LEFT_RIGHT = "left right leftmost rightmost between middle row"
_FRONT_BACK = "front back behind rear near nearer nearest far farther farthest furthest closer closest between middle"
_NEXT_TO = "beside next near nearby by close closest alongside adjacent with at against"
_WORDS_FOR: Mapping[str, frozenset[str]] = {
    relation: frozenset(words.split())
    for relation, words in {
        "left_of": _LEFT_RIGHT,
        "right_of": _LEFT_RIGHT,
        "in_front_of": _FRONT_BACK,
        "behind": _FRONT_BACK,
        "beside": _NEXT_TO,
        "near": _NEXT_TO,
        "center": "middle center centre central",
        "inside": "in inside into out from within of contains holding",
        "on": "on off from top upon onto",
    }.items()
}
"""Relations of descriptions → words for them."""
_BEFORE_BARE_NOUN = frozenset(("the", "my", "your", "our", ",", ".", ":", *HANDLING))
"""Words after which a noun stands alone, with nothing that distinguishes it."""
_MODIFIERS = frozenset(
    ("of", "with", "that", "that's", "which", "which's", "whose", "you", "i", "we", "labelled", "marked", "called")
)
"""Words after a noun that may distinguish it from others."""


def meant(noun: Noun, things: Mapping[str, CatalogueEntry], names: Iterable[str | None]) -> list[str]:
    """The names of objects that a noun may mean, its colours aside."""
    return [name for name in names if name in things and noun.may_mean(things[name])]


def coloured(noun: Noun, things: Mapping[str, CatalogueEntry]) -> list[str]:
    """The objects that a noun may mean, by its colours too."""
    return [n for n in meant(noun, things, things) if all(has_colour(things[n], colour) for colour in noun.colours)]


def unclear(read: CheckedReading) -> Iterator[str]:
    """Complaints about objects of goals that "the mug" means like another one of their kind, with nothing to tell them
    apart."""
    first = {noun.name: noun for noun in reversed(read.said)}.values()
    bare = [n for n in first if _is_bare(n, read.task.whole.split(" ")) and not _is_told_apart(n, read.said)]
    alike = {noun.words: _alike(noun, read.things, read.reading.in_goals) for noun in bare}
    for words, names in alike.items():
        if len(names) > 1 and not any(_tells(one, names, read) for one in read.reading.descriptions):
            yield f"nobody can tell which of {listed(names)} is meant by {words!r}"


def _alike(noun: Noun, things: Mapping[str, CatalogueEntry], used: Collection[str | None]) -> list[str]:
    """The objects with the name of a noun, of kinds in use."""
    named = [name for name in meant(noun, things, things) if noun.name in names_of(things[name]).all]
    kinds = {things[name].name for name in named if name in used}
    return [name for name in named if things[name].name in kinds]


def _is_told_apart(noun: Noun, said: Sequence[Noun]) -> bool:
    """Check if the instruction says more of the same name elsewhere: "the red mug"."""
    return any(other.name in (noun.name, ()) and other.words != noun.words for other in said)


def _is_bare(noun: Noun, words: Sequence[str]) -> bool:
    """Check if a noun is for one thing and says nothing else of it: "the mug"."""
    return (
        not noun.is_several
        and noun.number is None
        and " ".join(noun.name) == noun.words
        and (not noun.at or words[noun.at - 1] in _BEFORE_BARE_NOUN)
        and (*words, "")[noun.end] not in _MODIFIERS
    )


def _tells(described: Description, alike: Collection[str], read: CheckedReading) -> bool:
    """Check if a description tells one of some objects from the others by words that say so."""
    about = {described.subject, described.reference} & {*alike}
    if not about or _WORDS_FOR[described.relation].isdisjoint(tokens(described.words)):
        return False
    others = {described.subject, described.reference} - about - {TABLE}
    return all(any(noun.name and noun.may_mean(read.things[name]) for noun in read.said) for name in others)
