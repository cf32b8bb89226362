"""Count what knowing the reason saves, without physics: every choice is carried out, and is good or bad."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from benchmarks._loop.planted import Causes
from vcage.base.geometry import Pose
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Grasp, Subtask
from vcage.tasks.retries import Failed, Retry, blamed
from vcage.tasks.slots import Slot

GRASPS = [(0, "left"), (0, "right"), (1, "left"), (1, "right")]
"""As most things have: two contact points, two arms."""

SLOTS = [Slot("box", 0, Pose([0.02 * n, 0.0, 0.0])) for n in range(7)]
"""The slot that is planned, and the others that are drawn where it does not do."""

STEP = Subtask(
    id="block-into-box",
    template="place",
    text="Put the block into the box.",
    object="block",
    receptacle="box",
    grasps=[Grasp(contact=contact, arm=arm, score=0.0) for contact, arm in GRASPS],
    goals=[Goal(subject="block", relation="inside", reference="box")],
    script="subtasks/script.py",
    checks=[],
)


def attempts(causes: Causes, retries: int, steered: bool) -> tuple[int, bool]:
    """Draw the number of attempts of a step, and whether the last one does it.

    Args:
        causes: which grasps and slots are bad.
        retries: further attempts.
        steered: whether the reason is told.
    """
    past: tuple[Failed, ...] = ()
    for number in range(1, 2 + retries):
        slot, grasps = next(Retry(past).choices(GRASPS, SLOTS))
        failure = causes.failure(STEP, grasps[0], slot)
        if failure is None:
            return number, True
        past += (Failed(*grasps[0], slot, blamed("verify", failure if steered else None)),)
    return 1 + retries, False


def counted(good: Sequence[float], retries: int, steps: int) -> dict[str, Any]:
    """For shares of good choices: attempts for each step that is verified, and the share of steps that are.

    Args:
        good: share of the grasps, and of the slots.
        retries: further attempts of a step.
        steps: that are drawn for each figure.
    """
    found: dict[str, Any] = {}
    for share in good:
        for name, steered in (("resample", True), ("blind", False)):
            tried = [attempts(Causes(share, seed), retries, steered) for seed in range(steps)]
            verified = sum(done for _, done in tried)
            found.setdefault(f"good_{share}", {})[name] = {
                "attempts_per_step": round(sum(n for n, _ in tried) / max(1, verified), 2),
                "verified": round(verified / steps, 3),
            }
    return found
