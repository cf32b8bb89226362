"""Find the objects of a scene that a sentence names: by names, synonyms, kinds, colours, sides and counts.

It checks names and reads no grammar. Where a word may mean several objects, the mention has them all.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

from vcage.base.words import ANYTHING, CATEGORIES, COLOURS, KINDS, NUMBERS, SIDES, is_plural, lemma, look_words, tokens
from vcage.objects.mentions import NOT_NAMES, is_verb, lemmas_of, longest_name, stated_count
from vcage.objects.names import Name, is_of_kind, names_of
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import Description

_SIDE_OF = {"left_of": "left", "right_of": "right", "in_front_of": "front", "behind": "back", "center": "middle"}
_INVERSE = {"left_of": "right_of", "right_of": "left_of", "in_front_of": "behind", "behind": "in_front_of"}
_BEFORE = frozenset((*COLOURS, *SIDES, *NUMBERS, "light", "dark", "pale", "bright")) - {"a", "an", "some", "no"}
"""Words that may stand between an article and a name."""
_WHERE = frozenset(
    ("in", "inside", "on", "from", "out", "of", "which", "that", "is", "lies", "lying", "the", "a", "an")
)


@dataclass(frozen=True)
class Mention:
    """Words of a sentence that name objects.

    Args:
        start, end: of the words among the tokens, with the colours, sides and numbers before them.
        words: themselves.
        ids: all objects it may mean; none where colour or side exclude those of the name.
        plural: whether several are meant.
        count: how many the sentence says, None where it does not say.
    """

    start: int
    end: int
    words: str
    ids: frozenset[str]
    plural: bool = False
    count: int | None = None


class SceneNames:
    """Names of the objects of a scene.

    Args:
        things: the catalogue's entries by object id, each with the object's own look only.
        phrases: the scene's name of each object, by id.
        descriptions: of where objects stand, which tell one from its likes.
        lying: object id → id of its container or support.
    """

    def __init__(
        self,
        things: Mapping[str, CatalogueEntry],
        phrases: Mapping[str, str],
        descriptions: Sequence[Description] = (),
        lying: Mapping[str, str] | None = None,
    ):
        self._things, self._phrases, self._lying = things, phrases, lying or {}
        self._descriptions = descriptions
        self._placed = _closure(descriptions)
        spelled = [name for entry in things.values() for name in (entry.words.name, *entry.words.synonyms)]
        self._singular = {tuple(tokens(name)) for name in (*spelled, *phrases.values())}
        self._in_full = _gathered((lemmas_of(tokens(phrases[name])), name) for name in things)
        self._names = _gathered((called, name) for name, entry in things.items() for called in _called(entry))
        self._names |= self._in_full

    def mentions(self, sentence: str) -> list[Mention]:
        """Find the mentions of objects in a sentence, in its order; of overlapping names the longest."""
        said = words_of(sentence)
        found, at = list[Mention](), 0
        while at < len(said):
            mention = self._mention(said, at, found[-1].end if found else 0)
            if mention is not None:
                found.append(mention)
            at = mention.end if mention else at + 1
        return [self._contents_of(said, m, found[n + 1]) if n + 1 < len(found) else m for n, m in enumerate(found)]

    def means(self, name: str, ids: Collection[str]) -> bool:
        """True if a name means exactly these objects of the scene."""
        found = self.mentions(f"Take {name}")
        return len(found) == 1 and found[0].ids == frozenset(ids) and found[0].plural == (len(ids) > 1)

    def calls(self, ids: Collection[str], every: bool = False) -> list[str]:
        """Return names with an article that mean exactly these objects, the longest first.

        Several objects have one name only if they are alike.

        Args:
            ids: one object, or several for one name.
            every: say that all of several are meant.
        """
        entries = [self._things[name] for name in ids]
        several, phrases = len(ids) > 1, {self._phrases[name] for name in ids}
        names = [*phrases] if len(phrases) == 1 else []
        names += [entries[0].words.name] if len({entry.name for entry in entries}) == 1 else []
        found = [f"the {side}{name}" for side, name in product(("", *self._sides(ids)), names)]
        if several:
            plurals = [_in_plural(name, entries[0]) for name in names]
            counted = ["all the"] if every else [f"the {_number(len(ids))}", "the"]
            found = [f"{article} {plural}" for article, plural in product(counted, plurals) if plural is not None]
        return [name for name in dict.fromkeys(found) if self.means(name, ids)]

    def _sides(self, ids: Collection[str]) -> list[str]:
        words = {side for side in SIDES.values() if len(ids) == 1 and self._is_at({*ids}, side, self._likes(ids))}
        return [f"{side} " for side in sorted(words)]

    def _likes(self, ids: Collection[str]) -> set[str]:
        kinds = {names_of(self._things[name]).words[-1] for name in ids}
        return {name for name, entry in self._things.items() if names_of(entry).words[-1] in kinds}

    def _mention(self, said: Sequence[str], at: int, begun: int) -> Mention | None:
        """Return the mention whose name begins at a token, if any."""
        end = longest_name(said, at, self._names)
        start = self._start(said, at, begun)
        if end == at or (end == at + 1 and start == at and is_verb(said, at)):
            return None
        name = lemmas_of(said[at:end])
        own = {tuple(said[start:end]), tuple(said[at:end])} & self._singular
        plural = not own and any(map(is_plural, said[at:end]))
        mention = Mention(start, end, " ".join(said[start:end]), frozenset(self._names[name]), plural)
        return self._narrowed(said, mention, at, name in self._in_full)

    def _start(self, said: Sequence[str], at: int, begun: int) -> int:
        while at > begun and said[at - 1] in _BEFORE:
            at -= 1
        return at

    def _narrowed(self, said: Sequence[str], mention: Mention, name: int, full: bool) -> Mention:
        """Keep of a mention the objects with its colour and side, and set its count."""
        ids, before = set(mention.ids), said[mention.start : name]
        colours = look_words(" ".join(word for word in before if word in COLOURS))
        ids = {i for i in ids if full or colours <= look_words(self._things[i].variants[0].colour)}
        for word in before:
            if word in SIDES:
                ids = {i for i in ids if self._is_at({i}, SIDES[word], ids)}
        side = _side_after(said, mention.end)
        if side is not None and any(self._is_at({i}, side, ids) for i in ids):
            ids = {i for i in ids if self._is_at({i}, side, ids)}
            mention = replace(mention, end=mention.end + 3)
        count = next((count for word in before if (count := stated_count(word)) is not None), None)
        return replace(mention, ids=frozenset(ids), count=count)

    def _is_at(self, ids: Collection[str], side: str, among: Collection[str]) -> bool:
        """True if the descriptions place the object on this side of its likes."""
        (name,) = ids
        others = {*among} - {name}
        if not others:
            return any(d.subject == name and _SIDE_OF.get(d.relation) == side for d in self._descriptions)
        placed = {word: others & self._placed.get((name, word), set()) for word in _INVERSE}
        if side == "middle":
            pairs = (("left_of", "right_of"), ("in_front_of", "behind"))
            return len(others) == 2 and any(
                placed[a] and placed[b] and placed[a] | placed[b] == others for a, b in pairs
            )
        return any(others == placed[word] for word, at in _SIDE_OF.items() if at == side and word in placed)

    def _contents_of(self, said: Sequence[str], mention: Mention, after: Mention) -> Mention:
        """Keep of a mention the objects in or on the next mention: the mug on the tray."""
        between = said[mention.end : after.start]
        if len(mention.ids) < 2 or len(after.ids) != 1 or not between or not _WHERE.issuperset(between):
            return mention
        there = frozenset(i for i in mention.ids if self._lying.get(i) in after.ids)
        return replace(mention, ids=there) if there else mention


def _called(entry: CatalogueEntry) -> Iterator[Name]:
    """Yield the names of a kind of objects: its own, their endings, and words for its categories."""
    names = names_of(entry)
    for name in names.all:
        yield from _endings(name)
    words = {*ANYTHING, *KINDS, *CATEGORIES, lemma(entry.words.category)} - NOT_NAMES
    yield from ((word,) for word in words if is_of_kind(word, entry))


def _gathered(named: Iterable[tuple[Name, str]]) -> dict[Name, set[str]]:
    found: dict[Name, set[str]] = {}
    for name, thing in named:
        found.setdefault(name, set()).add(thing)
    return found


def words_of(sentence: str) -> list[str]:
    """Return the tokens of a sentence as mentions count them; a bar code is no bar."""
    text = sentence.lower().replace("’", "'").replace("'s", "")
    return tokens(text.replace("bar code", "code").replace("barcode of", "code of"))


def _endings(name: Name) -> Iterator[Name]:
    """Yield the name, and each of its endings that may replace it: "pen" for "marker pen"."""
    yield from [name] if len(name) > 1 or name[0] not in NOT_NAMES else []
    yield from (name[n:] for n in range(1, len(name)) if not {name[n], name[-1]} & NOT_NAMES)


def _in_plural(name: str, entry: CatalogueEntry) -> str | None:
    own = entry.words.name
    return name[: -len(own)] + entry.words.plural if name.endswith(own) else None


def _number(count: int) -> str:
    return next((word for word in NUMBERS if stated_count(word) == count and word != "both"), "")


def _side_after(said: Sequence[str], end: int) -> str | None:
    """The side in "the plate on the left", not in "the plate on the left of the mug"."""
    match said[end : end + 4]:
        case ["on" | "in" | "at", "the", side, *after] if side in SIDES and not {*after} & {"of", "side", "hand"}:
            return SIDES[side]
    return None


def _closure(descriptions: Sequence[Description]) -> dict[tuple[str, str], set[str]]:
    """Map (object, relation) to the related objects, as far as the descriptions imply them."""
    pairs = {(d.subject, d.relation, d.reference) for d in descriptions if d.relation in _INVERSE}
    pairs |= {(b, _INVERSE[word], a) for a, word, b in pairs}
    while new := {(a, w, d) for a, w, b in pairs for c, v, d in pairs if b == c and w == v and a != d} - pairs:
        pairs |= new
    found: dict[tuple[str, str], set[str]] = {}
    for a, word, b in pairs:
        found.setdefault((a, word), set()).add(b)
    return found
