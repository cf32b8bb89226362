"""Words: lemmas, number words, colours, categories, and similarity of spelling."""

from __future__ import annotations

import difflib
import functools
import re

IRREGULAR = {
    "loaves": "loaf", "knives": "knife", "shelves": "shelf", "leaves": "leaf", "halves": "half", "mice": "mouse",
    "potatoes": "potato", "tomatoes": "tomato", "dishes": "dish", "dice": "die", "men": "man", "children": "child",
    "cookies": "cookie", "brownies": "brownie", "pies": "pie", "boxes": "box", "axes": "axe", "cacti": "cactus",
    "veg": "vegetable", "veggies": "vegetable", "veggie": "vegetable",
}  # fmt: skip
"""Plural → singular where the rules below would go wrong."""

NO_PLURAL = frozenset(
    ["scissors", "pliers", "tongs", "tweezers", "headphones", "glasses", "cutlery", "stationery", "bus", "gas",
     "chess", "electronics"]
)  # fmt: skip
"""Words that end like a plural and are singular."""

NUMBERS = {
    "a": 1, "an": 1, "one": 1, "two": 2, "both": 2, "couple": 2, "pair": 2, "three": 3, "few": 3, "several": 3,
    "some": None, "four": 4, "five": 5, "six": 6, "seven": 7, "eight": 8, "nine": 9, "ten": 10, "zero": 0, "no": 0,
    "eleven": 11, "twelve": 12, "dozen": 12, "thirteen": 13, "fourteen": 14, "fifteen": 15, "sixteen": 16,
    "seventeen": 17, "eighteen": 18, "nineteen": 19, "twenty": 20, "thirty": 30, "forty": 40, "fifty": 50,
    "hundred": 100, "thousand": 1000,
}  # fmt: skip

DETERMINERS = frozenset(
    ["the", "of", "this", "that", "these", "those", "my", "your", "our", "its", "his", "her", "all", "every", "each",
     "any", "other"]
)  # fmt: skip

COLOURS = frozenset(
    ["red", "green", "blue", "yellow", "orange", "purple", "violet", "pink", "brown", "black", "white", "grey",
     "gray", "silver", "gold", "golden", "beige", "cyan", "teal", "turquoise", "navy", "cream", "tan", "magenta"]
)  # fmt: skip

_SAME_COLOUR = {"gray": "grey", "violet": "purple", "golden": "gold"}

_JOINING = frozenset((*DETERMINERS, "and", "with"))

KINDS: dict[str, frozenset[str]] = {
    "bread": frozenset(
        ["baguette", "croissant", "roll", "bun", "toast", "bagel", "loaf", "brioche", "pretzel", "ciabatta", "pita"]
    ),
    "pastry": frozenset(["croissant", "muffin", "donut", "doughnut", "brioche", "danish"]),
    "fruit": frozenset(
        ["apple", "banana", "orange", "lemon", "lime", "pear", "peach", "plum", "kiwi", "mango", "grape", "strawberry"]
    ),
    "vegetable": frozenset(["carrot", "potato", "tomato", "pepper", "onion", "cucumber", "broccoli", "aubergine"]),
    "cutlery": frozenset(["fork", "knife", "spoon", "teaspoon"]),
    "tableware": frozenset(["plate", "bowl", "mug", "cup", "fork", "knife", "spoon"]),
    "tool": frozenset(["hammer", "screwdriver", "wrench", "pliers", "saw", "drill", "spanner", "chisel"]),
    "stationery": frozenset(
        ["pen", "pencil", "marker", "eraser", "stapler", "ruler", "notebook", "sharpener", "highlighter", "clip"]
    ),
    "toy": frozenset(["block", "cube", "brick", "ball", "doll", "car"]),
    "food": frozenset(["apple", "banana", "orange", "baguette", "croissant", "roll", "bun", "toast", "bagel", "loaf"]),
    "drink": frozenset(["drink", "juice", "milk", "soda", "lemonade", "cola", "water", "beer", "wine", "smoothie"]),
    "container": frozenset(["bowl", "cup", "mug"]),
    "medicine": frozenset(["medicine", "medication", "pill", "tablet"]),
}
"""Words for a kind of things → heads of names of such things."""

_EATEN = ("food", "packed food", "bread", "fruit", "vegetable", "sweet", "condiment")
_EDIBLE = frozenset(["bread", "pastry", "fruit", "vegetable", "food", "drink"])
_CARED = ("toiletries", "cosmetics")
CATEGORIES: dict[str, frozenset[str]] = {
    "food": frozenset(_EATEN),
    "grocery": frozenset(_EATEN),
    "product": frozenset((*_EATEN, *_CARED)),
    "good": frozenset((*_EATEN, *_CARED)),
    "purchase": frozenset((*_EATEN, *_CARED)),
    "toiletry": frozenset(_CARED),
    "cosmetic": frozenset(["cosmetics"]),
    "stationery": frozenset(["stationery", "office tool"]),
    "medicine": frozenset(["medicine"]),
    "dish": frozenset(["crockery"]),
    "crockery": frozenset(["crockery"]),
    "electronics": frozenset(["electronics"]),
    "gadget": frozenset(["electronics"]),
}
"""Words for a kind of things → categories of the catalogue that such things are in."""

