"""From what an instruction asks for to goals about the objects of a scene; refused where that leaves a doubt."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from vcage.base.errors import UnreadInstruction
from vcage.base.words import ANYTHING, COLOURS, COUNTED, HIGHEST, LOWEST, SHALLOW, lemmas
from vcage.models.rules.instruction import Request, parse_instruction
from vcage.models.rules.naming import Meaning, meant, words_of
from vcage.models.rules.phrases import Phrase
from vcage.models.rules.references import BESIDE
from vcage.plans.actions import lasting
from vcage.plans.check import contradictions
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import AskedGoal, Goal, GoalWord, Reading, in_steps, part_that
from vcage.schema.plan import TABLE, Relation

_TOOLS = {"scan": "barcode_scanner", "weigh": "electronic_scale"}
SMALL = 0.1
"""Of what is less wide than this, metres, the top holds one thing."""

_SAME_PART = {"lid": ("lid", "cover", "screen"), "screen": ("screen", "lid", "display"), "dial": ("dial", "knob")}


def read_goals(
    instruction: str, things: Mapping[str, CatalogueEntry], lying: Mapping[str, str] | None = None
) -> Reading:
    """The goals of an instruction in a scene.

    Args:
        instruction: a command, in several clauses if need be.
        things: what there is, by object id: the catalogue's entries with no other look than the object's.
        lying: what lies in or on another thing at the start: object id → id of that thing.

    Raises:
        UnreadInstruction: words of it are not understood, name nothing that is there, or leave open what is meant.
    """
    return _Grounding(instruction, things, lying or {}).read()


@dataclass(frozen=True)
class _Place:
    """Where things go: an object, or a part of it.

    Args:
        id: of the object, or ``table``.
        part: the moving part.
        holds: ``in`` or ``on``.
    """

    id: str
    part: str | None
    holds: str


class _Grounding:
    """Finds for each phrase the objects that it means; what is taken by 'the red one' is not taken by 'another' too."""

    def __init__(self, instruction: str, things: Mapping[str, CatalogueEntry], lying: Mapping[str, str]):
        self._lying = lying
        self._instruction = instruction
        self._things = things
        self._requests = parse_instruction(instruction, words_of(list(things.values())), self._is_place, self._opens)
        self._meant: dict[Phrase, tuple[str, ...]] = {}
        self._places: dict[tuple[object, ...], _Place] = {}
        self._taken: list[str] = []
        self._operated: list[tuple[str, str]] = []

    def _is_place(self, phrase: Phrase) -> bool:
        found = meant(phrase, self._things, Meaning.HOLDS)
        return phrase.part is not None or any(self._things[name].functional_points for name in found)

    def _opens(self, phrase: Phrase) -> bool:
        if phrase.part is not None:
            return True
        found = meant(phrase, self._things, Meaning.HOLDS)
        return any(part_that("open", part) for name in found for part in self._things[name].moving_parts)

    def read(self) -> Reading:
        """The goals.

        Raises:
            UnreadInstruction: see :func:`read_goals`.
        """
        self._requests = [self._shared_out(request) for request in self._requests]
        self._require_sources()
        self._name_all()
        goals: list[AskedGoal] = []
        for request in self._requests:
            if request.asked != "leave":
                words = self._instruction[request.start : request.end]
                goals += [AskedGoal(goal=goal, step=request.step, words=words) for goal in self._goals(request)]
        if not goals:
            raise UnreadInstruction.of(self._instruction, self._instruction, "it asks for none of anything")
        untouched = self._untouched(goals)
        goals = self._kept(goals)
        self._require_sense(goals)
        return Reading(goals=list(_once(goals)), untouched=untouched)

    # --- which objects ---------------------------------------------------------------------------------

    def _name_all(self) -> None:
        """Give every phrase for things its objects: certain ones first, then choices among what is left."""
        phrases = [phrase for request in self._requests for phrase in request.things if phrase not in self._meant]
        waiting = []
        for phrase in sorted(dict.fromkeys(phrases), key=lambda p: p.start):
            if phrase.quantity in ("a", "rest") or (phrase.count or 1) > 1:
                waiting.append(phrase)
            else:
                self._meant[phrase] = self._certain(phrase)
        waiting.sort(key=lambda p: (p.quantity == "rest", p.plural, len(self._answers(p))))
        for phrase in waiting:
            self._meant[phrase] = self._choice(phrase)

    def _shared_out(self, request: Request) -> Request:
        """'An apple on each plate': as many apples as there are plates."""
        place = request.place
        if request.asked != "put" or place is None or place.quantity != "all" or place.lemmas == (TABLE,):
            return request
        count = len(self._candidates(place, request.preposition, ()))
        things = tuple(
            replace(t, count=t.count * count) if t.count and t.quantity == "a" else t for t in request.things
        )
        return replace(request, things=things)

    def _answers(self, phrase: Phrase) -> list[str]:
        """Every object that the words fit, without what is left out; those that can be carried if some can."""
        if phrase.is_pronoun:
            raise self._refusal(phrase, "it is not clear what that is")
        found = meant(phrase, self._things, Meaning.CARRIED)
        sources = [place for request in self._requests for thing, place in request.sources if thing == phrase]
        if sources and phrase.head in ANYTHING:  # 'empty the basket'
            holders = meant(sources[0], self._things, Meaning.HOLDS)
            found = [name for name in found if self._lying.get(name) in holders]
        left = {name for but in phrase.but for name in self._left_out(but, phrase)}
        return [name for name in found if name not in left]

    def _left_out(self, but: Phrase, phrase: Phrase) -> list[str]:
        if but.lemmas in (("one",), ()):
            but = replace(but, lemmas=phrase.lemmas)
        found = meant(but, self._things, Meaning.CARRIED)
        if not found and len(but.lemmas) == 1 and but.head in COLOURS:  # 'all but the green'
            found = meant(replace(but, lemmas=phrase.lemmas, colour=but.head), self._things, Meaning.CARRIED)
        if not found:
            raise self._refusal(but, "there is no such thing here")
        return found

    def _certain(self, phrase: Phrase) -> tuple[str, ...]:
        """What 'the apple', 'the apples' or 'all apples' mean.

        Raises:
            UnreadInstruction: there is none, or more than one where one is meant.
        """
        found = self._answers(phrase)
        if not found:
            raise self._refusal(phrase, "there is no such thing here")
        if phrase.quantity in ("all",) or phrase.count is None:
            self._taken += found
            return tuple(found)
        found = self._named_before(phrase, found)
        if len(found) > 1:
            raise self._refusal(phrase, f"it may be {_either(found)}")
        self._taken += found
        return tuple(found)

    def _named_before(self, phrase: Phrase, found: list[str]) -> list[str]:
        """Of several that 'the mug' may mean the one that was called a mug before."""
        before = [
            name
            for other, names in self._meant.items()
            if other.start < phrase.start and other.head == phrase.head
            for name in names
        ]
        places = [r.place for r in self._requests if r.place is not None and r.place.lemmas[-1:] == phrase.lemmas[-1:]]
        for place in places if len(found) > 1 else []:
            if (place.start < phrase.start and not place.plural and place.lemmas != phrase.lemmas) or place.colour:
                before += meant(place, self._things, Meaning.ANY)
        narrowed = [name for name in found if name in before]
        return narrowed if len(narrowed) == 1 else found

    def _choice(self, phrase: Phrase) -> tuple[str, ...]:
        """What 'an apple', 'two apples', 'both mugs' or 'the other' mean.

        Raises:
            UnreadInstruction: there are too few.
        """
        found = self._answers(phrase)
        if not found:
            raise self._refusal(phrase, "there is no such thing here")
        places = self._places_before(phrase) if phrase.quantity == "rest" else []
        left = [name for name in found if name not in (*self._taken, *places)]
        count = phrase.count
        if phrase.quantity == "rest":
            if not left or (count == 1 and len(left) > 1):
                raise self._refusal(phrase, f"it may be {_either(left)}" if left else "there is none left")
            chosen = left
        elif phrase.quantity in ("the", "both", "all") and count is not None:
            if len(found) != count and not (phrase.quantity == "the" and len(left) == count):
                raise self._refusal(phrase, f"there are {len(found)} of them")
            chosen = found if len(found) == count else left
        else:
            wanted = (2 if len(left) > 2 else len(left)) if count is None else count
            if len(left) < wanted:
                raise self._refusal(phrase, f"there are only {len(left)} of them")
            chosen = left[:wanted]
        self._taken += chosen
        return tuple(chosen)

    def _untouched(self, goals: Sequence[AskedGoal]) -> list[str]:
        """The objects that are not to be touched.

        Raises:
            UnreadInstruction: a goal needs one of them.
        """
        found: dict[str, Phrase] = {}
        for request in self._requests:
            if request.asked != "leave":
                continue
            for phrase in request.things if request.preposition not in ("open", "close") else ():
                names = meant(phrase, self._things, Meaning.CARRIED) or meant(phrase, self._things, Meaning.MOVING)
                if not names:
                    raise self._refusal(phrase, "there is no such thing here")
                if request.preposition:
                    word = {"press": "pressed", "turn": "turned", "scan": "scanned"}
                    asked = word.get(request.preposition, "weighed")
                    if any(g.goal.relation == asked and g.goal.subject in names for g in goals):
                        raise self._refusal(phrase, "it contradicts the rest")
                    continue
                found |= dict.fromkeys(names, phrase)
        touched = {g.goal.subject for g in goals}
        touched |= {str(g.goal.reference) for g in goals if g.goal.part is not None}
        both = [name for name in found if name in touched]
        if both:
            raise self._refusal(found[both[0]], f"{' and '.join(both)} shall be left alone and moved")
        return list(found)

    def _places_before(self, phrase: Phrase) -> list[str]:
        """What things were put in, on or beside before 'the others': 'the red block on the blue one, the others …'."""
        places = [r.place for r in self._requests if r.place is not None and r.place.start < phrase.start]
        return [
            name for place in places if place.lemmas != (TABLE,) for name in meant(place, self._things, Meaning.ANY)
        ]

    def _kept(self, goals: list[AskedGoal]) -> list[AskedGoal]:
        """With what shall not be closed opened before it is used, so that it stays open.

        Raises:
            UnreadInstruction: what shall not be closed, or not be opened, is so for another goal.
        """
        for request in (r for r in self._requests if r.asked == "leave" and r.preposition in ("open", "close")):
            denied = "closed" if request.preposition == "close" else "open"
            for phrase in request.things:
                for name, part in self._parts(phrase, request.preposition):
                    told = [g.goal.relation for g in goals if (g.goal.subject, g.goal.part) == (name, part)]
                    used = self._uses(name, part, goals)
                    if denied in told or (used and denied == "open"):
                        raise self._refusal(phrase, "it contradicts the rest")
                    if used and not told:
                        words = self._instruction[request.start : request.end]
                        goal = Goal(subject=name, relation="open", part=part)
                        goals = [
                            *(g.model_copy(update={"step": g.step + (g.step >= min(used))}) for g in goals),
                            AskedGoal(goal=goal, step=min(used), words=words),
                        ]
        return sorted(goals, key=lambda g: g.step)

    def _uses(self, name: str, part: str, goals: Sequence[AskedGoal]) -> list[int]:
        """The steps in which something is put into what a part closes, or taken out of it."""
        inside = [g for g in goals if g.goal.relation == "inside" and g.goal.reference == name]
        taken = [(r.step, place) for r in self._requests if r.asked != "leave" for _, place in r.sources]
        into = [g.step for g in inside if g.goal.part in (None, part)]
        return [*into, *(step for step, place in taken if (name, part) in self._parts_named(place))]

    def _require_sources(self) -> None:
        """That what things are taken out of is there.

        Raises:
            UnreadInstruction: something is not.
        """
        for place in (place for request in self._requests for _, place in request.sources):
            if not meant(place, self._things, Meaning.ANY) and not (place.part and self._parts_named(place)):
                raise self._refusal(place, "there is no such thing here")

    def _require_sense(self, goals: Sequence[AskedGoal]) -> None:
        """That all that shall be true at the end can be.

        Raises:
            UnreadInstruction: goals contradict each other.
        """
        turned = [asked for asked in goals if asked.goal.relation == "turned"]
        for number, asked in enumerate(turned):
            if asked.goal in [earlier.goal for earlier in turned[:number]]:
                raise UnreadInstruction.of(self._instruction, asked.words, "it is turned as far as it goes by then")
        standing = [
            Relation.model_validate({"subject": g.subject, "relation": g.relation, "reference": g.reference})
            for g in lasting(in_steps(goals))
            if g.reference is not None and g.reference != TABLE
        ]
        found = contradictions(standing)
        if found:
            raise UnreadInstruction.of(self._instruction, self._instruction, f"it contradicts itself: {found[0]}")
        tops = [g.reference for g in lasting(in_steps(goals)) if g.relation == "on" and g.reference in self._things]
        for name in {top for top in tops if tops.count(top) > 1}:
            if max(self._things[str(name)].size[:2]) < SMALL:
                raise UnreadInstruction.of(self._instruction, self._words_for(str(name)), "only one thing goes on it")

    # --- which goals -----------------------------------------------------------------------------------

    def _goals(self, request: Request) -> list[Goal]:
        """What must be true after a request."""
        for phrase in request.things:
            if phrase.part is not None and phrase.part not in phrase.lemmas:  # 'the lid of the jar'
                raise self._refusal(phrase, f"its {phrase.part} is not moved by itself")
        names = [name for phrase in request.things for name in self._meant[phrase]]
        self._know_tools(request)
        if request.asked in ("open", "close", "press", "turn"):
            word: GoalWord = {"open": "open", "close": "closed", "press": "pressed", "turn": "turned"}[request.asked]  # pyrefly: ignore
            assert request.place is not None  # the reader names what is operated
            water = request.asked == "turn" and request.place.lemmas == ("water",)
            parts = self._parts(replace(request.place, lemmas=("tap",)) if water else request.place, request.asked)
            self._operated += parts
            return [Goal(subject=name, relation=word, part=part) for name, part in parts]
        if request.asked in ("scan", "weigh", "present", "back"):
            word = {"scan": "scanned", "weigh": "weighed", "present": "presented", "back": "back"}[request.asked]  # pyrefly: ignore
            self._require_tool(request)
            self._require_no_tool(request, names)
            return [Goal(subject=name, relation=word) for name in self._carried(names)]
        if request.asked == "hand":
            return [
                Goal(subject=name, relation="handed", reference=request.preposition) for name in self._carried(names)
            ]
        if request.asked == "tower":
            return self._tower(request, names)
        return self._put(request, names)

    def _put(self, request: Request, names: list[str]) -> list[Goal]:
        if request.place is None:
            raise UnreadInstruction.of(
                self._instruction, self._instruction[request.start : request.end], "it says no place"
            )
        if request.place in request.things and len(names) == 2 and request.preposition in (*BESIDE, "on"):
            relation: GoalWord = request.preposition  # pyrefly: ignore
            return [Goal(subject=names[0], relation=relation, reference=names[1])]  # 'next to each other'
        if request.preposition in BESIDE:
            reference = self._reference(request.place)
            word: GoalWord = request.preposition  # pyrefly: ignore
            if reference in names:
                raise self._refusal(request.place, "it is the thing itself")
            return [Goal(subject=name, relation=word, reference=reference) for name in names]
        names = self._carried(names)
        places = self._holders(request, names)
        if len(names) > 1 and len(places) == 1 and self._is_small_top(places[0]):
            raise self._refusal(request.place, "only one thing goes there")
        return [
            Goal(
                subject=name,
                relation="inside" if place.holds == "in" else "on",
                reference=place.id,
                part=place.part,
            )
            for name, place in zip(names, itertools.cycle(places), strict=False)
        ]

    def _is_small_top(self, place: _Place) -> bool:
        entry = self._things.get(place.id)
        return entry is not None and entry.words.category == "toy" and place.holds == "on"

    def _tower(self, request: Request, names: list[str]) -> list[Goal]:
        """Each on the one before it."""
        names = self._carried(names)
        if len(names) < 2:
            raise self._refusal(request.things[0], "one thing is no stack")
        flat = [n for n in names[:-1] if not any(p.holds == "on" for p in self._things[n].functional_points)]
        if flat:
            raise self._refusal(request.things[0], f"nothing stands on the {self._things[flat[0]].words.name}")
        return [Goal(subject=a, relation="on", reference=b) for b, a in itertools.pairwise(names)]

    def _carried(self, names: list[str]) -> list[str]:
        """The objects, if all can be carried.

        Raises:
            UnreadInstruction: one cannot.
        """
        for name in names:
            entry = self._things[name]
            if not entry.can_be_carried:
                raise UnreadInstruction.of(
                    self._instruction, self._words_for(name), f"the robot cannot pick up the {entry.words.name}"
                )
        return names

    def _require_tool(self, request: Request) -> None:
        """That what is needed is there: a scanner to scan with, a scale to weigh on."""
        needed = _TOOLS.get(request.asked)
        if needed and all(entry.name != needed for entry in self._things.values()):
            raise UnreadInstruction.of(
                self._instruction,
                self._instruction[request.start : request.end],
                f"there is no {needed.replace('_', ' ')} here",
            )

    def _require_no_tool(self, request: Request, names: Sequence[str]) -> None:
        """That 'everything' that is scanned does not hold the scanner."""
        needed = _TOOLS.get(request.asked)
        if any(self._things[name].name == needed for name in names):
            words = self._instruction[request.start : request.end]
            raise UnreadInstruction.of(self._instruction, words, "the tool for it is among the things")

    def _know_tools(self, request: Request) -> None:
        """That tools which are named are those that the robot would take."""
        needed = _TOOLS.get(request.asked)
        named = [*request.tools, *([request.place] if request.asked == "weigh" and request.place else [])]
        for phrase in named:
            found = meant(phrase, self._things, Meaning.CARRIED)
            if needed is None or not any(self._things[name].name == needed for name in found):
                raise self._refusal(phrase, "that is no tool for it")

    # --- which places ----------------------------------------------------------------------------------

    def _reference(self, place: Phrase) -> str:
        """The one object that another stands beside.

        Raises:
            UnreadInstruction: there is none, or several.
        """
        if place.part is not None:
            full = replace(place, lemmas=tuple(w for w in lemmas(place.text) if w != "of"), part=None, which=())
            if not meant(full, self._things, Meaning.ANY):
                raise self._refusal(place, "nothing is put beside a part")
            place = full
        found = [name for phrase, names in self._meant.items() if phrase == place for name in names]
        found = found or meant(place, self._things, Meaning.ANY)
        if not found:
            raise self._refusal(place, "there is no such thing here")
        found = self._named_before(place, found)
        if len(found) > 1 and place.quantity != "a":
            raise self._refusal(place, f"it may be {_either(found)}")
        return found[0]

    def _holders(self, request: Request, names: Sequence[str]) -> list[_Place]:
        """Where things go; several places only where the words name several.

        Raises:
            UnreadInstruction: nothing of the kind holds things in this way, or several do.
        """
        place = request.place
        assert place is not None  # checked by the caller
        if place.lemmas == (TABLE,):
            return [_Place(TABLE, None, "on")]
        key = (place, request.preposition)
        if key in self._places:
            return [self._places[key]]
        found = self._candidates(place, request.preposition, names)
        if not found:
            raise self._refusal(place, f"nothing can be put {request.preposition} it, or it is not there")
        if place.quantity == "rest":
            found = [self._remaining(place, found)]
        if place.plural:
            if len(found) > len(names) or (place.part is None and len(found) != len(names)):
                raise self._refusal(place, f"{len(names)} things do not go to {len(found)} places one by one")
            return found
        if place.quantity == "a":
            found = [p for p in found if p not in self._places.values()] or found
        else:
            found = [self._the_one(place, found)]
        self._places[key] = found[0]
        return [found[0]]

    def _remaining(self, place: Phrase, found: Sequence[_Place]) -> _Place:
        """'The other drawer': the one of some places that nothing was put in yet."""

        def spot(p: _Place) -> str:
            return p.id if place.part is None else f"{p.id}/{p.part}"

        used = set(map(spot, self._places.values()))
        left = [p for p in found if spot(p) not in used]
        if len(left) == 1 and used:
            return left[0]
        raise self._refusal(place, f"it may be {_either([p.id for p in left])}" if left else "there is no other")

    def _the_one(self, place: Phrase, found: list[_Place]) -> _Place:
        """The only one of some places that the words mean: the object that was named before, or the same part of it."""
        if len(found) > 1 and not _one_object(found):
            known = self._named_before(place, list(dict.fromkeys(p.id for p in found)))
            found = [p for p in found if p.id in known]
        if len(found) > 1 and not _one_object(found):
            raise self._refusal(place, f"it may be {_either([p.id for p in found])}")
        if len(found) > 1 and place.part is not None and not place.which and place.quantity == "the":
            before = [p for k, p in self._places.items() if k[0].part == place.part and k[0].start < place.start]  # pyrefly: ignore
            found = [before[-1]] if before and before[-1] in found else found  # 'in that same drawer'
        if len(found) > 1 and place.part is not None:
            raise self._refusal(place, f"it may be {_either([str(p.part) for p in found])}")
        return found[0]

    def _candidates(self, place: Phrase, preposition: str, names: Sequence[str]) -> list[_Place]:
        """Every place that the words fit."""
        if place.part is not None:
            whole = replace(place, lemmas=tuple(w for w in lemmas(place.text) if w != "of"), part=None, which=())
            named = meant(whole, self._things, Meaning.ANY) if not place.which else []
            exact = [name for name in named if name not in names]
            if exact and (preposition == "on" or place.head != place.part):
                return self._of_objects(exact, preposition, place)
            if preposition in ("in", "to"):
                return [
                    _Place(name, part, "in")
                    for name, part in self._parts_named(place)
                    if any(p.link == part and p.holds == "in" for p in self._things[name].functional_points)
                ]
            if preposition == "on" and place.part in ("drawer",):
                return []
        known = [name for phrase, found in self._meant.items() if phrase == place for name in found]
        return self._of_objects(known or meant(place, self._things, Meaning.HOLDS, names), preposition, place)

    def _of_objects(self, found: Iterable[str], preposition: str, place: Phrase) -> list[_Place]:
        """The places that objects offer for a preposition."""
        places: list[_Place] = []
        for name in found:
            points = self._things[name].functional_points
            inside = [p for p in points if p.holds == "in"]
            top = [p for p in points if p.holds == "on"]
            shallow = bool(SHALLOW.intersection((*lemmas(self._things[name].words.name), *place.lemmas)))
            wanted = {"in": inside or (top if shallow else []), "on": top or (inside if shallow else [])}
            options = wanted.get(preposition, inside or top)
            links = dict.fromkeys((p.link, p.holds) for p in options)
            places += [_Place(name, link, holds) for link, holds in links]
        return places

    def _parts(self, phrase: Phrase, asked: str) -> list[tuple[str, str]]:
        """The moving parts that are to be opened, closed, pressed or turned.

        Raises:
            UnreadInstruction: there is none, or several where one is meant.
        """
        found = self._parts_named(phrase)
        action = asked if asked in ("press", "turn") else "open"
        fitting = [(name, part) for name, part in found if part_that(action, part)]
        if not fitting:
            raise self._refusal(phrase, f"nothing of it can be {asked}{'ed' if asked != 'close' else 'd'}")
        fitting = self._of_these(fitting, phrase)
        if phrase.plural:
            return fitting
        known = self._owners_named_before(phrase) if phrase.lemmas == (phrase.part,) else set()
        fitting = [(name, part) for name, part in fitting if name in known] or fitting
        if len(fitting) > 1 and phrase.part is not None and not phrase.which:  # 'shut that drawer'
            before = [r.place for r in self._requests if r.place is not None and r.place.start < phrase.start]
            same = [place for place in before if place.part == phrase.part and place.which]
            fitting = self._parts_named(same[-1]) if same else fitting
        if len(fitting) > 1 and phrase.quantity != "a":
            raise self._refusal(phrase, f"it may be {_either([f'{n}/{p}' for n, p in fitting])}")
        return fitting[:1]

    def _of_these(self, fitting: list[tuple[str, str]], phrase: Phrase) -> list[tuple[str, str]]:
        """Without parts that are left out or were named before, and as many as are asked for.

        Raises:
            UnreadInstruction: that leaves none, or the exception leaves out nothing.
        """
        if phrase.but:
            left = {
                found
                for but in phrase.but
                for found in self._parts_named(replace(phrase, which=but.which or but.lemmas[:-1], but=(), count=1))
            }
            kept = [found for found in fitting if found not in left]
            if len(kept) == len(fitting):
                raise self._refusal(phrase, "what is left out is not there")
            fitting = kept
        if phrase.quantity == "rest":
            used = [*self._operated, *((p.id, p.part) for p in self._places.values())]
            known = any(found in used for found in fitting)
            fitting = [found for found in fitting if found not in used]
            if not known or not fitting or (len(fitting) > 1 and not phrase.plural):
                raise self._refusal(phrase, "it is not clear which other one")
        if phrase.plural and phrase.count is not None:
            if phrase.quantity != "a" and len(fitting) != phrase.count:
                raise self._refusal(phrase, f"there are {len(fitting)} of them")
            fitting = fitting[: phrase.count]
        return fitting

    def _owners_named_before(self, phrase: Phrase) -> set[str]:
        """The objects that were named before 'the lid'."""
        places = [r.place for r in self._requests if r.place is not None and r.place.start < phrase.start]
        named = [
            name for place in places if place.lemmas != (TABLE,) for name in meant(place, self._things, Meaning.ANY)
        ]
        return {*named, *(n for p, names in self._meant.items() if p.start < phrase.start for n in names)}

    def _parts_named(self, phrase: Phrase) -> list[tuple[str, str]]:
        """(object, part) for every moving part that a phrase fits."""
        if phrase.part is None:
            owners = meant(phrase, self._things, Meaning.MOVING)
            return [(name, part) for name in owners for part in sorted(self._things[name].moving_parts, key=_height)]
        alone = phrase.lemmas == (phrase.part,)
        bare = tuple(word for word in phrase.lemmas if word != phrase.part)
        owners = list(self._things) if alone else meant(replace(phrase, part=None), self._things, Meaning.MOVING)
        if not owners and bare:
            owners = meant(replace(phrase, lemmas=bare, part=None), self._things, Meaning.MOVING)
        if alone and phrase.colour is not None:
            owners = [n for n in owners if phrase.colour in self._things[n].variants[0].colour]
        same = _SAME_PART.get(phrase.part, (phrase.part,))
        found: list[tuple[str, str]] = []
        for name in owners:
            parts = [p for p in self._things[name].moving_parts if p.split("_")[0] in same]
            parts.sort(key=_height)
            if phrase.which:
                parts = _told_apart(parts, phrase.which, phrase.count or 1)
            found += [(name, part) for part in parts]
        if phrase.which and phrase.count is None and len({name for name, _ in found}) < 2:
            return []  # 'the lower drawers': nobody can tell how many
        return found

    def _refusal(self, phrase: Phrase, why: str) -> UnreadInstruction:
        return UnreadInstruction.of(self._instruction, phrase.as_typed(self._instruction), why)

    def _words_for(self, name: str) -> str:
        """The instruction's own words for an object; its name where there are none."""
        phrases = [p for p, names in self._meant.items() if name in names]
        phrases += [r.place for r in self._requests if r.place and name in meant(r.place, self._things, Meaning.ANY)]
        return phrases[0].as_typed(self._instruction) if phrases else self._things[name].words.name


