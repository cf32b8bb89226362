"""Nouns that the catalogue has no object for: a kind lacks the part, or does not come in the size or the look."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from vcage.base.errors import NoAssetFits
from vcage.base.text import listed
from vcage.base.words import COUNTED, NUMBERS, SIZES, lemma, tokens
from vcage.models.rules.nouns import Doubt, Noun
from vcage.objects.names import HEAD, look_texts, names_of, sizes_of
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import part_words


def require_part(noun: Noun, entries: Mapping[str, CatalogueEntry]) -> None:
    """Require that the owner of a part, where it names a kind, has that part.

    Raises:
        NoAssetFits: it has none of that name; the hint lists those it has.
    """
    owners = [] if noun.owner is noun else [e for e in entries.values() if noun.owner.fit(e)[0] >= HEAD]
    if owners and not any(noun.names_part(part) for entry in owners for part in entry.parts):
        parts = {e.words.name: listed([f"the {part_words(p)}" for p in e.parts]) or "no parts" for e in owners}
        has = "; ".join(f"the {name} has {parts}" for name, parts in list(parts.items())[:3])
        raise NoAssetFits(
            f"there is no {noun.text.removeprefix('the ')!r}", hint=has, details={"unmatched": [noun.text]}
        )


def require_size(noun: Noun, entries: Mapping[str, CatalogueEntry]) -> None:
    """Require that a kind that is named with a size comes in it.

    Raises:
        NoAssetFits: it does not; the hint lists the sizes that there are.
        Doubt: no kind is named.
    """
    if noun.headless and (noun.size or noun.lies):
        raise Doubt(noun.text, "nothing before it says which of several things is meant; name the thing")
    plain = replace(noun, size=None)
    if noun.size is None or not (kinds := [entries[name] for name in plain.named(entries)]):
        return
    found = [size for entry in entries.values() for size in sizes_of(entry, noun.words)]
    sizes = listed(sorted({*found}, key=list(SIZES).index))
    name = " ".join(noun.words) or kinds[0].words.name
    hint = f"sizes of the {name}: {sizes}" if sizes else f"the {name} comes in one size: leave the size out"
    raise NoAssetFits(f"there is no {noun.text.removeprefix('the ')!r}", hint=hint, details={"unmatched": [noun.text]})


def kinds_by_head(noun: Noun, entries: Mapping[str, CatalogueEntry]) -> list[CatalogueEntry]:
    """The kinds of a noun's last word, where no name has the words before it: "the rotten apple"."""
    named = [entry for entry in entries.values() if names_of(entry).words == noun.words[-1:]]
    return named if len(_unknown(noun, entries)) == len(noun.words[:-1]) else []


def to_leave_out(noun: Noun, entries: Mapping[str, CatalogueEntry]) -> str:
    """Say which words of a noun are unknown, where it names something without them; else empty."""
    unknown = _unknown(noun, entries)
    rest = tuple(word for word in noun.words if word not in unknown)
    if not unknown or not replace(noun, words=rest, colour=None, but=()).named(entries):
        return ""
    words = listed(list(map(repr, unknown)))
    return f"{words} {'is' if len(unknown) == 1 else 'are'} not known, and may be left out"


def _unknown(noun: Noun, entries: Mapping[str, CatalogueEntry]) -> list[str]:
    """The words before a noun's last one that are in no name and no look of a kind."""
    kinds = entries.values()
    known = {word for entry in kinds for name in names_of(entry).all for word in name}
    known |= {lemma(word) for entry in kinds for text in look_texts(entry) for word in tokens(text)}
    return [word for word in noun.words[:-1] if word not in known | {*NUMBERS, *COUNTED, "wooden", "of"}]
