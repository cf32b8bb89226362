"""Options of a run as an environment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, ConfigDict, Field, StrictBool, TypeAdapter, ValidationError

from vcage.base.errors import UsageError
from vcage.evaluation.factors import Factor

Whole = Annotated[
    int, BeforeValidator(lambda given: given.item() if isinstance(given, np.integer) else given), Field(strict=True)
]
"""A whole number, NumPy's too."""


@dataclass(frozen=True)
class EnvironmentOptions:
    """Options of an environment.

    Args:
        chain: number of the task in the run: a run of an instruction has one, a scene done whole one for each sub-task.
        pictures: observe pictures; without, no renderer is needed.
        cameras: whose pictures are observed; all of the robot if empty.
        environment_state: observe the poses of the objects.
        max_steps: actions after which an episode ends; None: twice those of the run's longest accepted episode.
        randomise: ranges of the differences between episodes; None: those of the run's collection.
        layout: drawn for each episode, or as optimised with small shifts; None: as collected.
        vary: the one factor that is changed: drawn as widely as ``full`` does, or the other kind of layout.
    """

    __pydantic_config__ = ConfigDict(extra="forbid")

    chain: Whole = 0
    pictures: StrictBool = True
    cameras: Sequence[str] = ()
    environment_state: StrictBool = False
    max_steps: Annotated[Whole, Field(gt=0)] | None = None
    randomise: str | None = None
    layout: Literal["varied", "fixed"] | None = None
    vary: Factor | None = None

    @classmethod
    def of(cls, options: Mapping[str, Any]) -> EnvironmentOptions:
        """Options by name.

        Raises:
            UsageError: there is no such option, or it takes other values.
        """
        try:
            return TypeAdapter(cls).validate_python(options)
        except ValidationError as error:
            wrong = "; ".join(f"{one['loc'][0]}={one['input']!r}: {one['msg']}" for one in error.errors())
            known = ", ".join(field.name for field in fields(cls))
            raise UsageError(f"an environment cannot be made so: {wrong}", hint=f"the options are {known}") from error
