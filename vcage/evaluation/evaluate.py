"""An evaluation: rollouts until enough starts are counted, stored as they finish, so that it goes on after a kill.

The actions of each rollout are kept beside the record: from them it can be simulated again.
"""

from __future__ import annotations

import logging
import shlex
import shutil
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import MissingStage, StaleStage, UsageError
from vcage.base.files import RunFolder, atomic_path, sha256_file
from vcage.base.hold import held
from vcage.base.progress import Progress, silent
from vcage.base.workers import Processes, SameProcess
from vcage.evaluation.episode_start import EVALUATION_STREAM
from vcage.evaluation.rollouts import REPLAY, Order, Outcome, outcome, rollouts
from vcage.schema.evaluation import Evaluation, SeedSplit

logger = logging.getLogger(__name__)

RECORD = "evaluation.json"

KEPT = ("actions", "videos")
"""Folders beside it: of each rollout ``actions/<seed>.npy``, and ``videos/<seed>.mp4`` of some."""


@dataclass(frozen=True)
class Amount:
    """Number of episodes, and their seeds.

    Args:
        episodes: to count.
        first_seed: seeds count up from there.
        most_left_out: give up where so many starts in a row are not counted.
    """

    episodes: int = 50
    first_seed: int = 100_000
    most_left_out: int = 50


def evaluate(
    order: Order, amount: Amount, out: Path, workers: int = 1, force: bool = False, progress: Progress = silent
) -> Evaluation:
    """Evaluate a policy; an evaluation that was interrupted goes on.

    Which starts are counted depends on the order and the amount alone, not on the number of processes.

    Args:
        order: the policy, and where it acts.
        amount: how many episodes.
        out: folder of the record.
        workers: processes; a policy server answers each on a connection of its own.
        force: begin anew.
        progress: told after each episode.

    Raises:
        PolicyFailed, EndpointFailed: the policy answers wrongly, or not at all; what is finished is kept.
        StaleStage: ``out`` holds another evaluation.
        MissingStage: the run lacks a stage, or no start of it is counted.
        UsageError: more recorded episodes are to be replayed than there are.
        FolderInUse: another process evaluates there.
    """
    wanted = planned(order, amount)
    with held(RunFolder(out).make().root):
        return _evaluated(order, amount, _begun(out, wanted, force), out, workers, progress)


def _evaluated(
    order: Order, amount: Amount, record: Evaluation, out: Path, workers: int, progress: Progress
) -> Evaluation:
    """Add the outcomes that a record lacks."""
    path = out / RECORD
    if record.rollouts:
        logger.info("%s holds %d episodes already; --force begins anew", path, len(record.rollouts))
    running, known = set[int](), {rollout.seed for rollout in record.rollouts} | {*record.left_out}
    waiting = (seed for seed in _seeds(order, amount) if seed not in known)
    crew = SameProcess(outcome) if workers <= 1 else Processes(outcome, workers)

    def submit() -> None:
        """Begin no start that would not be needed if all running ones are counted."""
        while len(record.rollouts) + len(running) < amount.episodes and (seed := next(waiting, None)) is not None:
            crew.submit((order, seed))
            running.add(seed)
        if len(record.rollouts) < amount.episodes:
            progress(f"{record.successes} of {len(record.rollouts)} succeed", len(record.rollouts), amount.episodes)

    with crew:
        submit()
        for done in crew.results():
            running.remove(done.seed)
            record = _with(record, done)
            if done.actions is not None:
                write_actions(out, done.seed, done.actions)
            record.write(path)
            _require_counted(record, amount)
            submit()
    return record


def planned(order: Order, amount: Amount) -> Evaluation:
    """The record before its first episode; raises as :class:`~vcage.evaluation.rollouts.Rollouts`."""
    env, options = rollouts(order).env, asdict(order.environment)
    observed = {name: options.pop(name) for name in ("pictures", "cameras", "environment_state")}
    return Evaluation(
        policy=order.name or order.policy,
        run=str(order.run),
        task=env.task_description,
        seeds=SeedSplit(scene=env.scene_seed, stream=EVALUATION_STREAM, first=amount.first_seed),
        starts={
            **options,
            "max_steps": env._max_episode_steps,
            "recorded": order.policy == REPLAY,
            "layout_sha256": sha256_file(RunFolder(order.run).layout),
        },
        asking={
            **observed,
            "cameras": list(env.cameras),
            "payload": order.payload,
            "execute": order.execute,
            "solvable": order.solvable,
        },
        rollouts=[],
        left_out={},
    )


def _begun(out: Path, wanted: Evaluation, force: bool) -> Evaluation:
    """The evaluation to go on with.

    Raises:
        StaleStage: the folder holds another one; names what differs.
    """
    path = out / RECORD
    if force or not path.exists():
        path.unlink(missing_ok=True)
        for name in KEPT:
            shutil.rmtree(out / name, ignore_errors=True)
        return wanted
    record = Evaluation.read(path)
    ours, theirs = (
        {"policy": one.policy, **one.starts, **one.asking, **one.seeds.model_dump()} for one in (wanted, record)
    )
    for key in sorted({*ours, *theirs}):
        if ours.get(key) != theirs.get(key):
            ways = ["give another --out", "--force to replace it"]
            if key == "policy":
                ways.append(f"--name {shlex.quote(record.policy)} if this is the same policy elsewhere")
            raise StaleStage(
                f"{path} holds another evaluation: its {key} is {theirs.get(key)}, not {ours.get(key)}",
                hint=f"{', '.join(ways[:-1])}, or {ways[-1]}",
            )
    return record


def write_actions(out: Path, seed: int, actions: NDArray[np.float64]) -> None:
    """Keep the actions (T, D) of a rollout."""
    path = actions_file(out, seed)
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_path(path) as part, part.open("wb") as file:
        np.save(file, actions)


def actions_file(out: Path, seed: int) -> Path:
    """The file that keeps the actions of a rollout."""
    return out / "actions" / f"{seed}.npy"


def _seeds(order: Order, amount: Amount) -> Sequence[int] | Iterator[int]:
    """Numbers of the starts, in the order in which they are tried."""
    if order.policy != REPLAY:
        return range(amount.first_seed, 2**31)
    recorded = rollouts(order).recorded()
    if len(recorded) < amount.episodes:
        raise UsageError(
            f"the run has {len(recorded)} accepted episodes of this task, not {amount.episodes}",
            hint=f"--episodes {len(recorded)}" if recorded else "collect some",
        )
    return recorded


def _with(record: Evaluation, done: Outcome) -> Evaluation:
    """The record with one more outcome, in the order of the seeds."""
    if done.rollout is None:
        return record.model_copy(update={"left_out": {**record.left_out, done.seed: str(done.left_out)}})
    return record.model_copy(
        update={"rollouts": sorted([*record.rollouts, done.rollout], key=lambda rollout: rollout.seed)}
    )


def _require_counted(record: Evaluation, amount: Amount) -> None:
    """Refuse to go on where start after start is left out."""
    if not record.rollouts and len(record.left_out) >= amount.most_left_out:
        last = record.left_out[max(record.left_out)]
        raise MissingStage(
            f"none of {len(record.left_out)} starts is counted; the last: {last}",
            hint="look at the reasons of rejected episodes in the run's report",
            maker="collect",
        )
