"""The reasoner behind whatever answers questions: prompts, answer types of what the scene holds, and their checks."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np

from vcage.base.commands import vcage_command
from vcage.base.errors import NoAssetFits, UnreadInstruction
from vcage.base.text import one_line
from vcage.models import prompts
from vcage.models.exchange import Answerer
from vcage.models.llm_slots import STEPS_PER_CALL, answer_type, complaints, meaning
from vcage.models.llm_wordings import ask_wordings
from vcage.models.search import Search, best_search, narrow
from vcage.models.structured import Answer, AnswerType, ask, narrowed, one_of, one_or_none
from vcage.models.wordings import TaskToWord, TaskWordings
from vcage.objects.catalogue import LEGEND, catalogue_line
from vcage.plans.check import PlanCheck
from vcage.plans.plain_words import goal_in_words, in_words
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import OF_A_PART, OF_TWO, AskedGoal, Goal, GoalWord, Reading
from vcage.schema.plan import (
    TABLE,
    LayoutPlan,
    Relation,
    RelationWord,
    SelectedAsset,
    Selection,
    SelectionCheck,
    starting_complaints,
)
from vcage.schema.scene import Role, Scene
from vcage.schema.subtasks import PairAnswer, PairQuestion, SlotAnswer, SlotQuestion

PAIRS_PER_CALL = 30
"""Pairs that one prompt asks about."""


class _ChosenObject(Answer):
    look: str
    role: Role
    starts_in: str
    reason: str


class _SelectionAnswer(Answer):
    missing: list[str]
    objects: list[_ChosenObject]


class _PlannedRelation(Answer):
    subject: str
    relation: RelationWord
    reference: str


class _LayoutAnswer(Answer):
    text: str
    relations: list[_PlannedRelation]


class _JudgedPair(Answer):
    number: int
    sensible: bool
    reason: str


class _PairsAnswer(Answer):
    pairs: list[_JudgedPair]


class _ReadGoal(Answer):
    relation: GoalWord
    subject: str
    reference: str
    part: str
    step: int
    words: str


class _GoalsAnswer(Answer):
    unread: list[str]
    goals: list[_ReadGoal]
    untouched: list[str]


class LlmReasoner:
    """Implements :class:`vcage.models.protocols.Reasoner`, which says what the arguments are.

    ``rng`` is not used, since the model chooses.

    Raises (all methods): ModelRefused, AnswerNeeded, EndpointFailed, ConfigurationError; see
    :func:`vcage.models.structured.ask`.
    """

    def __init__(self, who: Answerer, search: Callable[[], Search] = best_search):
        """``search`` makes the search that narrows a large catalogue."""
        self._who = who
        self._search = search
        self.provider = who.provider

    def _ask(
        self, prompt: prompts.Prompt, answer: type[AnswerType], complaints: Callable[[AnswerType], Sequence[str]]
    ) -> AnswerType:
        return ask(self._who, "reasoner", prompt, answer, complaints=complaints)

    def select_assets(
        self, instruction: str, catalogue: Sequence[CatalogueEntry], rng: np.random.Generator, check: SelectionCheck
    ) -> Selection:
        """The model's choice among ``asset/variant`` names of the catalogue, narrowed where it is large."""
        catalogue = narrow(instruction, catalogue, self._search)
        looks = [f"{entry.name}/{variant.id}" for entry in catalogue for variant in entry.variants]
        starts = [entry.name for entry in catalogue]
        item = narrowed(_ChosenObject, look=one_of(looks), starts_in=one_or_none(starts))
        answer = narrowed(_SelectionAnswer, objects=list[item])
        lines = [catalogue_line(entry) for entry in catalogue]
        prompt = prompts.fill("select_assets", instruction=instruction, catalogue=lines, legend=LEGEND)
        found = self._ask(prompt, answer, lambda a: _selection_complaints(a, check))
        if found.missing:
            listed = " and ".join(repr(name) for name in found.missing)
            raise NoAssetFits(
                f"no asset of the catalogue matches {listed}",
                hint="see what there is",
                command=vcage_command("assets", "list"),
                details={"unmatched": list(found.missing)},
            )
        return _selection(found)

    def plan_layout(
        self, scene: Scene, catalogue: Sequence[CatalogueEntry], rng: np.random.Generator, check: PlanCheck
    ) -> LayoutPlan:
        """The model's plan; relations name objects of the scene only, and ``check`` has no complaint."""
        ids = [record.id for record in scene.objects if record.container_part is None]
        item = narrowed(_PlannedRelation, subject=one_of(ids), reference=one_of([*ids, TABLE]))
        answer = narrowed(_LayoutAnswer, relations=list[item])
        entries, phrases = {entry.name: entry for entry in catalogue}, {o.id: o.phrase for o in scene.objects}
        described = [in_words(d, phrases) for d in scene.descriptions if d.part is None]
        goals = [goal_in_words(asked.goal, phrases) for asked in scene.goals]
        prompt = prompts.fill("plan_layout", scene=scene, entries=entries, goals=goals, described=described)
        return _plan(self._ask(prompt, answer, lambda a: _plan_complaints(a, check)))

    def judge_pairs(self, questions: Sequence[PairQuestion], instruction: str | None = None) -> list[PairAnswer]:
        """One answer per question; pairs that look and measure the same are asked about once, in batches."""
        different = list({_looks(question): question for question in questions}.values())
        judged: dict[tuple[object, ...], _JudgedPair] = {}
        for start in range(0, len(different), PAIRS_PER_CALL):
            batch = different[start : start + PAIRS_PER_CALL]
            judged |= zip(map(_looks, batch), self._judge_batch(batch, instruction), strict=True)
        found = [(question, judged[_looks(question)]) for question in questions]
        return [
            PairAnswer(object=q.object, receptacle=q.receptacle, sensible=pair.sensible, reason=pair.reason)
            for q, pair in found
        ]

    def _judge_batch(self, questions: Sequence[PairQuestion], instruction: str | None) -> list[_JudgedPair]:
        prompt = prompts.fill("judge_pairs", questions=list(questions), instruction=instruction)
        return self._ask(prompt, _PairsAnswer, lambda a: _pair_complaints(a.pairs, len(questions))).pairs

    def fill_slots(self, instruction: str | None, questions: Sequence[SlotQuestion]) -> list[SlotAnswer]:
        """The model's choices among what is feasible, asked for the whole chain at once, a long one in batches."""
        found: list[SlotAnswer] = []
        for start in range(0, len(questions), STEPS_PER_CALL):
            batch = questions[start : start + STEPS_PER_CALL]
            prompt = prompts.fill("fill_slots", instruction=instruction, questions=list(batch))
            answer = self._ask(prompt, answer_type(batch), partial(complaints, questions=batch))
            found += meaning(answer, batch)
        return found

    def read_goals(self, instruction: str, things: Mapping[str, CatalogueEntry], lying: Mapping[str, str]) -> Reading:
        """The model's reading; goals name objects and parts of the scene only, and words of the instruction."""
        parts = sorted({part for entry in things.values() for part in entry.moving_parts})
        item = narrowed(
            _ReadGoal,
            subject=one_of(list(things)),
            reference=one_or_none([TABLE, "left", "right", *things]),
            part=one_or_none(parts),
        )
        answer = narrowed(_GoalsAnswer, goals=list[item], untouched=list[one_of(list(things))])  # pyrefly: ignore
        prompt = prompts.fill("read_goals", instruction=instruction, things=dict(things), lying=dict(lying))
        found = self._ask(prompt, answer, lambda a: _goal_complaints(a, instruction, things))
        if found.unread:
            understood = [goal.words for goal in found.goals]
            raise UnreadInstruction.of(instruction, "; ".join(found.unread), "no goal answers it", understood)
        return Reading(goals=[_asked(goal) for goal in found.goals], untouched=list(found.untouched))

    def word_task(self, task: TaskToWord, plain: Sequence[str]) -> TaskWordings:
        """The model's sentences that hold against the review; see :func:`vcage.models.llm_wordings.ask_wordings`."""
        return ask_wordings(self._who, task, plain)


