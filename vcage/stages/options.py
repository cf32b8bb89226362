"""Options that stages have in common; each stage's own are in its module."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from vcage.base.options import NATURAL, UNSAID, Flag, choice
from vcage.models.registry import CHOICES
from vcage.stages.context import StageContext


@dataclass(frozen=True, kw_only=True)
class StageOptions:
    """Options of every stage. The docstrings of the fields are the help of ``vcage STAGE``."""

    seed: Annotated[int | None, NATURAL, UNSAID] = None
    """of every random choice (default: the run's, or 0)"""
    force: Flag = False
    """make a finished stage again"""

    def context(self) -> StageContext:
        """What the stage needs beyond its files, with the models that these options choose."""
        return StageContext()


@dataclass(frozen=True, kw_only=True)
class ModelOptions(StageOptions):
    """Options of a stage that asks models."""

    models: Annotated[str, choice(CHOICES), UNSAID] = "auto"
    """which models answer (default: auto, that is gemini or openai with a key, else offline)"""

    def context(self) -> StageContext:
        return StageContext(self.models)