MASS_KINDS = frozenset(["bread", "fruit", "cutlery", "tableware", "stationery", "food", "crockery", "electronics"])
"""Words for a kind of things that mean several in the singular."""

SHALLOW = frozenset(["dish", "tray", "pan", "plate", "saucer", "board", "mat", "skillet", "holder"])
"""Heads of names of shallow things: people put things both in and on them."""

ANYTHING = frozenset(["object", "thing", "item", "stuff", "everything", "belonging", "article", "clutter", "all"])
"""Words for things of no kind in particular."""

PART_WORDS = {
    "drawer": "drawer", "layer": "drawer", "door": "door", "lid": "lid", "cover": "lid", "screen": "screen",
    "button": "button", "dial": "dial", "lever": "lever", "knob": "knob",
}  # fmt: skip
"""Words for moving parts → the first word of the part's name."""

PARTS = frozenset((*PART_WORDS, "compartment", "shelf", "handle", "display"))
"""Words for parts of things."""

COUNTED = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")
"""Ordinals that count from one end."""

SIDES = {
    "left": "left", "leftmost": "left", "right": "right", "rightmost": "right", "front": "front", "back": "back",
    "rear": "back", "middle": "middle", "central": "middle", "centre": "middle", "center": "middle",
}  # fmt: skip
"""Words for the side on which an object stands, as the robot sees it → the side in one spelling."""

HIGHEST = ("top", "upper", "uppermost", "topmost", "highest")
LOWEST = ("bottom", "lower", "bottommost", "lowest")
WHICH_PART = {**dict.fromkeys(HIGHEST, "top"), **dict.fromkeys(LOWEST, "bottom"), "middle": "middle"}
"""Words that tell parts apart → how the part's name ends."""

_WORD = re.compile(r"[a-z0-9]+(?:'[a-z]+)?")
_WORD_OR_MARK = re.compile(rf"{_WORD.pattern}|[,.;:!?()]")


def tokens(text: str) -> list[str]:
    """Lower-case words of a text, without punctuation; underscores and hyphens separate words."""
    return _WORD.findall(text.lower().replace("_", " "))


def marked_tokens(text: str) -> list[str]:
    """:func:`tokens` with the punctuation marks among them, each by itself."""
    return _WORD_OR_MARK.findall(text.lower().replace("_", " "))


def lemma(word: str) -> str:
    """Singular of an English noun in lower case."""
    if word in NO_PLURAL:
        return word
    if word in IRREGULAR:
        return IRREGULAR[word]
    if len(word) > 4 and word.endswith("ies"):
        return word[:-3] + "y"
    if len(word) > 4 and word.endswith(("sses", "xes", "ches", "shes")):
        return word[:-2]
    if len(word) > 3 and word.endswith("s") and not word.endswith(("ss", "us", "is")):
        return word[:-1]
    return word


def is_plural(word: str) -> bool:
    """Check if a word is a plural form."""
    return lemma(word) != word


def lemmas(text: str) -> list[str]:
    """Lemmas of the words of a text that carry meaning."""
    return [lemma(word) for word in tokens(text) if word not in DETERMINERS]


def colour_of(text: str) -> str | None:
    """The first colour word in a text, in one spelling."""
    for word in tokens(text):
        if word in COLOURS:
            return _SAME_COLOUR.get(word, word)
    return None


def look_words(text: str) -> frozenset[str]:
    """Return the words of a text that may describe a look: ``black and gray`` → {``black``, ``grey``}."""
    return frozenset(colour_of(word) or lemma(word) for word in tokens(text) if word not in _JOINING)


def kinds_of(head: str, category: str | None = None) -> set[str]:
    """The kinds that a name with this head belongs to: ``bagel`` → {``bread``}.

    Args:
        category: the catalogue's; a roll that is no food is no bread.
    """
    kinds = {kind for kind, members in KINDS.items() if head in members}
    return kinds if category is None or category in (*_EATEN, "drink", "pastry") else kinds - _EDIBLE


@functools.lru_cache(maxsize=100_000)
def same_word(a: str, b: str) -> bool:
    """Equal, or one slip of the pen apart (only words of five letters and more)."""
    if a == b:
        return True
    if min(len(a), len(b)) < 5:
        return False
    return spelling_similarity(a, b) >= 0.86


def spelling_similarity(a: str, b: str) -> float:
    """Similarity of two spellings, in [0, 1]."""
    return difflib.SequenceMatcher(None, a, b).ratio()
