"""A policy trained on an export, served, and evaluated by ``vcage evaluate`` in layouts never seen.

A small network (``benchmarks/_policy/network.py``) learns from the columns of an exported LeRobot data set. It predicts
the next poses of the hands from objects as the hands see them. On states, the poses of the objects are given. On
pictures, ``benchmarks/_policy/localiser.py`` finds them. The policy is served behind openpi's protocol in
a process of its own, and evaluated through the command as any policy of a lab would be. Rows differ in their data:

- ``varied``: states, layouts drawn for every episode; ``fixed``: states, the optimised layout with small shifts;
- ``unchecked``: states of episodes that are played without a critic or pictures, failures included; ``checked``: of
  those among them that the simulator's state accepts, as many;
- ``raw``, ``compressed``, ``lerobot``: pictures of the varied episodes as recorded, as ``vcage compress`` stores them,
  and as LeRobot's defaults do (AV1, CRF 30). All of these, and all their seeds, share the network that acts, and
  differ in the localiser.

All are evaluated on the same drawn layouts. Rows on pictures are compared with ``raw`` start by start (McNemar), and
``checked`` with ``unchecked``.

Episodes, weights and evaluations are kept in ``--data``: an interrupted run collects, trains and evaluates nothing
twice.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import logging
import shlex
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, get_args

import numpy as np
import torch

from benchmarks._policy import localiser, played
from benchmarks._policy.collected import Layout, Task, exported, meaning_of
from benchmarks._policy.demonstrations import Demonstrations
from benchmarks._policy.localiser import LocaliserTraining, places_in_pictures, trained_localiser, views_of
from benchmarks._policy.pictures import Format, shrunk_pictures
from benchmarks._policy.policy import Meaning, Policy
from benchmarks._policy.pooled import pooled
from benchmarks._policy.training import Noise, Training, trained
from vcage.base.errors import StaleStage, UsageError, VcageError
from vcage.base.files import RunFolder, atomic_path, cache_dir
from vcage.evaluation.environment import PATIENCE
from vcage.evaluation.evaluate import RECORD
from vcage.schema.evaluation import Evaluation

logger = logging.getLogger(__name__)

INSTRUCTION = "Put the block on the plate"
"""One sub-task, about four seconds long, among other things that stand about."""

ROBOT = "dual_panda"

LAYOUTS: tuple[Layout, ...] = get_args(Layout)

FORMATS: tuple[Format, ...] = get_args(Format)

PLAYED = ("unchecked", "checked")

POSITIONS = "positions"
"""Name of the weights that all rows on pictures share: only what finds the objects is trained for each row and seed."""

ROWS = (*LAYOUTS, *PLAYED, *FORMATS)

RIVALS = {"compressed": "raw", "lerobot": "raw", "checked": "unchecked"}
"""Rows, and the one that each is compared with."""


@dataclass(frozen=True)
class Plan:
    """Amount of work.

    Args:
        episodes: of training, of each row.
        seeds: trainings of each row.
        steps: of each training of a policy.
        localiser_share: steps of the training of a localiser, as a share of these.
        rollouts: of each policy.
        unproven: layouts in which the expert fails are counted, too.
        actions: of an answer that are carried out between two looks.
        object_noise_m: standard deviation of the objects' places in training, where a localiser will find them.
    """

    episodes: int = 300
    seeds: int = 1
    steps: int = 10_000
    localiser_share: float = 0.1
    rollouts: int = 100
    unproven: bool = False
    actions: int = 4
    object_noise_m: float = 0.004


QUICK = Plan(episodes=3, seeds=1, steps=100, rollouts=1)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    for name, kind, what in (
        ("episodes", int, "of training, of each row"),
        ("seeds", int, "trainings of each row"),
        ("steps", int, "of each training of a policy; its localiser takes a tenth of them"),
        ("rollouts", int, "of each policy"),
    ):
        default = f"default: {getattr(Plan, name)}, with --quick {getattr(QUICK, name)}"
        parser.add_argument(f"--{name}", type=kind, help=f"{what} ({default})")
    unproven = "count layouts in which the expert fails, too: to try them first takes long where it often does"
    parser.add_argument("--unproven", action="store_true", default=None, help=unproven)
    parser.add_argument("--instruction", default=INSTRUCTION, help="the task (default: %(default)s)")
    parser.add_argument("--robot", default=ROBOT, help="who does it (default: %(default)s)")
    parser.add_argument("--rows", default=",".join(ROWS), help="with commas (default: %(default)s)")
    parser.add_argument("--data", type=Path, help="where episodes and weights are kept (default: the user's cache)")
    parser.add_argument("--device", default="cpu", help="of torch, for training on states (default: %(default)s)")
    parser.add_argument("--workers", type=int, default=2, help="processes that collect and evaluate (default: 2)")


def run(
    quick: bool,
    instruction: str = INSTRUCTION,
    robot: str = ROBOT,
    rows: str = ",".join(ROWS),
    data: Path | None = None,
    device: str = "cpu",
    workers: int = 2,
    **chosen: Any,
) -> dict[str, Any]:
    """A row for each policy: its data, and its evaluation; of several seeds also :func:`pooled` tables.

    - ``episodes``, ``frames``: that it was trained on; ``cpu_minutes``: of each of its trainings.
    - all figures of ``vcage evaluate``: ``n_success`` of ``n_episodes``, ``pc_success_ci95`` (Wilson), ``furthest``
      (how far the episodes came), ``left_out`` (layouts in which the expert fails, too); ``compared`` with its rival.

    Args:
        quick: a few episodes and seconds, which show that it runs, and nothing more.
        instruction: the task.
        robot: who does it.
        rows: with commas.
        data: where episodes and weights are kept.
        device: of torch, for training on states.
        workers: processes.
        chosen: fields of :class:`Plan`.

    Raises:
        UsageError: a row that is none, or a device that torch does not have.
    """
    plan = replace(QUICK if quick else Plan(), **{k: v for k, v in chosen.items() if v is not None})
    chosen_rows = [row for row in ROWS if row in rows.split(",")]
    if wrong := {*rows.split(",")} - {*ROWS}:
        raise UsageError(f"--rows knows {', '.join(ROWS)}, not {', '.join(sorted(wrong))}")
    _require_device(device)
    folder = (data or cache_dir("benchmarks", "policy")) / robot / "-".join(instruction.lower().split())
    bench = _Bench(Task(instruction, robot, folder, workers), plan, device)
    trainings = [(row, seed) for seed in range(plan.seeds) for row in chosen_rows]
    found = [bench.row(row, seed) for row, seed in trainings]
    evaluations = {training: Evaluation.read(bench.evaluation(*training) / RECORD) for training in trainings}
    tables = pooled(evaluations, RIVALS) if plan.seeds > 1 else {}
    return {"instruction": instruction, "robot": robot, "plan": asdict(plan), "rows": found, **tables}


def _require_device(device: str) -> None:
    """Check that torch trains on a device, before anything is collected for it.

    Raises:
        UsageError: it does not.
    """
    try:
        torch.zeros(1, device=device)
    except (RuntimeError, AssertionError) as error:  # torch without CUDA asserts
        why = str(error).splitlines()[0]
        hint = "leave --device out to train on the CPU"
        raise UsageError(f"--device {device!r} is none that torch has here: {why}", hint=hint) from error


@dataclass(frozen=True)
class _Bench:
    task: Task
    plan: Plan
    device: str = "cpu"

    def row(self, name: str, seed: int) -> dict[str, Any]:
        """Train, serve and evaluate a policy."""
        limit = list[str]()
        if name in PLAYED:
            source, _ = self.task.planned(self.plan.episodes, "varied")
            kept = {"folder": self.task.data / "played", "workers": self.task.workers}
            demonstrations = played.demonstrations(source, self.plan.episodes, name == "checked", **kept)
            longest = played.longest_success(source, self.plan.episodes, **kept)
            limit = ["--max-steps", str(int(np.ceil(PATIENCE * longest)))]
        else:
            source = self.task.collected(self.plan.episodes, "fixed" if name == "fixed" else "varied")
            demonstrations = Demonstrations.read(exported(source), self.plan.episodes)
        stored = next((known for known in FORMATS if known == name), None)
        noise = Noise(object_m=0.0 if stored is None else self.plan.object_noise_m)
        acting = seed if stored is None else 0  # formats are compared: what differs is what finds the objects
        training = Training(steps=self.plan.steps, seed=acting, noise=noise, device=self.device)
        meaning = meaning_of(source, demonstrations, self.task.robot, turned=stored is None)
        weights = self._trained(POSITIONS if stored else name, demonstrations, meaning, training)
        if stored is not None:
            weights = self._localising(weights, stored, source, demonstrations, seed)
        observed = [] if stored is not None else ["--no-pictures", "--environment-state"]
        scenes = self.task.collected(self.plan.episodes, "varied") if name == "fixed" else source
        facts = self._evaluated(weights, scenes, name, seed, [*observed, *limit])
        counts = {"episodes": len(demonstrations.ends), "frames": len(demonstrations.states)}
        spent = {network: round(cpu_s / 60, 1) for network, cpu_s in Policy.read(weights).cpu_s.items()}
        return {"trained_on": name, "seed": seed, **counts, "cpu_minutes": spent, **facts}

    def _trained(self, name: str, demonstrations: Demonstrations, meaning: Meaning, training: Training) -> Path:
        """Weights of a policy that is trained on states."""
        path = self.task.data / f"{name}-seed{training.seed}-{_made_from(demonstrations, training)}.pt"
        if not path.exists():
            logger.info("%s, seed %d: training of %d steps", name, training.seed, training.steps)
            with atomic_path(path) as part:
                trained(demonstrations, meaning, training).write(part)
        return path

    def _localising(
        self, positions: Path, stored: Format, source: RunFolder, demonstrations: Demonstrations, seed: int
    ) -> Path:
        """Weights of a policy with a localiser that is trained on pictures of a format."""
        training = LocaliserTraining(round(self.plan.localiser_share * self.plan.steps), seed=seed)
        made_from = hashlib.sha256(f"{positions.stem} {training} {localiser.SETTINGS}".encode()).hexdigest()[:12]
        path = self.task.data / f"{stored}-seed{seed}-{made_from}.pt"
        if path.exists():
            return path
        logger.info("%s, seed %d: training of a localiser, %d steps", stored, seed, training.steps)
        if stored == "compressed":
            self.task.compressed(source)
        policy, views = Policy.read(positions), views_of(self.task.robot)
        seen = shrunk_pictures(source, stored, views, self.plan.episodes, self.task.data / "lerobot")
        hands, objects = policy.hands.poses(demonstrations.states), policy.objects.poses(demonstrations.objects)
        places = places_in_pictures(self.task.robot, views, objects.position)
        found = trained_localiser(seen, hands, objects.position, views, places, training)
        policy.localiser, policy.cpu_s["localiser"] = found
        with atomic_path(path) as part:
            policy.write(part)
        return path

    def evaluation(self, name: str, seed: int) -> Path:
        """Folder of the evaluation of a policy: all act in the scenes of the varied run."""
        return self.task.data / "varied" / "evaluations" / f"{name}-seed{seed}"

    def _evaluated(self, weights: Path, run: RunFolder, name: str, seed: int, options: list[str]) -> dict[str, Any]:
        """Serve weights and evaluate them with options; the summary of ``vcage evaluate``."""
        out, rival = (self.evaluation(row, seed) for row in (name, RIVALS.get(name, name)))
        with served(weights) as address:
            command = [sys.executable, "-m", "vcage.cli.main", "evaluate", str(run.root), "--policy", address]
            command += ["--episodes", str(self.plan.rollouts), "--workers", str(self.task.workers)]
            command += ["--actions", str(self.plan.actions), "--out", str(out), "--name", weights.stem, "--videos", "0"]
            command += [*options, *["--unproven"] * self.plan.unproven]
            if name in RIVALS and (rival / RECORD).exists():
                command += ["--against", str(rival)]
            begun = time.perf_counter()
            answer = _answer(command)
            if answer.get("error", {}).get("code") == StaleStage.code:
                logger.info("%s: an earlier evaluation is replaced: %s", weights.stem, answer["error"]["message"])
                answer = _answer([*command, "--force"])
        if "error" in answer:
            raise VcageError(f"vcage evaluate fails: {answer['error']['message']}")
        facts = answer["summary"]
        spent = time.perf_counter() - begun
        logger.info("%s: %s of %s in %.0f s", weights.stem, facts["n_success"], self.plan.rollouts, spent)
        return facts


@contextmanager
def served(weights: Path) -> Iterator[str]:
    """Serve a policy in a process of its own; its address."""
    command = [sys.executable, "-m", "benchmarks._policy.serve", str(weights)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        try:
            if not (address := (server.stdout.readline() if server.stdout else "").strip()):
                raise VcageError(f"the policy {weights} cannot be served: the server ended with {server.wait()}")
            yield address
        finally:
            server.terminate()


def _answer(command: Sequence[str]) -> dict[str, Any]:
    """The last line on stdout of a command of the project: its result, or its error.

    Raises:
        VcageError: it ended without one.
    """
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    try:
        return json.loads(done.stdout.splitlines()[-1])
    except (IndexError, ValueError) as error:
        raise VcageError(f"{shlex.join(command)} ended with {done.returncode}, and without a result") from error


def _made_from(demonstrations: Demonstrations, training: Training) -> str:
    """A hash of demonstrations, and of the settings of a training on them."""
    made_from = hashlib.sha256(repr(training).encode())
    for numbers in vars(demonstrations).values():
        made_from.update(np.asarray(numbers).tobytes())
    return made_from.hexdigest()[:12]
