"""An instruction in clauses, each of them a command: verb, object, and what its prepositions lead to."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass

INTO = (
    "on top of", "inside of", "into", "inside", "onto", "upon", "in", "on", "to", "beside", "near", "next to", "there",
)  # fmt: skip
"""Before the place where things go."""

SOURCES = ("from", "off", "out of")
"""Before the place where things are at the start."""

FROM = (*SOURCES, "with", "for", "using", "so that", "at", "by")
"""Before what is no place where things go."""

_PREPOSITION = re.compile(r"\b(" + "|".join(sorted(INTO + FROM, key=len, reverse=True)) + r")\b")

FILLING = frozenset(["fill", "load", "stock", "pack", "stuff"])
"""Verbs whose object is the place: 'fill the bowl with apples'."""

OPENING = frozenset(["open", "close", "shut", "unlock", "lock"])
"""What is done to a place before or after things are put into it."""

EMPTYING = frozenset(["empty"])
"""Verbs whose object is where the things are that are moved: 'empty the bowl onto the tray'."""

GATHERING = frozenset(["clear", "clean", "tidy", "wipe"])
"""What is done to a table, not with one."""

TOOL_VERBS = frozenset(["scan", "weigh", "wipe", "clean", "stir", "cut", "measure", "erase", "rub", "press", "staple"])
"""What is done with a tool: 'scan it with the scanner'."""

_PLACING = ("put", "place", "pack", "set", "move", "drop")
_OTHER_VERBS = (
    "add", "arrange", "bring", "carry", "collect", "deliver", "empty", "fetch", "fill", "gather", "give", "grab",
    "hand", "hide", "insert", "keep", "lay", "leave", "lift", "load", "open", "close", "shut", "pick", "pop", "press",
    "pull", "push", "put", "remove", "rest", "return", "scan", "slide", "slip", "sort", "stack", "stand", "stick",
    "store", "stow", "take", "throw", "tidy", "toss", "transfer", "weigh",
)  # fmt: skip
_MARKER = r"(?=\s+(?:the|a|an|it|them|these|those|this|that|both|all|each|every|everything|my|your|our|its|some|any|up|"
_MARKER += r"one|two|three|four|five|six|seven|eight|nine|ten|\d+)\b)"
"""What follows a verb and never a noun: '… and stand the mug' against '… and stand'."""

_CLAUSE = re.compile(
    r"[.;!?]|,?\s*\b(?:and then|then|afterwards|after that|finally|next,)(?=\W)"
    rf"|,?\s*\band\b(?=\s+(?:{'|'.join(_PLACING)})\b)"
    rf"|(?:,\s*(?:and\s+)?|\band\b)(?=\s*(?:{'|'.join((*_PLACING, *_OTHER_VERBS))})\b{_MARKER})",
    re.IGNORECASE,
)
_PARTICLES = frozenset(
    ["please", "away", "up", "down", "together", "back", "carefully", "neatly", "can", "could", "would", "will", "you",
     "over", "out", "kindly", "now", "too", "also", "gently", "first,", "just"]
)  # fmt: skip
_WISH = re.compile(
    r"^(?:(?:i|we)(?:'d| would)? (?:like|want|need|wish)|(?:make|be) sure|ensure|see to it)"
    r"(?: for)?(?: that)?(?: to)?\b"
)
_DUTY = re.compile(
    r"^(?P<what>.+?)\s+(?:(?:should|must|shall|needs? to|has to|have to|ought to|is to|are to)\s+(?:all\s+|both\s+)?"
    r"(?:go|be|stand|lie|belong|end|get|stay)|goes|go|belongs|belong|ends|end)"
    r"\s+(?P<where>(?:in|on|into|onto|inside|to|next|beside|near)\b.*)$"
)
_INVERTED = re.compile(r"^(?P<where>(?:in|on|into|onto|inside)\b.+?)\s+(?:goes|go|belongs|belong)\s+(?P<what>.+)$")
_DONE = re.compile(
    r"(?:\s+(?:to be|is|are|be))?(?:\s+(?:put|placed|packed|stored|set|moved|sorted|stowed|laid|left|kept))?"
    r"(?=\s+(?:in|on|into|onto|inside|to|next|beside|near)\b)"
)
"""'… packed into the basket', said of what is wished for."""

_PULLING = re.compile(r"^(?:pull|slide|swing|push|flip)\s+(?P<how>open|shut|closed)\b")
_VERBS = frozenset((*_PLACING, *_OTHER_VERBS, *FILLING, *OPENING, *GATHERING, *TOOL_VERBS))


_STEMS = {verb.removesuffix("e"): verb for verb in sorted(_VERBS)}
_GERUNDS = {gerund: verb for stem, verb in _STEMS.items() for gerund in (f"{stem}ing", f"{stem}{stem[-1]}ing")}
"""'placing' → 'place'; 'putting', and 'puting', → 'put'."""

_BY_DOING = re.compile(rf"\s*\b(?P<how>by|after|mind)\s+(?P<verb>{'|'.join(_GERUNDS)})\b", re.IGNORECASE)


@dataclass(frozen=True)
class Clause:
    """'put the apple in the bowl': ``put``, ``the apple``, ``(("in", "the bowl"),)``.

    Args:
        adjuncts: (preposition, the words up to the next one), as they follow the object.
        announces: a colon follows, so that it says in general what the next clause details.
    """

    verb: str
    object: str
    adjuncts: tuple[tuple[str, str], ...]
    announces: bool

    def after(self, prepositions: Collection[str]) -> str | None:
        """The words after the first of these prepositions; None where none of them stands."""
        return next((words for preposition, words in self.adjuncts if preposition in prepositions), None)


def clauses(instruction: str) -> Iterator[Clause]:
    """The clauses of an instruction that hold more than a verb."""
    announced = _as_commands(instruction).split(":")
    for index, part in enumerate(announced):
        pieces = [piece for piece in _CLAUSE.split(part) if piece and piece.strip(" ,")]
        more = any(rest.strip() for rest in announced[index + 1 :])
        for number, piece in enumerate(pieces):
            verb, _, rest = _command(piece).partition(" ")
            if rest:
                thing, *adjuncts = _PREPOSITION.split(rest)
                pairs = zip(adjuncts[::2], adjuncts[1::2], strict=True)
                yield Clause(verb, thing, tuple(pairs), more and number == len(pieces) - 1)


def _as_commands(instruction: str) -> str:
    """'Tidy up by placing the pens …' → 'Tidy up: place the pens …'."""

    def command(match: re.Match[str]) -> str:
        verb = _GERUNDS[match["verb"].lower()]
        return f": {verb}" if match["how"].lower() == "by" else f". {verb}"

    return _BY_DOING.sub(command, instruction)


def _command(text: str) -> str:
    """The clause in lower case, without punctuation and particles, as a command: 'put … into …'."""
    text = re.sub(r"[^\w\s,&'-]", " ", text.lower())
    text = re.sub(r"\bas well\b(?! as\b)", " ", text)
    text = re.sub(r"\b(?:out|off) of\b", "from", text)
    text = " ".join(word for word in text.split() if word not in _PARTICLES).strip(" ,")
    pulled = _PULLING.match(text)
    if pulled:
        text = f"{'open' if pulled['how'] == 'open' else 'close'}{text[pulled.end() :]}"
    text = _wished(text)
    verb, _, rest = text.partition(" ")
    return f"{verb.strip(',')} {rest}".strip()


def _wished(text: str) -> str:
    """What is wished for, or ought to be, as a command."""
    wish = _WISH.sub("", text).strip()
    bare = wish.split(" ", 1)[0] not in _VERBS
    if wish != text and not bare:
        return wish
    for pattern in (_INVERTED, _DUTY):
        found = pattern.match(wish) if bare else None
        if found:
            return f"put {_DONE.sub('', found['what'])} {found['where']}"
    return f"put {_DONE.sub('', wish)}" if wish != text else text
