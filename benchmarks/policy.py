"""A small policy trained on the same episodes as raw pictures, as ours compresses them, and as LeRobot encodes them.

The paper's table II on the scale of two cores: an ACT-like policy (``benchmarks/_policy/network.py``) is trained on
pictures of each encoding, with several seeds, which are paired: the same first weights and the same frames in the same
order. It is also trained on raw pictures of as many episodes with a fixed layout. All are tested on held-out episodes
of layouts that no training has seen, on their raw pictures: the test is of the learned policy, not of its input.
Pictures are made small, which averages away a part of the encoder's effect (``benchmarks/_policy/demonstrations.py``).

Then policies do the task in the simulator, from the starts of held-out episodes in other lights: the k-th rollouts of
all rows have the same start and light, and the policies of a row's seeds take turns. ``replayed`` counts the recorded
actions of these episodes, executed in the same way: losses there are not the policies' fault.

Episodes, small pictures and weights are kept in ``--data``, and an interrupted run goes on where it was.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import logging
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks._policy.collected import Task
from benchmarks._policy.demonstrations import ENCODINGS, Demonstrations, View, load
from benchmarks._policy.network import Size
from benchmarks._policy.rollouts import Outcome, Rollouts
from benchmarks._policy.training import Policy, Settings, errors, named, still, trained
from vcage.base.errors import UsageError
from vcage.base.files import cache_dir
from vcage.base.proportions import LEVEL
from vcage.schema.episodes import CountedShare

logger = logging.getLogger(__name__)

INSTRUCTION = "Put the block on the plate"
"""One sub-task, about four seconds long, among other things that stand about."""

ROBOT = "aloha_agilex"

CAMERAS = ("cam_high", "cam_left_wrist", "cam_right_wrist")
"""Those that openpi's ALOHA policies take."""

VIEW = View(CAMERAS, 96, 128)

COMPARED = (("raw/varied", "ours/varied"), ("raw/varied", "lerobot/varied"), ("raw/varied", "raw/fixed"))
"""Pairs of rows with a reported difference."""


@dataclass(frozen=True)
class Plan:
    """Amount of work.

    Args:
        episodes: of training, of each kind of layout.
        held_out: episodes of testing.
        seeds: trainings of each row.
        steps: of each training.
        rollouts: of each row.
    """

    episodes: int = 100
    held_out: int = 30
    seeds: int = 3
    steps: int = 1500
    rollouts: int = 50


QUICK = Plan(episodes=3, held_out=2, seeds=2, steps=5, rollouts=1)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    for name, what in (
        ("episodes", "of training, of each kind of layout"),
        ("held-out", "episodes of testing"),
        ("seeds", "trainings of each row, at least 2"),
        ("steps", "of each training"),
        ("rollouts", "of each row in the simulator, 0 for none"),
    ):
        of = name.replace("-", "_")
        default = f"default: {getattr(Plan, of)}, with --quick {getattr(QUICK, of)}"
        parser.add_argument(f"--{name}", type=int, help=f"{what} ({default})")
    parser.add_argument("--data", type=Path, help="where episodes and weights are kept (default: the user's cache)")
    parser.add_argument("--robot", default=ROBOT, help=f"who does it (default: {ROBOT})")
    parser.add_argument("--cameras", default=",".join(CAMERAS), help="that the policy sees (default: %(default)s)")
    parser.add_argument("--workers", type=int, help="processes that collect (default: as many as cores)")


def run(
    quick: bool,
    data: Path | None = None,
    robot: str = ROBOT,
    cameras: str = ",".join(CAMERAS),
    workers: int | None = None,
    **chosen: int | None,
) -> dict[str, Any]:
    """A row for each training set: its encoding and its layouts.

    - ``bytes``: of the pictures that the policy's cameras took, at their full size; raw is uncompressed RGB.
    - ``error_rad``: mean L1 error of a predicted chunk on held-out episodes over all joints, radians, with its interval
      at 95 % over seeds (Student's t); ``error_gripper``: the same of the openings, from 0 to 1, without interval.
    - ``touched``, ``lifted``: rollouts in which a hand touched the object to move, or held it above its old place.
    - ``success``: rollouts that completed the task; ``success_low``, ``success_high``: its Wilson interval at 95 %.
    - ``seconds``: of training, all seeds together; none where all weights were kept from before.
    - ``held_out``: its ``still`` is the error of a policy that never moves, which the others must be held against.
    - ``differences``: of ``error_rad``, paired by seed, with the interval at 95 %; ``within`` says that it holds 0.

    Args:
        quick: a few episodes and steps, which show that it runs, and nothing more.
        data: where episodes and weights are kept.
        robot: who does it.
        cameras: names with commas.
        workers: processes that collect.
        chosen: fields of :class:`Plan`.
    """
    plan = replace(QUICK if quick else Plan(), **{k: v for k, v in chosen.items() if v is not None})
    if plan.seeds < 2:
        raise UsageError(f"--seeds is {plan.seeds}, expected at least 2: an interval needs two")
    view = replace(VIEW, cameras=tuple(cameras.split(",")))
    task = Task(INSTRUCTION, robot, data or cache_dir("benchmarks", "policy"), workers)
    held_out = task.held_out(plan.held_out)
    others = load(held_out, plan.held_out, "raw", view)
    rollouts = Rollouts(held_out, plan.held_out, view)
    rows = [Row(name, demonstrations, plan, task.data / "policies") for name, demonstrations in _sets(task, plan, view)]
    for seed in range(plan.seeds):  # in turn, so that other load on the machine slows all down alike
        for row in rows:
            row.train(seed, others)
    for number in range(plan.rollouts):
        for row in rows:
            row.roll_out(number, rollouts)
    return {
        "rows": [row.figures() for row in rows],
        "differences": differences({row.name: row.errors_rad for row in rows}),
        "replayed": _counted(sum(map(rollouts.replayed, range(len(rollouts)))), len(rollouts)),
        "held_out": {"episodes": len(rollouts), "frames": len(others), "still": still(others, Size.chunk)},
        "seeds": plan.seeds,
        "view": vars(view),
        "settings": named(Settings(plan.steps)),
    }


