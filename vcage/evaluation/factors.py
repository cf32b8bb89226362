"""One factor of the differences between episodes, changed alone, to see what it costs a policy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from vcage.base.errors import UsageError
from vcage.schema.randomisation import Look, LookRanges, Randomisation
from vcage.sim.robots import load_randomisation

Factor = Literal["light", "camera", "clutter", "colour", "height", "layout"]

FACTORS: tuple[str, ...] = get_args(Factor)

_OF_LOOK: dict[Factor, tuple[str, tuple[str, ...]]] = {
    "light": ("light", ("lights", "ambient")),
    "camera": ("cameras", ("cameras",)),
    "colour": ("colours", ("tints",)),
}
"""Factors that change pictures, and nothing else in an episode: their field of the ranges, and those of a look."""

_OF_WORLD: dict[Factor, str] = {"clutter": "clutter", "height": "table_height"}
"""Factors that change the world: their field of its ranges."""

WIDEST = "full"
"""Name of the ranges from which a changed factor is drawn."""


def widened(ranges: Randomisation, factor: Factor) -> Randomisation:
    """The ranges with one factor drawn as widely as the ranges ``full`` do; ``layout`` is none of them.

    Raises:
        UsageError: the factor is drawn as widely already.
    """
    full = load_randomisation(WIDEST)
    look, world = ranges.look, ranges.world
    if factor in _OF_LOOK:
        field, _ = _OF_LOOK[factor]
        look = look.model_copy(update={field: getattr(full.look, field)})
    elif factor in _OF_WORLD:
        field = _OF_WORLD[factor]
        world = world.model_copy(update={field: getattr(full.world, field)})
    if factor != "layout" and (look, world) == (ranges.look, ranges.world):
        raise UsageError(
            f"the ranges {ranges.name!r} draw the {factor} as widely as {WIDEST!r} do, so there is nothing to change",
            hint="leave it out, or compare with narrower ranges: --randomise light",
        )
    return ranges.model_copy(update={"look": look, "world": world})


def require_seen(factor: Factor, pictures: bool) -> None:
    """Require that a change of a factor can change what a policy does.

    Args:
        factor: that is changed.
        pictures: True if pictures are observed.

    Raises:
        UsageError: it changes pictures alone, and none are.
    """
    if factor in _OF_LOOK and not pictures:
        raise UsageError(
            f"the factor {factor} changes only pictures, and none are observed",
            hint=f"leave {factor} out, or observe pictures",
        )


@dataclass(frozen=True)
class OtherLook:
    """A look in which one factor alone is drawn from other ranges.

    Args:
        ranges: of that factor.
        fields: of :class:`~vcage.schema.randomisation.Look` that belong to it.
    """

    ranges: LookRanges
    fields: tuple[str, ...]

    @classmethod
    def of(cls, ranges: Randomisation, factor: Factor) -> OtherLook | None:
        """The other look of a factor; None where the factor is none of looks."""
        if factor not in _OF_LOOK:
            return None
        _, fields = _OF_LOOK[factor]
        return cls(widened(ranges, factor).look, fields)

    def change(self, look: Look, other: Look) -> Look:
        """A look with the factor of the ``other``."""
        return look.model_copy(update={name: getattr(other, name) for name in self.fields})
