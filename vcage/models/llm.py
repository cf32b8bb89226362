"""The reasoner behind any chat endpoint: prompts, answer types made of what the scene holds, and their checks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, get_args

import numpy as np
from pydantic import create_model

from vcage.base.errors import NoAssetFits
from vcage.models import prompts
from vcage.models.chat import Chat
from vcage.models.rules.instruction import parse_instruction
from vcage.models.search import Search, best_search, shortlist
from vcage.models.structured import Answer, ask, one_of
from vcage.objects.catalogue import LEGEND, catalogue_line, catalogue_text
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

MOST_KINDS = 150
"""Kinds that a prompt lists; of a larger catalogue those that a search finds for the instruction."""

MOST_CATALOGUE_TEXT = 40_000
"""Characters that the catalogue takes in a prompt: about 10 000 tokens."""


class LlmReasoner:
    """Implements :class:`vcage.models.protocols.Reasoner`; ``rng`` is not used, since the model chooses.

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
        starts = one_of(["", *(entry.name for entry in catalogue)])
        item = _type("Chosen", look=one_of(looks), role=one_of(get_args(Role)), starts_in=starts, reason=str)
        answer = _type("SelectionAnswer", missing=list[str], objects=list[item])
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
        relation = _type(
            "PlannedRelation",
            subject=one_of(ids),
            relation=one_of(get_args(RelationWord)),
            reference=one_of([*ids, TABLE]),
        )
        answer = _type("LayoutAnswer", text=str, relations=list[relation])
        prompt = prompts.fill("plan_layout", scene=scene, entries={entry.name: entry for entry in catalogue})
        found = ask(self._chat, prompt, answer, complaints=lambda a: _read_plan(a, check)[1])
        return _read_plan(found, check)[0]

    def judge_pairs(self, questions: Sequence[PairQuestion]) -> list[PairAnswer]:
        """One answer per question, asked in batches."""
        answers: list[PairAnswer] = []
        for start in range(0, len(questions), PAIRS_PER_CALL):
            answers += self._judge_batch(questions[start : start + PAIRS_PER_CALL])
        return answers

    def _judge_batch(self, questions: Sequence[PairQuestion]) -> list[PairAnswer]:
        item = _type("JudgedPair", number=int, sensible=bool, reason=str, text=str)
        answer = _type("PairsAnswer", pairs=list[item])
        prompt = prompts.fill("judge_pairs", questions=list(questions))
        found = ask(self._chat, prompt, answer, complaints=lambda a: _pair_complaints(a.pairs, len(questions)))
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
        answer = _type("ChainAnswer", reason=str, chain=list[one_of([option.id for option in options])])
        objects = {option.id: option.object for option in options}
        prompt = prompts.fill("compose_chain", instruction=instruction, options=list(options))
        return list(ask(self._chat, prompt, answer, complaints=lambda a: _chain_complaints(a.chain, objects)).chain)


def narrow(instruction: str, catalogue: Sequence[CatalogueEntry], search: Callable[[], Search]) -> list[CatalogueEntry]:
    """The catalogue, or of a large one what answers the instruction or any of its phrases, in the catalogue's order."""
    lengths = {entry.name: len(catalogue_line(entry)) + 1 for entry in catalogue}
    if len(catalogue) <= MOST_KINDS and sum(lengths.values()) <= MOST_CATALOGUE_TEXT:
        return list(catalogue)
    kept: set[str] = set()
    room = MOST_CATALOGUE_TEXT
    for entry in shortlist([instruction, *_named(instruction)], catalogue, search(), MOST_KINDS):
        room -= lengths[entry.name]
        if room < 0:
            break
        kept.add(entry.name)
    return [entry for entry in catalogue if entry.name in kept]


def _named(instruction: str) -> list[str]:
    """Everything that the instruction names, so that each thing is searched for by itself."""
    named = [
        phrase.text
        for request in parse_instruction(instruction)
        for phrase in (*request.contents, *request.tools, *([request.receptacle] if request.receptacle else []))
    ]
    return list(dict.fromkeys(named))


def _type(name: str, **fields: Any) -> type[Answer]:
    """An answer type with these required fields."""
    return create_model(name, __base__=Answer, **{key: (kind, ...) for key, kind in fields.items()})


def _selection_complaints(answer: Any, check: SelectionCheck) -> list[str]:
    if answer.missing:
        return []
    roles = {chosen.role for chosen in answer.objects}
    found = [] if "content" in roles else ["objects: none has the role 'content', so there is nothing to move"]
    found += starting_complaints((chosen.look.partition("/")[0], chosen.starts_in) for chosen in answer.objects)
    return found or list(check(_selection(answer)))


def _selection(answer: Any) -> Selection:
    objects = []
    for chosen in answer.objects:
        asset, _, variant = chosen.look.partition("/")
        starts_in = chosen.starts_in or None
        objects.append(
            SelectedAsset(asset=asset, variant=variant, role=chosen.role, reason=chosen.reason, starts_in=starts_in)
        )
    return Selection(objects=objects)


def _read_plan(answer: Any, check: PlanCheck) -> tuple[LayoutPlan | None, list[str]]:
    """The plan that an answer holds, if it is one, and what is wrong with it."""
    empty = [f"{field}: is empty" for field in ("text", "relations") if not getattr(answer, field)]
    if empty:
        return None, empty
    relations = [Relation(**relation.model_dump()) for relation in answer.relations]
    plan = LayoutPlan(text=answer.text, relations=relations)
    return plan, list(check(plan))


def _pair_complaints(pairs: Sequence[Any], count: int) -> list[str]:
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
