"""The reasoner that needs no model: words, roles and sizes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vcage.models.offline import PROVIDER
from vcage.models.offline.chain import compose_chain
from vcage.models.offline.layout import plan_layout
from vcage.models.offline.receptacles import judge_pair
from vcage.models.offline.selection import Selector
from vcage.schema.asset import CatalogueEntry
from vcage.schema.plan import LayoutPlan, Selection
from vcage.schema.plan_check import PlanCheck, plan_complaints, require_possible
from vcage.schema.scene import Scene
from vcage.schema.subtasks import ChainOption, PairAnswer, PairQuestion


class OfflineReasoner:
    """Implements :class:`vcage.models.protocols.Reasoner` by rules; every random choice comes from ``rng``."""

    provider = PROVIDER

    def select_assets(
        self, instruction: str, catalogue: Sequence[CatalogueEntry], rng: np.random.Generator
    ) -> Selection:
        """See :class:`vcage.models.offline.selection.Selector`."""
        return Selector(instruction, catalogue, rng).select()

    def plan_layout(
        self,
        scene: Scene,
        catalogue: Sequence[CatalogueEntry],
        rng: np.random.Generator,
        check: PlanCheck | None = None,
    ) -> LayoutPlan:
        """See :func:`vcage.models.offline.layout.plan_layout`; roles say all that it needs of the catalogue.

        Raises:
            ModelRefused: the check complains about the plan.
        """
        plan = plan_layout(scene, rng)
        require_possible(self.provider, plan, check or (lambda found: plan_complaints(found, scene)))
        return plan

    def judge_pairs(self, questions: Sequence[PairQuestion]) -> list[PairAnswer]:
        """See :func:`vcage.models.offline.receptacles.judge_pair`."""
        return [judge_pair(question) for question in questions]

    def compose_chain(self, instruction: str, options: Sequence[ChainOption]) -> list[str]:
        """See :func:`vcage.models.offline.chain.compose_chain`."""
        return compose_chain(instruction, options)
