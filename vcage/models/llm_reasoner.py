"""The reasoner behind any chat endpoint: prompts, answer types made of what the scene holds, and their checks."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from vcage.base.errors import NoAssetFits
from vcage.models import prompts
from vcage.models.chat import Chat
from vcage.models.search import Search, best_search, narrow
from vcage.models.structured import Answer, ask, narrowed, one_of
from vcage.objects.catalogue import LEGEND, catalogue_text
from vcage.plans.check import PlanCheck
from vcage.schema.asset import CatalogueEntry
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
from vcage.schema.subtasks import ChainOption, PairAnswer, PairQuestion

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
    text: str


class _PairsAnswer(Answer):
    pairs: list[_JudgedPair]


class _ChainAnswer(Answer):
    reason: str
    chain: list[str]


class LlmReasoner:
    """Implements :class:`vcage.models.protocols.Reasoner`, which says what the arguments are.

    ``rng`` is not used, since the model chooses.

    Raises (all methods): ModelRefused, EndpointFailed, ConfigurationError; see :func:`vcage.models.structured.ask`.
    """

    def __init__(self, chat: Chat, search: Callable[[], Search] = best_search):
        """``search`` makes the search that narrows a large catalogue."""
        self._chat = chat
        self._search = search
        self.provider = chat.provider

    def select_assets(
        self, instruction: str, catalogue: Sequence[CatalogueEntry], rng: np.random.Generator, check: SelectionCheck
    ) -> Selection:
        """The model's choice among ``asset/variant`` names of the catalogue, narrowed where it is large."""
        catalogue = narrow(instruction, catalogue, self._search)
        looks = [f"{entry.name}/{variant.id}" for entry in catalogue for variant in entry.variants]
        starts = ["", *(entry.name for entry in catalogue)]
        item = narrowed(_ChosenObject, look=one_of(looks), starts_in=one_of(starts))
        answer = narrowed(_SelectionAnswer, objects=list[item])
        prompt = prompts.fill(
            "select_assets", instruction=instruction, catalogue=catalogue_text(catalogue), legend=LEGEND
        )
        found = ask(self._chat, prompt, answer, complaints=lambda a: _selection_complaints(a, check))
        if found.missing:
            listed = " and ".join(repr(name) for name in found.missing)
            raise NoAssetFits(
                f"no asset of the catalogue matches {listed}",
                hint="`vcage assets list` shows what there is",
                details={"unmatched": list(found.missing)},
            )
        return _selection(found)

    def plan_layout(
        self, scene: Scene, catalogue: Sequence[CatalogueEntry], rng: np.random.Generator, check: PlanCheck
    ) -> LayoutPlan:
        """The model's plan; relations name objects of the scene only, and ``check`` has no complaint."""
        ids = [record.id for record in scene.objects]
        item = narrowed(_PlannedRelation, subject=one_of(ids), reference=one_of([*ids, TABLE]))
        answer = narrowed(_LayoutAnswer, relations=list[item])
        prompt = prompts.fill("plan_layout", scene=scene, entries={entry.name: entry for entry in catalogue})
        return _plan(ask(self._chat, prompt, answer, complaints=lambda a: _plan_complaints(a, check)))

    def judge_pairs(self, questions: Sequence[PairQuestion]) -> list[PairAnswer]:
        """One answer per question, asked in batches."""
        answers: list[PairAnswer] = []
        for start in range(0, len(questions), PAIRS_PER_CALL):
            answers += self._judge_batch(questions[start : start + PAIRS_PER_CALL])
        return answers

    def _judge_batch(self, questions: Sequence[PairQuestion]) -> list[PairAnswer]:
        prompt = prompts.fill("judge_pairs", questions=list(questions))
        found = ask(self._chat, prompt, _PairsAnswer, complaints=lambda a: _pair_complaints(a.pairs, len(questions)))
        return [
            PairAnswer(
                object=question.object,
                receptacle=question.receptacle,
                sensible=pair.sensible,
                reason=pair.reason,
                text=pair.text if pair.sensible else "",
                relation="inside" if question.holds == "in" else "on",
            )
            for question, pair in zip(questions, found.pairs, strict=True)
        ]

    def compose_chain(self, instruction: str, options: Sequence[ChainOption]) -> list[str]:
        """The model's chain; without options there is nothing to ask."""
        if not options:
            return []
        step = one_of([option.id for option in options])
        answer = narrowed(_ChainAnswer, chain=list[step])
        objects = {option.id: option.object for option in options}
        prompt = prompts.fill("compose_chain", instruction=instruction, options=list(options))
        return list(ask(self._chat, prompt, answer, complaints=lambda a: _chain_complaints(a.chain, objects)).chain)


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


def _pair_complaints(pairs: Sequence[_JudgedPair], count: int) -> list[str]:
    numbers = [pair.number for pair in pairs]
    if numbers != list(range(1, count + 1)):
        return [f"pairs: expected the numbers 1 to {count} once each, in order, got {numbers}"]
    found = [f"pairs.{p.number}: reason is empty" for p in pairs if not p.reason.strip()]
    return found + [
        f"pairs.{p.number}: text is empty though sensible" for p in pairs if p.sensible and not p.text.strip()
    ]


def _chain_complaints(chain: Sequence[str], objects: dict[str, str]) -> list[str]:
    moved = [objects[option] for option in chain]
    twice = sorted({name for name in moved if moved.count(name) > 1})
    return [f"chain: moves {name} more than once" for name in twice]
