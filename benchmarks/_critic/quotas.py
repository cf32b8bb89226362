"""Quotas of outcomes for each kind of sub-task, and the scenes that can fill them."""

from __future__ import annotations

import logging
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from benchmarks._critic.outcome import OutcomeRecord
from benchmarks._critic.scenes import Draw
from vcage.tasks.templates import TEMPLATES

logger = logging.getLogger(__name__)

Make = Callable[[Sequence[Draw], Sequence[OutcomeRecord]], list[OutcomeRecord]]
"""Makes the outcomes of draws, beside those that there are."""


@dataclass(frozen=True)
class Quotas:
    """Limits of the outcomes made beyond the regular draws.

    Args:
        each: successes, and failures, of each template.
        rounds: most further draws of a scene.
        templates: those to count.
    """

    each: int = 20
    rounds: int = 25
    templates: tuple[str, ...] = tuple(TEMPLATES)


def filled(draws: Sequence[Draw], make: Make, quotas: Quotas) -> list[OutcomeRecord]:
    """Make the outcomes of some draws, then more of the scenes that gave missing ones, until every template has
    enough; templates still short at the end are logged.

    Args:
        draws: what is made in any case.
        make: makes outcomes; called for each round.
        quotas: how many there are to be, and when to stop.
    """
    records, last = make(draws, []), max(draw.seed for draw in draws)
    for seed in range(last + 1, last + 1 + quotas.rounds):
        missing = lacking(records, quotas)
        gave = {record.setting for record in records if record.template in missing}
        again = {draw.scene: draw for draw in draws if draw.scene in gave}
        if not again:
            break
        further = [replace(draw, seed=seed, templates=tuple(missing)) for draw in again.values()]
        records += make(further, records)
    for template, (successes, failures) in lacking(records, quotas).items():
        logger.warning("%s: %d successes and %d failures, of %d each", template, successes, failures, quotas.each)
    return records


def lacking(records: Iterable[OutcomeRecord], quotas: Quotas) -> dict[str, tuple[int, int]]:
    """Templates short of outcomes → its numbers of successes and failures."""
    counts: dict[str, Counter[bool]] = defaultdict(Counter)
    for record in records:
        counts[record.template][record.success] += 1
    found = {template: (counts[template][True], counts[template][False]) for template in quotas.templates}
    return {template: both for template, both in found.items() if min(both) < quotas.each}
