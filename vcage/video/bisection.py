"""The highest CRF that passes, in few trials."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import count

BUDGET = 7
"""Encodings of one clip that find its CRF; more only where frames that no search has seen fail again and again."""

LOSS_GROWTH = 0.17
"""Growth of ln(loss) per CRF step on rendered clips; it only makes guesses better, never a result."""

FIRST_STEP = 3
"""Smallest step up while nothing has failed yet: a bound above is worth more than a small gain."""


def highest_passing(
    loss_at: Callable[[int], float], threshold: float, upper: int, first: int, lower: int = 0, budget: int = BUDGET
) -> int | None:
    """The highest CRF in ``lower`` … ``upper`` with ``loss_at(crf) < threshold``, if the loss grows with the CRF.

    A bisection that probes where the last loss says the threshold should be, as far as the budget allows: whatever
    the answer, the CRFs that remain can still be told apart by the trials that remain. A budget below
    log2(``upper`` − ``lower`` + 2) cannot promise that: what is found then passes, but a higher one might too.

    Args:
        loss_at: the loss at a CRF.
        threshold: what the loss must stay below.
        upper: the highest CRF to consider; below ``lower`` for none.
        first: the first CRF to try.
        lower: the lowest CRF to consider.
        budget: calls at most; where it was too small to find any that passes, as many more as that takes, at growing
            steps down.

    Returns:
        None when the loss at ``lower`` is too large already.
    """
    passes, fails = lower - 1, max(upper + 1, lower)
    guess = first
    for left in count(budget - 1, -1):
        if fails - passes == 1 or (left < 0 and passes >= lower):
            break
        room = 2 ** max(left, 0)
        if fails - passes <= 2 * room:
            guess = min(max(guess, fails - room), passes + room)
        guess = min(max(guess, passes + 1), fails - 1)
        loss = loss_at(guess)
        step = min(steps_to(threshold, loss), upper + 1)
        if loss < threshold:
            passes = guess
            bounded = fails <= upper
            guess += max(1, math.floor(step)) if bounded else max(FIRST_STEP, math.floor(step) + 1)
        else:
            fails = guess
            guess += min(-(2 ** max(-left, 0)), math.floor(step))
    return passes if passes >= lower else None


def steps_to(threshold: float, loss: float) -> float:
    """CRF steps from where a loss was seen to where it should be ``threshold``, if it grows as it usually does."""
    return math.log(threshold / max(loss, 1e-6)) / LOSS_GROWTH