def _height(part: str) -> int:
    """Top drawers first."""
    return {"top": 0, "middle": 1, "bottom": 2}.get(part.rpartition("_")[2], 0)


def _told_apart(parts: Sequence[str], which: Sequence[str], count: int) -> Sequence[str]:
    """The parts that ordinals tell from the others, from the top down; none where there are too few.

    Args:
        which: 'second', 'bottom', or both: 'the second lowest'.
        count: how many: 'the top two'.
    """
    *counted, end = which
    number = COUNTED.index(end) + 1 if end in COUNTED else 1
    if end in COUNTED or len(parts) < 2 or count > len(parts):
        single = len(parts) > 1 and not counted and (count == 1 or number == 1)
        return parts[number - 1 : number - 1 + count] if single and number - 1 + count <= len(parts) else []
    if end == "middle":
        return [parts[1]] if len(parts) == 3 and count == 1 and not counted else []
    if end not in (*HIGHEST, *LOWEST, "last"):
        return []
    ordered = parts if end in HIGHEST else parts[::-1]
    if counted:
        at = COUNTED.index(counted[0]) if len(counted) == 1 and counted[0] in COUNTED and count == 1 else len(parts)
        return ordered[at : at + 1]
    return sorted(ordered[:count], key=_height)


def _one_object(places: Sequence[_Place]) -> bool:
    return len({p.id for p in places}) == 1


def _either(names: Sequence[str]) -> str:
    return " or ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def _once(goals: Iterable[AskedGoal]) -> Iterable[AskedGoal]:
    """Without goals that are asked for twice in one step, and those that are true when they are asked for."""
    known: set[tuple[str, int]] = set()
    state: dict[tuple[str, str | None], Goal] = {}
    for asked in goals:
        goal, key = asked.goal, (str(asked.goal), asked.step)
        lasts = goal.relation in ("open", "closed", "inside", "on")
        part = (goal.subject, None if goal.reference else goal.part)
        if key in known or (lasts and state.get(part) == goal):
            continue
        known.add(key)
        if lasts or goal.relation in ("back", *BESIDE):
            state[part] = goal
        yield asked
