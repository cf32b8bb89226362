"""The highest CRF that passes, in few trials."""

from __future__ import annotations

import math
from collections.abc import Callable

BUDGET = 7
"""Encodings at most for one clip."""

LOSS_GROWTH = 0.17
"""Growth of ln(loss) per CRF step on rendered clips; it only makes guesses better, never a result."""

FIRST_STEP = 3
"""Smallest step up while nothing has failed yet: a bound above is worth more than a small gain."""


def highest_passing(
    loss_at: Callable[[int], float], threshold: float, upper: int, first: int, lower: int = 0, budget: int = BUDGET
) -> int | None:
    """The highest CRF in ``lower`` … ``upper`` with ``loss_at(crf) < threshold``, if the loss grows with the CRF.

    A bisection that probes where the last loss says the threshold should be, as far as the budget allows: whatever
    the answer, the CRFs that remain can still be told apart by the trials that remain.

    Args:
        loss_at: the loss at a CRF; called at most ``budget`` times.
        threshold: what the loss must stay below.
        upper: the highest CRF to consider; below ``lower`` for none.
        first: the first CRF to try.
        lower: the lowest CRF to consider.
        budget: calls at most; at least log2(``upper`` − ``lower`` + 2).

    Returns:
        None when the loss at ``lower`` is too large already.
    """
    passes, fails = lower - 1, max(upper + 1, lower)
    guess = first
    for left in reversed(range(budget)):
        if fails - passes == 1:
            break
        room = 2**left
        guess = min(max(guess, fails - room, passes + 1), passes + room, fails - 1)
        loss = loss_at(guess)
        step = min(math.log(threshold / max(loss, 1e-6)) / LOSS_GROWTH, upper + 1)
        if loss < threshold:
            passes = guess
            bounded = fails <= upper
            guess += max(1, math.floor(step)) if bounded else max(FIRST_STEP, math.floor(step) + 1)
        else:
            fails = guess
            guess += min(-1, math.floor(step))
    return passes if passes >= lower else None