def _sets(task: Task, plan: Plan, view: View) -> list[tuple[str, Demonstrations]]:
    """The training sets by name."""
    varied, fixed = task.varied(plan.episodes), task.fixed(plan.episodes)
    encoded = [(f"{encoding}/varied", load(varied, plan.episodes, encoding, view)) for encoding in ENCODINGS]
    return [*encoded, ("raw/fixed", load(fixed, plan.episodes, "raw", view))]


class Row:
    """A training set, its policies, and what came of them.

    Args:
        name: encoding and layouts.
        demonstrations: of the set.
        plan: how much is done.
        kept: folder of the weights.
    """

    def __init__(self, name: str, demonstrations: Demonstrations, plan: Plan, kept: Path):
        self.name, self._demonstrations, self._plan, self._kept = name, demonstrations, plan, kept
        self._settings = Settings(plan.steps)
        self._digest = hashlib.sha256(json.dumps(named(self._settings)).encode())
        for array in (demonstrations.pictures, demonstrations.actions):
            self._digest.update(np.ascontiguousarray(array).data)
        self._policies: list[Policy] = []
        self._errors: list[dict[str, float]] = []
        self._outcomes: list[Outcome] = []
        self._seconds = 0.0

    @property
    def errors_rad(self) -> list[float]:
        """Of each seed."""
        return [error["error_rad"] for error in self._errors]

    def train(self, seed: int, others: Demonstrations) -> None:
        """Train a policy, and test it on the others."""
        path = self._kept / f"{self.name.replace('/', '-')}-{seed}-{self._digest.hexdigest()[:12]}.pt"
        kept, started = path.exists(), time.perf_counter()
        policy = trained(self._demonstrations, self._settings, seed, f"{self.name}, seed {seed}", path)
        self._seconds += 0.0 if kept else time.perf_counter() - started
        self._policies.append(policy)
        self._errors.append(errors(policy, others))
        logger.info("%s, seed %d: %s", self.name, seed, self._errors[-1])

    def roll_out(self, number: int, rollouts: Rollouts) -> None:
        """Let the policy whose turn it is do the task."""
        policy = self._policies[(number // len(rollouts) + number) % len(self._policies)]
        self._outcomes.append(rollouts.outcome(policy, number))
        logger.info("%s, rollout %d: %s", self.name, number + 1, self._outcomes[-1])

    def figures(self) -> dict[str, Any]:
        """Of all that was done."""
        low, high = interval(self.errors_rad)
        success = CountedShare.counted(sum(o.done for o in self._outcomes), len(self._outcomes))
        return {
            "trained_on": self.name,
            "episodes": len(self._demonstrations.ends),
            "frames": len(self._demonstrations),
            "bytes": self._demonstrations.bytes,
            "error_rad": round(float(np.mean(self.errors_rad)), 5),
            "error_rad_low": round(low, 5),
            "error_rad_high": round(high, 5),
            "error_gripper": round(float(np.mean([error["error_gripper"] for error in self._errors])), 5),
            "touched": sum(o.touched for o in self._outcomes),
            "lifted": sum(o.lifted for o in self._outcomes),
            "success": success.some,
            "rollouts": success.of,
            "success_low": success.low,
            "success_high": success.high,
            "seconds": round(self._seconds, 1) or None,
        }


def differences(found: Mapping[str, Sequence[float]]) -> dict[str, dict[str, Any]]:
    """Difference of each pair of :data:`COMPARED`, the second less the first, seed by seed."""
    told = {}
    for first, second in COMPARED:
        by_seed = np.subtract(found[second], found[first])
        low, high = interval(by_seed)
        told[f"{second} - {first}"] = {
            "mean": round(float(by_seed.mean()), 5),
            "low": round(low, 5),
            "high": round(high, 5),
            "within": bool(low <= 0 <= high),
        }
    return told


def interval(values: Sequence[float] | np.ndarray) -> tuple[float, float]:
    """Student's t interval of the mean of a few values at 95 %."""
    from scipy.stats import t

    mean, error = float(np.mean(values)), float(np.std(values, ddof=1)) / len(values) ** 0.5
    reach = float(t.ppf((1 + LEVEL) / 2, len(values) - 1)) * error
    return mean - reach, mean + reach


def _counted(some: int, of: int) -> dict[str, Any]:
    return CountedShare.counted(some, of).model_dump()
