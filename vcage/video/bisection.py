"""The highest CRF that passes, in few trials."""

from __future__ import annotations

import math
from collections.abc import Callable

LOSS_GROWTH = 0.18
"""Growth of ln(loss) per CRF step on rendered clips; it only makes guesses better, never a result."""

GROWTHS = (0.08, 0.4)
"""What two trials may say of the growth: close ones of little loss say anything."""

GUESSES = 5
"""Trials that go where the losses say the threshold should be; a loss that leaves it open then, is bisected."""


def highest_passing(
    loss_at: Callable[[int], float], threshold: float, upper: int, first: int, lower: int = 0
) -> int | None:
    """The highest CRF in ``lower`` … ``upper`` with ``loss_at(crf) < threshold``, if the loss grows with the CRF.

    Each trial is made where the losses of the last two say the threshold should be; from the sixth on, in the middle
    of what is left.

    Args:
        loss_at: the loss at a CRF.
        threshold: what the loss must stay below.
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
        guess = expected(losses, threshold) if len(losses) < GUESSES else (passes + fails) // 2
    return passes if passes >= lower else None


def expected(losses: dict[int, float], threshold: float) -> int:
    """The CRF that should be the highest to pass, from the losses at others, in the order of the trials; the next one
    where that was tried and passed."""
    (*before, last), growth = losses, LOSS_GROWTH
    if before and losses[last] > 0 and losses[before[-1]] > 0:
        seen = math.log(losses[last] / losses[before[-1]]) / (last - before[-1])
        growth = min(max(seen, GROWTHS[0]), GROWTHS[1])
    guess = last + math.floor(steps_to(threshold, losses[last], growth))
    return guess + 1 if guess in losses and losses[guess] < threshold else guess


def steps_to(threshold: float, loss: float, growth: float = LOSS_GROWTH) -> float:
    """CRF steps from where a loss was seen to where it should be ``threshold``, if it grows as it usually does."""
    return math.log(threshold / max(loss, 1e-6)) / growth
