"""Measure the closed loop: verified long trajectories per hour, with failures that are planted by hand.

A chain of sub-tasks is executed over and over. First, objects set down are taken away again in a share of the
attempts, so that a step fails at the given rate for every critic: once retrying from the last verified state
(``resample``), once restarting at the first failure (``abort``), and once without checks (``open``). Once the
picture critic judges, once a perfect one. In theory, where steps succeed with p, resampling
needs n / p attempts for n steps and aborting (1 − pⁿ) / (1 − p) / pⁿ.

Then failures have lasting causes: a share of the grasps of a step and of the slots is bad each time. The object of a
bad grasp is found near its old place, that of a bad slot beside its receptacle; a step is retried as often as in
``collect``. Here ``resample`` changes the part the critic blames, ``blind`` knows only the
no, and changes grasp and slot together; ``named`` is the share of planted failures that the critic gave their right
name. ``counted`` has the same for more shares and some hundred steps, without physics and with every reason right.

The counts are of accepted trajectories; ``false`` are those with a failed step all the same, ``over
plain`` is the ratio of accepted trajectories per hour to ``abort``, or to ``blind``.
"""

from __future__ import annotations

import argparse
import logging
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from benchmarks._loop.chain import Chain, Critic, Mode, Played
from benchmarks._loop.counted import counted
from benchmarks._loop.planted import Causes, Chance, Kind, Planted
from vcage.schema.episodes import Failure
from vcage.stages import collect

logger = logging.getLogger(__name__)

CHAINS = {
    (6, 0.75): "Pick six blocks and put them in the packaging box",
    (10, 0.8): "Put six blocks and four marker pens in the packaging box",
}
"""(steps, share of attempts that succeed) → a sentence for as many."""

GOOD = 0.7
"""Share of the grasps, and of the slots, that are good where failures have causes."""

SHARES = (0.9, 0.8, 0.7, 0.6, 0.5)
"""The same, where it is counted without physics."""

PLENTY = 12
"""Further attempts of a step where failures happen by chance: enough that hardly any chain ends for want of them."""

LOOPS: Mapping[Critic, Sequence[Mode]] = {"pictures": ("resample", "abort", "open"), "perfect": ("resample", "abort")}
"""Who judges → what follows a failure that happens by chance."""

PLAIN = ("abort", "blind")
"""The policy that the others are compared with."""

MOST_ATTEMPTS = 300
"""A row ends when one trajectory takes more attempts than that: seven times what theory asks of the longest."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("--trajectories", type=int, help="accepted ones of each row (default: 8, with --quick 1)")


def run(quick: bool, trajectories: int | None = None) -> dict[str, Any]:
    """Rows for each chain, kind of failure, critic and what follows a failure.

    Args:
        quick: the shorter chain alone, and one trajectory of each row.
        trajectories: accepted ones of each row.
    """
    wanted = trajectories or (1 if quick else 8)
    found = []
    for (steps, share), sentence in list(CHAINS.items())[: 1 if quick else None]:
        chain = Chain(sentence, steps)
        for critic, modes in LOOPS.items():
            rows = [_Row(chain, steps, "chance", share, PLENTY, critic, mode) for mode in modes]
            if critic == "pictures":
                few = collect.Options.retries
                rows += [_Row(chain, steps, "causes", GOOD, few, critic, mode) for mode in ("resample", "blind")]
            for _ in range(wanted):  # in turn, so that other load on the machine slows all down alike
                for row in rows:
                    row.next_accepted()
            found += _compared([row.figures() for row in rows])
    return {"rows": found, "counted": counted(SHARES, collect.Options.retries, 200 if quick else 1000)}


@dataclass
class Tally:
    """Outcomes of the episodes of a row.

    Args:
        accepted: episodes with every step accepted.
        false: accepted episodes with a failed step.
        attempts: at all steps.
        failed: attempts that did not do the step.
        steps: verified steps.
        named: refused planted failures, with the reasons given for them.
    """

    accepted: int = 0
    false: int = 0
    attempts: int = 0
    failed: int = 0
    steps: int = 0
    named: list[tuple[Failure, Failure | None]] = field(default_factory=list)

    def count(self, played: Played) -> None:
        """Add an episode."""
        done = played.run
        self.attempts += len(done.attempts)
        self.failed += sum(not (a.truth and a.truth.success) for a in done.attempts)
        self.steps += len(done.segments)
        self.accepted += done.accepted
        self.false += done.accepted and not all(s.truth.success for s in done.segments)
        self.named += played.named

    def figures(self, seconds: float) -> dict[str, Any]:
        """Of what took so long."""
        right = sum(planted == said for planted, said in self.named)
        return {
            "accepted": self.accepted,
            "false": self.false,
            "attempts": self.attempts,
            "attempts_per_accepted": round(self.attempts / self.accepted, 1) if self.accepted else None,
            "step_success": round(1 - self.failed / self.attempts, 3),
            "attempts_per_step": round(self.attempts / self.steps, 2) if self.steps else None,
            "seconds_per_attempt": round(seconds / self.attempts, 2),
            "named": round(right / len(self.named), 2) if self.named else None,
            "per_hour": round(self.accepted / seconds * 3600, 1),
            "true_per_hour": round((self.accepted - self.false) / seconds * 3600, 1),
        }


@dataclass
class _Row:
    """Episodes of one kind, and the time that they took."""

    chain: Chain
    steps: int
    kind: Kind
    share: float
    retries: int
    critic: Critic
    mode: Mode
    tally: Tally = field(default_factory=Tally)
    rng: np.random.Generator = field(default_factory=lambda: np.random.default_rng(7))
    begun: int = 0
    seconds: float = 0.0
    hopeless: bool = False

    def next_accepted(self) -> None:
        """Begin episodes until one more is accepted, unless so many attempts were in vain that none will be."""
        start, before, wanted = time.perf_counter(), self.tally.attempts, self.tally.accepted + 1
        while not self.hopeless and self.tally.accepted < wanted:
            planted: Planted = Chance(self.share, self.rng) if self.kind == "chance" else Causes(self.share, self.begun)
            self.tally.count(self.chain.carried_out(self.mode, self.critic, planted, self.retries, self.begun))
            self.begun += 1
            self.hopeless = self.tally.accepted < wanted and self.tally.attempts - before > MOST_ATTEMPTS
        self.seconds += time.perf_counter() - start
        told = (self.steps, self.kind, self.critic, self.mode, self.tally.accepted, self.seconds)
        logger.info("%d steps, %s, %s, %s: %d in %.0f s", *told)

    def figures(self) -> dict[str, Any]:
        """Of the episodes so far."""
        who = "none" if self.mode == "open" else self.critic
        told = {"steps": self.steps, "failures": self.kind, "critic": who, "mode": self.mode}
        return told | self.tally.figures(self.seconds)


def _compared(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Rows with their trajectories per hour over those of the plainest of the same failures."""
    plain = {row["failures"]: row["per_hour"] for row in rows if row["mode"] in PLAIN}
    over = [(row, plain[row["failures"]]) for row in rows]
    return [{**row, "over_plain": round(row["per_hour"] / least, 2) if least else None} for row, least in over]
