"""The environment of a run in this process: steps per CPU second with and without pictures, and memory over resets."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import psutil

from vcage.base.files import RunFolder
from vcage.evaluation.environment import RunEnv, make_env

WARM_RESETS = 5
"""After these memory is expected to stay: by then all that episodes share is loaded."""

SWING_RAD = 0.05
"""By which all joints move at once; grippers, too, as openings."""


def acted(run: RunFolder, pictures: bool, steps: int, resets: int) -> dict[str, Any]:
    """Swing the arms in one episode, then begin others.

    Args:
        run: with a layout and sub-tasks.
        pictures: observe those of all cameras.
        steps: actions.
        resets: episodes begun.

    Returns:
        ``steps_per_cpu_second``; ``reset_cpu_s`` of a drawn start, the mean; ``mb_per_reset`` (least squares; of the
        second half alone: ``mb_per_late_reset``); ``mb_begun`` held after the first few resets, and ``mb`` in the end.
    """
    env = make_env(run.root, pictures=pictures, environment_state=True, max_steps=steps + 1)
    home = env.reset(seed=0)[0]["agent_pos"]
    env.step(home)  # what is loaded for the first one
    begun = time.process_time()
    for step in range(steps - 1):
        env.step(home + SWING_RAD * np.sin(step / 5))
    spent = time.process_time() - begun
    reset_s, held = _begun_again(env, resets)
    return {
        "pictures": len(env.cameras),
        "steps": steps - 1,
        "steps_per_cpu_second": round((steps - 1) / spent, 1),
        "resets": resets,
        "reset_cpu_s": round(reset_s, 3),
        "mb_per_reset": _slope(held),
        "mb_per_late_reset": _slope(held[len(held) // 2 :]),
        "mb_begun": round(held[0]),
        "mb": round(held[-1]),
    }


def _slope(values: list[float]) -> float:
    """Least squares; 0 of a single value."""
    return round(float(np.polyfit(np.arange(len(values)), values, 1)[0]), 4) if len(values) > 1 else 0.0


def _begun_again(env: RunEnv, resets: int) -> tuple[float, list[float]]:
    """CPU seconds of a reset, and the megabytes held after each but the first few."""
    held, process, begun = [], psutil.Process(), time.process_time()
    for seed in range(1, resets + 1):
        env.reset(seed=seed)
        held.append(process.memory_info().rss / 1e6)
    return (time.process_time() - begun) / resets, held[WARM_RESETS:]