def _selection_complaints(answer: _SelectionAnswer, check: SelectionCheck) -> list[str]:
    if answer.missing:
        return []
    roles = {chosen.role for chosen in answer.objects}
    found = [] if "content" in roles else ["objects: none has the role 'content', so there is nothing to move"]
    found += starting_complaints((chosen.look.partition("/")[0], chosen.starts_in) for chosen in answer.objects)
    return found or list(check(_selection(answer)))


def _selection(answer: _SelectionAnswer) -> Selection:
    return Selection(
        objects=[
            SelectedAsset(
                asset=chosen.look.partition("/")[0],
                variant=chosen.look.partition("/")[2],
                role=chosen.role,
                reason=chosen.reason,
                starts_in=chosen.starts_in or None,
            )
            for chosen in answer.objects
        ]
    )


def _plan_complaints(answer: _LayoutAnswer, check: PlanCheck) -> list[str]:
    empty = [f"{field}: is empty" for field in ("text", "relations") if not getattr(answer, field)]
    return empty or list(check(_plan(answer)))


def _plan(answer: _LayoutAnswer) -> LayoutPlan:
    return LayoutPlan(text=answer.text, relations=[Relation(**r.model_dump()) for r in answer.relations])


def _looks(question: PairQuestion) -> tuple[object, ...]:
    """All that a model is told of a pair: two pairs that are alike in it get one answer."""
    return tuple(value for name, value in question if name not in ("object", "receptacle"))


