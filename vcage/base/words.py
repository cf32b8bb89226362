"""English words: lemmas, numbers, colours, kinds, likeness of spelling, and classes for checks of an instruction."""

from __future__ import annotations

import difflib
import functools
import re

IRREGULAR = {
    "loaves": "loaf", "knives": "knife", "shelves": "shelf", "leaves": "leaf", "halves": "half", "mice": "mouse",
    "potatoes": "potato", "tomatoes": "tomato", "dishes": "dish", "dice": "die", "men": "man", "children": "child",
    "cookies": "cookie", "brownies": "brownie", "pies": "pie", "boxes": "box", "axes": "axe", "cacti": "cactus",
    "colored": "coloured", "veg": "vegetable", "veggies": "vegetable", "veggie": "vegetable",
}  # fmt: skip
"""Plural → singular where the rules below would go wrong, and one spelling for two."""


def word_set(*lines: str) -> frozenset[str]:
    """The words of some lines."""
    return frozenset(word for line in lines for word in line.split())


NO_PLURAL = word_set(
    "scissors pliers tongs tweezers headphones glasses cutlery stationery bus gas chess electronics fries"
)
"""Words that end like a plural and are singular."""

NUMBERS = {
    "a": 1, "an": 1, "one": 1, "two": 2, "both": 2, "couple": 2, "pair": 2, "three": 3, "few": 3, "several": 3,
    "some": None, "four": 4, "five": 5, "six": 6, "seven": 7, "eight": 8, "nine": 9, "ten": 10, "zero": 0, "no": 0,
    "eleven": 11, "twelve": 12, "dozen": 12, "thirteen": 13, "fourteen": 14, "fifteen": 15, "sixteen": 16,
    "seventeen": 17, "eighteen": 18, "nineteen": 19, "twenty": 20, "thirty": 30, "forty": 40, "fifty": 50,
    "hundred": 100, "thousand": 1000,
}  # fmt: skip

DETERMINERS = word_set("the of this that these those my your our its his her all every each any other")

COLOURS = word_set(
    "red green blue yellow orange purple violet pink brown black white grey gray silver gold golden beige cyan",
    "teal turquoise navy cream tan magenta",
)

_SAME_COLOUR = {"gray": "grey", "violet": "purple", "golden": "gold"}

_JOINING = frozenset((*DETERMINERS, "and", "with"))

KINDS: dict[str, frozenset[str]] = {
    "bread": word_set("baguette croissant roll bun toast bagel loaf brioche pretzel ciabatta pita"),
    "pastry": word_set("croissant muffin donut doughnut brioche danish"),
    "fruit": word_set("apple banana orange lemon lime pear peach plum kiwi mango grape strawberry"),
    "vegetable": word_set("carrot potato tomato pepper onion cucumber broccoli aubergine"),
    "cutlery": word_set("fork knife spoon teaspoon"),
    "tableware": word_set("plate bowl mug cup fork knife spoon"),
    "tool": word_set("hammer screwdriver wrench pliers saw drill spanner chisel"),
    "stationery": word_set("pen pencil marker eraser stapler ruler notebook sharpener highlighter clip"),
    "toy": word_set("block cube brick ball doll car"),
    "food": word_set("apple banana orange baguette croissant roll bun toast bagel loaf"),
    "drink": word_set("drink juice milk soda lemonade cola water beer wine smoothie"),
    "container": word_set("bowl cup mug"),
    "medicine": word_set("medicine medication pill tablet"),
}
"""Words for a kind of things → heads of names of such things."""

_EATEN = ("food", "packed food", "bread", "fruit", "vegetable", "sweet", "condiment")
_EDIBLE = word_set("bread pastry fruit vegetable food drink")
_CARED = ("toiletries", "cosmetics")
CATEGORIES: dict[str, frozenset[str]] = {
    "food": frozenset(_EATEN),
    "grocery": frozenset(_EATEN),
    "product": frozenset((*_EATEN, *_CARED)),
    "good": frozenset((*_EATEN, *_CARED)),
    "purchase": frozenset((*_EATEN, *_CARED)),
    "toiletry": frozenset(_CARED),
    "cosmetic": word_set("cosmetics"),
    "stationery": frozenset(["stationery", "office tool"]),
    "medicine": word_set("medicine"),
    "dish": word_set("crockery"),
    "crockery": word_set("crockery"),
    "electronics": word_set("electronics"),
    "gadget": word_set("electronics"),
}
"""Words for a kind of things → categories of the catalogue that such things are in."""

MASS_KINDS = word_set("bread fruit cutlery tableware stationery food crockery electronics")
"""Words for a kind of things that mean several in the singular."""

SHALLOW = word_set("dish tray pan plate saucer board mat skillet holder rack shelf stand")
"""Heads of names of shallow and of open things: people put things both in and on them."""

ANYTHING = word_set("object thing item stuff everything belonging article clutter all")
"""Words for things of no kind in particular."""

PART_WORDS = {
    "drawer": "drawer", "layer": "drawer", "door": "door", "lid": "lid", "cover": "lid", "screen": "screen",
    "button": "button", "dial": "dial", "lever": "lever", "knob": "knob",
    "compartment": "compartment",
}  # fmt: skip
"""Words for moving parts and compartments → the first word of the part's name."""

