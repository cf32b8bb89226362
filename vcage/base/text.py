"""Foreign text in our messages: one line, visible characters, lists."""

from __future__ import annotations

import re
from collections.abc import Iterable

_BREAKS = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029]+")
"""Control characters, line ends among them, and Unicode's separators of lines and paragraphs."""

_UNSEEN = re.compile(
    "[\xad\u061c\u180e\u200b\u200e\u200f\u202a-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb\U000e0000-\U000e007f]"
)
"""Characters that show nothing, or turn the direction of others; not those that join letters."""

_HALVES = re.compile("[\ud800-\udfff]")
"""Half a character, which UTF-8 cannot hold."""


def one_line(text: str) -> str:
    """The text in one line: control characters and line ends become a space, invisible characters are left out."""
    return _HALVES.sub("\ufffd", _UNSEEN.sub("", _BREAKS.sub(" ", text)))


def shown(text: str) -> str:
    r"""The text with characters that are unseen, or turn the direction of others, as escapes: ``\u200b``."""
    return _UNSEEN.sub(lambda found: found[0].encode("unicode_escape").decode(), text)


def listed(items: Iterable[object], most: int = 10, between: str = ", ") -> str:
    """List the first ``most`` items in one line, a tuple as "a/b", and say how many more there are."""
    every = ["/".join(map(str, item)) if isinstance(item, tuple) else str(item) for item in items]
    return between.join(every[:most]) + (f" and {len(every) - most} more" if len(every) > most else "")
