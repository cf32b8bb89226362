"""The highest CRF that passes, in few trials."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class BisectionSettings:
    """Guesses of the next trial. They change the number of trials, never the result.

    Args:
        growth_per_crf: growth of ln(loss) per CRF step: the median of 15 pairs of CRFs on five rendered clips, of HEVC.
        least_growth, most_growth: limits on the growth between two trials: close ones of little loss give any.
        guesses: trials by the expected growth; then the range is halved.
    """

    growth_per_crf: float = 0.22
    least_growth: float = 0.08
    most_growth: float = 0.4
    guesses: int = 5


SETTINGS = BisectionSettings()


def highest_passing(
    loss_at: Callable[[int], float], threshold: float, upper: int, first: int, lower: int = 0
) -> int | None:
    """Return the highest CRF in ``lower`` … ``upper`` with ``loss_at(crf) < threshold``, if the loss grows with it.

    Each trial is made where the losses of the last two predict the threshold; from the sixth on, in the middle of the
    remaining range.

    Args:
        loss_at: the loss at a CRF.
        threshold: upper limit of the loss.
        upper: the highest CRF to consider; below ``lower`` for none.
        first: the first CRF to try.
        lower: the lowest CRF to consider.

    Returns:
        None when the loss at ``lower`` is too large already.
    """
    passes, fails = lower - 1, max(upper + 1, lower)
    losses: dict[int, float] = {}
    guess = first
    while fails - passes > 1:
        guess = min(max(guess, passes + 1), fails - 1)
        losses[guess] = loss_at(guess)
        if losses[guess] < threshold:
            passes = guess
        else:
            fails = guess
        guess = expected(losses, threshold) if len(losses) < SETTINGS.guesses else (passes + fails) // 2
    return passes if passes >= lower else None


def expected(losses: dict[int, float], threshold: float) -> int:
    """Return the CRF that should be the highest to pass, by the losses of trials in their order.

    Where that was tried and passed, return the next one.
    """
    (*before, last), growth = losses, SETTINGS.growth_per_crf
    if before and losses[last] > 0 and losses[before[-1]] > 0:
        seen = math.log(losses[last] / losses[before[-1]]) / (last - before[-1])
        growth = min(max(seen, SETTINGS.least_growth), SETTINGS.most_growth)
    guess = last + math.floor(steps_to(threshold, losses[last], growth))
    return guess + 1 if guess in losses and losses[guess] < threshold else guess


def steps_to(threshold: float, loss: float, growth: float = SETTINGS.growth_per_crf) -> float:
    """Return the CRF steps from a trial's loss to ``threshold``, at the usual growth."""
    return math.log(threshold / max(loss, 1e-6)) / growth