PARTS = frozenset((*PART_WORDS, "shelf", "handle", "display"))
"""Words for parts of things."""

COUNTED = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")
"""Ordinals that count from one end."""

SIDES = {
    "left": "left", "leftmost": "left", "right": "right", "rightmost": "right", "front": "front", "back": "back",
    "rear": "back", "middle": "middle", "central": "middle", "centre": "middle", "center": "middle",
}  # fmt: skip
"""Words for the side on which an object stands, as the robot sees it → the side in one spelling."""

SIZES = {
    **dict.fromkeys(("small", "smaller", "smallest", "little", "littler", "littlest"), "small"),
    **dict.fromkeys(("medium", "medium-sized", "middle-sized"), "medium"),
    **dict.fromkeys(("large", "larger", "largest", "big", "bigger", "biggest"), "large"),
    **{word: word for word in ("tiny", "mini", "miniature", "huge", "giant", "enormous", "massive", "gigantic")},
}
"""Words for a size → the size in one spelling."""

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


@functools.lru_cache(maxsize=100_000)
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
    return list(_lemmas(text))


@functools.lru_cache(maxsize=100_000)
def _lemmas(text: str) -> tuple[str, ...]:
    """:func:`lemmas`, kept: choosing objects asks for those of every name of the catalogue, many times."""
    return tuple(lemma(word) for word in tokens(text) if word not in DETERMINERS)


@functools.lru_cache(maxsize=100_000)
def colour_of(text: str) -> str | None:
    """The first colour word in a text, in one spelling."""
    for word in tokens(text):
        if word in COLOURS:
            return _SAME_COLOUR.get(word, word)
    return None


def colours_of(text: str) -> str | None:
    """:func:`colour_of`; of a two-coloured look both, sorted: ``yellow and white`` → ``white and yellow``."""
    found = [colour for word in tokens(text) if (colour := colour_of(word))]
    return " and ".join(sorted(found[:2])) if len(found) > 1 and "and" in tokens(text) else colour_of(text)


def look_words(text: str) -> frozenset[str]:
    """Return the words of a text that may describe a look: ``black and gray`` → {``black``, ``grey``}."""
    return frozenset(colour_of(word) or lemma(word) for word in tokens(text) if word not in _JOINING)


def kinds_of(head: str, category: str | None = None) -> set[str]:
    """The kinds that a name with this head belongs to: ``bagel`` → {``bread``}.

    Args:
        category: the catalogue's; a roll other than food is no bread.
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


FUNCTION_WORDS = word_set(
    "a an the this that these those it its them they their i i'd i'll i've i'm me my mine we we'd we'll we're us",
    "our you you'd you're your he she him her his is are was were be been being am isn't aren't do does did don't",
    "doesn't didn't has have had having will would could should shall may might must can can't cannot need needs",
    "needed want wants wanted like likes let lets let's get gets got getting make makes sure please kindly thanks",
    "thank thx pls plz and or but nor so then than also too as if when once until while before after afterwards",
    "first finally next last lastly now just only really quite very still yet again already soon later in into on",
    "onto to of off out over up down at by for from with within without inside around about through under along",
    "here there where which who whom what whose how why some any no not none each every all both either neither",
    "another other others one ones else same such more most less few several couple pair rest everything anything",
    "something that's it's there's what's ok okay oh hey hi hello hmm um uh er well right away robot sorry wait",
    "mean actually instead rather except apart hang possible mind matter matters care whichever whatever happen",
    "bit little ahead together time start beginning end possibly perhaps maybe ever always way good nice great",
    "fine done job thing things go goes going come comes yours you've we've they've shouldn't wouldn't couldn't",
    "won't thats think see prefer trouble grateful dear mate ta yeah wondering happy moment turn supposed kind",
    "able ur u people himself herself themselves that'd love champ bruh n exactly guess bet hurry quickly",
    "carefully gently neatly nicely side terribly requested it'd running somebody someone gentleman lady customer",
    "pay paying happened stays follows today tonight coming table desk counter worktop",
)
"""Words that no goal has to answer: they carry grammar, or politeness."""

HANDLING = word_set(
    "put puts putting place places placed placing set sets setting move moves moved moving bring brings take",
    "takes taking taken gather collect tidy sort stow pick picks picked picking lay lays laid lift grab grabs hold get",
    "keep fetch carry pop stick leave stand clear clean use uses using",
)
"""Verbs of taking and putting, which any goal of a thing answers."""

VERBS = HANDLING | word_set(
    "stack pack open close shut press push pull turn switch scan weigh show hand give pass present return clear",
    "tidy clean prepare store load fill empty drop throw slide sort arrange build make serve bag box belong",
    "belongs sit stay shake raise swap exchange hit beat strike wipe pour tip dump hang insert plug",
)
"""Verbs that instructions often have."""

AFTER_A_NOUN = word_set(
    "behind beside near close left separately belong against neatly carefully above below went alone untouched",
    "top bottom nearest closest ends ended sits stands tucked stored kept packed laid placed upright",
)
"""Words that may follow a noun and do not make it part of a longer name."""
