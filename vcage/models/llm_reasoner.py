"""The reasoner behind any answerer: prompts, answer types from the scene's contents, and their checks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from vcage.base.text import one_line
from vcage.models import prompts
from vcage.models.checked_reading import Instructed
from vcage.models.exchange import Answerer
from vcage.models.llm_reading import read_goals
from vcage.models.llm_selection import select_assets
from vcage.models.llm_slots import answer_type, complaints, meaning
from vcage.models.same_reading import ThirdReader
from vcage.models.search import Search, best_search
from vcage.models.structured import Answer, asking, narrowed, one_of
from vcage.models.wordings import TaskToWord, TaskWordings
from vcage.plans.check import PlanCheck
from vcage.plans.plain_words import goal_in_words, in_words
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import Reading
from vcage.schema.plan import TABLE, LayoutPlan, Relation, RelationWord, Selection, SelectionCheck
from vcage.schema.scene import PLAIN, Scene
from vcage.schema.subtasks import PairAnswer, PairQuestion, SlotAnswer, SlotQuestion


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


class _Sentence(Answer):
    sentence: str


class _WordingsAnswer(Answer):
    sentences: list[_Sentence]


class LlmReasoner:
    """Implements :class:`vcage.models.protocols.Reasoner`, which documents the arguments.

    ``rng`` is not used, since the model chooses.

    Raises (all methods): ModelRefused, AnswerNeeded, EndpointFailed, ConfigurationError; see
    :func:`vcage.models.structured.ask`.
    """

    def __init__(
        self,
        who: Answerer,
        search: Callable[[], Search] = best_search,
        reviewer: Answerer | None = None,
        third: ThirdReader | None = None,
    ):
        """Ask a model.

        Args:
            who: is asked.
            search: makes the search that narrows a large catalogue.
            reviewer: compares a reading with the instruction; None for no such review.
            third: reads without a model; where it can, its reading must match the model's.
        """
        self._search = search
        self._reviewer = None if reviewer is None else asking(reviewer, "reasoner")
        self._third = third
        self._ask = asking(who, "reasoner")
        self.provider = who.provider

    def select_assets(
        self,
        instruction: str,
        catalogue: Sequence[CatalogueEntry],
        rng: np.random.Generator,
        check: SelectionCheck,
        scene: str = PLAIN,
    ) -> Selection:
        """See :func:`vcage.models.llm_selection.select_assets`."""
        return select_assets(self._ask, instruction, catalogue, check, scene, self._search)

    def plan_layout(
        self, scene: Scene, catalogue: Sequence[CatalogueEntry], rng: np.random.Generator, check: PlanCheck
    ) -> LayoutPlan:
        """The model's plan; relations name objects of the scene only, and ``check`` has no complaint."""
        ids = [record.id for record in scene.objects if not record.rides]
        item = narrowed(_PlannedRelation, subject=one_of(ids), reference=one_of([*ids, TABLE]))
        answer = narrowed(_LayoutAnswer, relations=list[item])
        entries, phrases = {entry.name: entry for entry in catalogue}, {o.id: o.phrase for o in scene.objects}
        described = [in_words(d, phrases) for d in scene.laid_out]
        goals = [goal_in_words(asked.goal, phrases) for asked in scene.goals]
        prompt = prompts.fill("plan_layout", scene=scene, entries=entries, goals=goals, described=described)
        return _plan(self._ask(prompt, answer, lambda a: _plan_complaints(a, check)))

    def judge_pairs(
        self, questions: Sequence[PairQuestion], instruction: str | None = None, at_once: int = 30
    ) -> list[PairAnswer]:
        """One answer per question; pairs that look and measure alike are asked about once, ``at_once`` in a prompt."""
        different = list({_looks(question): question for question in questions}.values())
        judged: dict[tuple[object, ...], _JudgedPair] = {}
        for start in range(0, len(different), at_once):
            batch = different[start : start + at_once]
            judged |= zip(map(_looks, batch), self._judge_batch(batch, instruction), strict=True)
        found = [(question, judged[_looks(question)]) for question in questions]
        return [
            PairAnswer(object=q.object, receptacle=q.receptacle, sensible=pair.sensible, reason=pair.reason)
            for q, pair in found
        ]

    def _judge_batch(self, questions: Sequence[PairQuestion], instruction: str | None) -> list[_JudgedPair]:
        prompt = prompts.fill("judge_pairs", questions=list(questions), instruction=instruction)
        return self._ask(prompt, _PairsAnswer, lambda a: _pair_complaints(a.pairs, len(questions))).pairs

    def fill_slots(
        self, instruction: str | None, questions: Sequence[SlotQuestion], at_once: int = 20
    ) -> list[SlotAnswer]:
        """The model's choices among what is feasible, asked for the chain, ``at_once`` sub-tasks in a prompt."""
        found: list[SlotAnswer] = []
        for start in range(0, len(questions), at_once):
            batch = questions[start : start + at_once]
            prompt = prompts.fill("fill_slots", instruction=instruction, questions=list(batch))
            answer = self._ask(prompt, answer_type(batch), partial(complaints, questions=batch))
            found += meaning(answer, batch)
        return found

    def read_goals(self, asked: Instructed) -> Reading:
        """See :func:`vcage.models.llm_reading.read_goals`."""
        return read_goals(self._ask, asked, self._reviewer, self._third)

    def word_task(self, task: TaskToWord, plain: Sequence[str], examples: int = 3) -> TaskWordings:
        """Ask once for sentences; where none passes the review, once more, with their faults.

        Args:
            task, plain: see :meth:`vcage.models.protocols.Reasoner.word_task`.
            examples: how many of the plain sentences the prompt shows.
        """

        complained = False

        def complaints(answer: _WordingsAnswer) -> list[str]:
            nonlocal complained
            if complained or task.reviewed(_texts(answer)):
                return []
            complained = True
            wrong = [f"{text!r}: {'; '.join(task.complaints(text))}" for text in _texts(answer)]
            return wrong or ["sentences: is empty"]

        prompt = prompts.fill("word_task", task=task, plain=list(plain[:examples]))
        proposed = _texts(self._ask(prompt, _WordingsAnswer, complaints))
        sentences = task.reviewed(proposed)
        return TaskWordings(sentences, len(proposed) - len(sentences))


def _texts(answer: _WordingsAnswer) -> list[str]:
    return list(dict.fromkeys(one_line(item.sentence).strip() for item in answer.sentences))


def _plan_complaints(answer: _LayoutAnswer, check: PlanCheck) -> list[str]:
    empty = [f"{field}: is empty" for field in ("text", "relations") if not getattr(answer, field)]
    return empty or list(check(_plan(answer)))


def _plan(answer: _LayoutAnswer) -> LayoutPlan:
    return LayoutPlan(text=answer.text, relations=[Relation(**r.model_dump()) for r in answer.relations])


def _looks(question: PairQuestion) -> tuple[object, ...]:
    """Everything a model is told of a pair: two pairs alike in it get one answer."""
    return tuple(value for name, value in question if name not in ("object", "receptacle"))


def _pair_complaints(pairs: Sequence[_JudgedPair], count: int) -> list[str]:
    numbers = [pair.number for pair in pairs]
    if numbers != list(range(1, count + 1)):
        return [f"pairs: expected the numbers 1 to {count} once each, in order, got {numbers}"]
    return [f"pairs.{p.number}: reason is empty" for p in pairs if not p.reason.strip()]
