"""Every question that is asked in words, with a scene small enough for a model of 8,192 tokens.

A prompt that is added is added here, too: ``check.py`` fails where one is missing.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from tests.models.catalogue import unchecked
from tests.models.tabletop import BLOCKS, BOX, MARKERS, PLATE, critic_question, scene_of
from tests.models.test_llm_slots import COIN
from tests.models.test_wordings import ON, task
from vcage.models.checked_reading import Instructed
from vcage.models.exchange import Answerer
from vcage.models.llm_critic import LlmCritic
from vcage.models.llm_reading import _review
from vcage.models.llm_reasoner import LlmReasoner
from vcage.models.llm_selection import _searched
from vcage.models.search import LexicalSearch
from vcage.models.structured import asking
from vcage.objects.library import Library
from vcage.plans.check import plan_complaints
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import AskedGoal, Goal, Reading
from vcage.schema.scene import PLAIN
from vcage.schema.subtasks import PairQuestion

INSTRUCTION = "Put the apple into the bowl"
KINDS = ("apple", "bowl", "mug", "block")

RNG = np.random.default_rng(0)


def entries() -> list[CatalogueEntry]:
    """A few kinds of the library."""
    library = Library.load()
    return [library.entry(name) for name in KINDS]


def select_assets(who: Answerer) -> object:
    return LlmReasoner(who).select_assets(INSTRUCTION, entries(), RNG, unchecked)


def read_goals(who: Answerer) -> object:
    return LlmReasoner(who).read_goals(
        Instructed(INSTRUCTION, {entry.name: entry for entry in entries()}, {"apple": "mug"})
    )


def plan_layout(who: Answerer) -> object:
    scene = scene_of([PLATE, *BLOCKS])
    return LlmReasoner(who).plan_layout(scene, entries(), RNG, partial(plan_complaints, scene=scene))


def judge_pairs(who: Answerer) -> object:
    pair = PairQuestion(
        object="apple", object_words="red apple", receptacle="bowl", receptacle_words="white bowl", holds="in",
        object_size=(0.07, 0.07, 0.07), opening_size=(0.13, 0.13, 0.05),
    )  # fmt: skip
    return LlmReasoner(who).judge_pairs([pair, pair.model_copy(update={"object": "mug", "object_words": "blue mug"})])


def judge_subtask(who: Answerer) -> object:
    goal = Goal(subject="black-marker", relation="inside", reference="box")
    after = [BOX, MARKERS[0].moved(at=BOX.at, base=0.005), *MARKERS[1:]]
    return LlmCritic(who).judge(critic_question([BOX, *MARKERS], after, goal, "Put the black marker into the box."))


def search_catalogue(who: Answerer) -> object:
    return _searched(asking(who, "reasoner"), INSTRUCTION, entries(), PLAIN, LexicalSearch)


def review_goals(who: Answerer) -> object:
    goal = AskedGoal(goal=Goal(subject="apple", relation="inside", reference="bowl"), step=1, words=INSTRUCTION)
    read = Instructed(INSTRUCTION, {entry.name: entry for entry in entries()}, {})
    return _review(Reading(goals=[goal]), read, asking(who, "reasoner"))


def fill_slots(who: Answerer) -> object:
    return LlmReasoner(who).fill_slots(INSTRUCTION, [COIN])


def word_task(who: Answerer) -> object:
    return LlmReasoner(who).word_task(task(ON), ["Put the apple onto the plate."])


QUESTIONS: dict[str, Callable[[Answerer], object]] = {
    "select_assets": select_assets,
    "read_goals": read_goals,
    "plan_layout": plan_layout,
    "judge_pairs": judge_pairs,
    "judge_subtask": judge_subtask,
    "search_catalogue": search_catalogue,
    "review_goals": review_goals,
    "fill_slots": fill_slots,
    "word_task": word_task,
}
"""Name of the prompt → what asks it, through the reasoner or the critic."""

DRAWN = {"rearrange"}
"""Prompts that are answered with a picture."""