def _pair_complaints(pairs: Sequence[_JudgedPair], count: int) -> list[str]:
    numbers = [pair.number for pair in pairs]
    if numbers != list(range(1, count + 1)):
        return [f"pairs: expected the numbers 1 to {count} once each, in order, got {numbers}"]
    return [f"pairs.{p.number}: reason is empty" for p in pairs if not p.reason.strip()]


def _goal_complaints(answer: _GoalsAnswer, instruction: str, things: Mapping[str, CatalogueEntry]) -> list[str]:
    if answer.unread:
        return []
    found = [] if answer.goals else ["goals: is empty, and so is unread"]
    for number, goal in enumerate(answer.goals):
        where = f"goals.{number}"
        owner = goal.subject if goal.relation in OF_A_PART else goal.reference
        if not goal.words.strip() or one_line(goal.words) not in one_line(instruction):
            found.append(f"{where}: words are not copied from the instruction: {goal.words!r}")
        if goal.step < 1:
            found.append(f"{where}: step counts from 1, got {goal.step}")
        if (goal.relation in OF_TWO) != bool(goal.reference):
            found.append(f"{where}: {goal.relation!r} takes {'a' if goal.relation in OF_TWO else 'no'} reference")
        elif (goal.relation == "handed") != (goal.reference in ("left", "right")):
            found.append(f"{where}: {goal.reference!r} is no reference for {goal.relation!r}")
        if goal.relation in OF_A_PART and not goal.part:
            found.append(f"{where}: {goal.relation!r} needs the part")
        if goal.part and (owner not in things or goal.part not in things[owner].moving_parts):
            found.append(f"{where}: {owner} has no moving part {goal.part!r}")
        if goal.subject in (goal.reference, *answer.untouched):
            found.append(f"{where}: {goal.subject} is its own reference, or to be left alone")
    return found


def _asked(goal: _ReadGoal) -> AskedGoal:
    told = Goal(subject=goal.subject, relation=goal.relation, reference=goal.reference or None, part=goal.part or None)
    return AskedGoal(goal=told, step=goal.step, words=goal.words)
