"""The reasoner that needs no model: words, roles and sizes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from vcage.base.errors import ModelRefused
from vcage.models.checked_reading import Instructed
from vcage.models.rules import PROVIDER
from vcage.models.rules.layout import plan_layout, plan_scene
from vcage.models.rules.pairs import judge_object_and_place
from vcage.models.rules.readings import read_goals
from vcage.models.rules.selection import select_assets
from vcage.models.wordings import TaskToWord, TaskWordings
from vcage.plans.check import PlanCheck
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import Reading
from vcage.schema.plan import LayoutPlan, Selection, SelectionCheck
from vcage.schema.scene import PLAIN, Scene
from vcage.schema.subtasks import PairAnswer, PairQuestion, SlotAnswer, SlotQuestion

MAX_DRAWS = 5
"""Selections or plans that are drawn before one is refused."""

Drawn = TypeVar("Drawn", Selection, LayoutPlan)


class OfflineReasoner:
    """Implements :class:`vcage.models.protocols.Reasoner` by rules; every random choice comes from ``rng``."""

    provider = PROVIDER

    def select_assets(
        self,
        instruction: str,
        catalogue: Sequence[CatalogueEntry],
        rng: np.random.Generator,
        check: SelectionCheck,
        scene: str = PLAIN,
    ) -> Selection:
        """See :func:`vcage.models.rules.selection.select_assets`."""
        return _first_valid_draw("selection", lambda: select_assets(instruction, catalogue, rng, scene), check)

    def plan_layout(
        self, scene: Scene, catalogue: Sequence[CatalogueEntry], rng: np.random.Generator, check: PlanCheck
    ) -> LayoutPlan:
        """See :func:`vcage.models.rules.layout.plan_layout`; without an instruction
        :func:`vcage.models.rules.layout.plan_scene`."""
        plan = plan_layout if scene.instruction is not None else plan_scene
        return _first_valid_draw("layout plan", lambda: plan(scene, catalogue, rng), check)

    def judge_pairs(self, questions: Sequence[PairQuestion], instruction: str | None = None) -> list[PairAnswer]:
        """See :func:`vcage.models.rules.pairs.judge_object_and_place`; the instruction changes nothing."""
        return [judge_object_and_place(question) for question in questions]

    def fill_slots(self, instruction: str | None, questions: Sequence[SlotQuestion]) -> list[SlotAnswer]:
        """No opinion: everything is done as it is ranked, and nothing more is checked."""
        return [SlotAnswer(subtask=question.subtask) for question in questions]

    def read_goals(self, asked: Instructed) -> Reading:
        """See :func:`vcage.models.rules.readings.read_goals`."""
        return read_goals(asked.instruction, asked.things, asked.lying)

    def word_task(self, task: TaskToWord, plain: Sequence[str]) -> TaskWordings:
        """The sentences of the templates."""
        return TaskWordings(list(plain))


def _first_valid_draw(what: str, draw: Callable[[], Drawn], check: Callable[[Drawn], list[str]]) -> Drawn:
    """The first of :data:`MAX_DRAWS` draws that the check has no complaint about.

    Raises:
        ModelRefused: there is none; lists the complaints about the last.
    """
    complaints: list[str] = []
    seen: set[tuple[str, ...]] = set()
    for _ in range(MAX_DRAWS):
        drawn = draw()
        complaints = check(drawn)
        if not complaints:
            return drawn
        seen.add(tuple(complaints))
    chance = "another --seed, " if len(seen) > 1 else ""  # a fault of every draw is no matter of chance
    raise ModelRefused(
        f"no {what} of {PROVIDER} can be used: {'; '.join(complaints)}",
        hint=f"try {chance}other words, or --models with an online model",
        details={"problems": complaints},
    )
