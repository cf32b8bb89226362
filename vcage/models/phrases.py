"""Patterns of English phrases, written as the words themselves.

Blanks separate the words of a phrase. ``(a|b c)`` is one of several, ``[a|b]`` the same or nothing, ``<a|b>`` one of
several that the match captures, ``<name=a|b>`` by name. ``mov*`` is a word that begins so, ``_`` any word, ``!(a|b*)``
any word but these, and ``#`` a mark that ends a clause. Patterns are for texts of words and marks with blanks between
them, as :func:`vcage.base.words.marked_tokens` makes them.
"""

from __future__ import annotations

import re

_TOKEN = re.compile(r"(!?)\(([^)]*)\)|\[([^\]]*)\]|<(?:(\w+)=)?([^>]*)>|([^\s()\[\]<>]+)")


def phrase(text: str, *, before: str = "", or_end: bool = False, not_before: str = "", not_after: str = "") -> str:
    """The regular expression of a phrase.

    Args:
        text: of the phrase.
        before: phrases, with ``/`` between them, one of which must follow.
        or_end: accept the end of the text in its place.
        not_before: phrases, none of which may follow.
        not_after: phrases of plain words, with ``/`` between them, none of which may precede it.
    """
    ahead = f"(?= {_any(before)}{'|$' if or_end else ''})" if before else "$" if or_end else ""
    ahead += f"(?! {_any(not_before)})" if not_before else ""
    behind = "".join(f"(?<!{words} )" for words in filter(None, not_after.split(" / ")))
    return rf"\b{behind}{_sequence(text)}{ahead}"


def group(name: str, *patterns: str) -> str:
    """The regular expression of any of some patterns, as a group with a name."""
    return f"(?P<{name}>{'|'.join(patterns)})"


def compiled(*patterns: str) -> re.Pattern[str]:
    """The compiled expression of any of some patterns, the first that fits."""
    return re.compile("|".join(patterns))


def _any(texts: str) -> str:
    return f"(?:{'|'.join(map(_sequence, texts.split(' / ')))})"


def _sequence(text: str) -> str:
    found, begun = "", False
    for but, one, may, name, take, word in _TOKEN.findall(text):
        if may:
            found += f"(?: {_choice(may)})?" if begun else f"(?:{_choice(may)} )?"
            continue
        group = f"(?P<{name}>" if name else "(" if take else rf"(?!{_choice(one)})\w+(?:" if but else "(?:"
        inner = "" if but else _choice(take or one or word)
        found += f"{' ' * begun}{group}{inner})"
        begun = True
    return found


def _choice(words: str) -> str:
    """Any of some phrases of plain words, each to its end."""
    return f"(?:{'|'.join(_plain(one) for one in words.split('|'))})"


def _plain(words: str) -> str:
    if words == "#":
        return "[,.;:!?)]"
    pattern = re.escape(words).replace(r"\ ", " ").replace(r"\*", r"\w*")
    pattern = re.sub(r"(?<!\w)_(?!\w)", r"\\w+", pattern)
    return pattern + (r"\b" if words[-1].isalnum() or words[-1] in "*_" else "")
