"""Classes of English words that checks of an instruction know: of grammar, verbs, and what may follow a noun."""

from __future__ import annotations


def _words(*lines: str) -> frozenset[str]:
    return frozenset(word for line in lines for word in line.split())


FUNCTION_WORDS = _words(
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

HANDLING = _words(
    "put puts putting place places placed placing set sets setting move moves moved moving bring brings take",
    "takes taking taken gather tidy sort stow pick picks picked picking lay lays laid lift grab grabs hold get",
    "keep fetch carry pop stick leave stand clear clean use uses using",
)
"""Verbs of taking and putting, which any goal of a thing answers."""

VERBS = HANDLING | _words(
    "stack pack open close shut press push pull turn switch scan weigh show hand give pass present return clear",
    "tidy clean prepare store load fill empty drop throw slide sort arrange build make serve bag box belong",
    "belongs sit stay",
)
"""Verbs that instructions often have."""

AFTER_A_NOUN = _words(
    "behind beside near close left separately belong against neatly carefully above below went alone untouched",
    "top bottom nearest closest ends ended sits stands tucked stored kept packed laid placed",
)
"""Words that may follow a noun and do not make it part of a longer name."""
