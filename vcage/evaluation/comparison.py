"""Two evaluations from the same starts: which succeeds where, and by how much chance alone explains the difference."""

from __future__ import annotations

from pathlib import Path

from vcage.base.errors import UsageError
from vcage.schema.evaluation import Comparison, Evaluation

VARY = "vary"
"""The option of a start that says which factor is changed; two evaluations may be compared across it."""


def require_same_starts(this: Evaluation, other: Evaluation) -> None:
    """Require that two evaluations draw the same starts from the same seeds, but for a factor that is changed.

    Raises:
        UsageError: they do not; names what differs.
    """
    ours, theirs = ({**one.starts, "seed of the scene": one.seeds.scene} for one in (this, other))
    differing = sorted(key for key in {*ours, *theirs} - {VARY} if ours.get(key) != theirs.get(key))
    if differing:
        key = differing[0]
        raise UsageError(
            f"the two evaluations have other starts: {key} is {ours.get(key)} here and {theirs.get(key)} there",
            hint="evaluate both in one run, with the same options of the starts",
            details={"differing": differing},
        )


def require_shared_seeds(other: Evaluation, first: int, episodes: int) -> None:
    """Require that an evaluation may share starts with another one that is finished.

    Args:
        other: the finished one.
        first: seed of the first start.
        episodes: that are to be counted.

    Raises:
        UsageError: the other counts none of these seeds.
    """
    after = first + episodes + sum(seed >= first for seed in other.left_out)  # later ones stand in for these
    if not any(first <= rollout.seed < after for rollout in other.rollouts):
        raise UsageError(
            f"the two evaluations share no start: the seeds {first} to {after - 1} are none of the other's",
            hint=f"give both the same: --first-seed {other.seeds.first}",
        )


def compare(this: Evaluation, other: Evaluation, name: str) -> Comparison:
    """Compare two evaluations on the starts that both count.

    Args:
        this: the evaluation.
        other: the one that it is compared with.
        name: of the other.

    Raises:
        UsageError: as :func:`require_same_starts`; or they share no start.
    """
    require_same_starts(this, other)
    mine, others = ({rollout.seed: rollout.success for rollout in one.rollouts} for one in (this, other))
    pairs = [(success, others[seed]) for seed, success in mine.items() if seed in others]
    if not pairs:
        raise UsageError("the two evaluations share no start", hint="give both the same --first-seed")
    b, c = pairs.count((True, False)), pairs.count((False, True))
    return Comparison(
        name=name,
        n_episodes=len(pairs),
        n_success=sum(mine for mine, _ in pairs),
        n_success_other=sum(theirs for _, theirs in pairs),
        b=b,
        c=c,
        mcnemar_p=mcnemar_p(b, c),
    )


def mcnemar_p(b: int, c: int) -> float:
    """Two-sided p-value of McNemar's exact test.

    Args:
        b, c: pairs in which only the one or only the other succeeds.
    """
    from scipy.stats import binomtest  # half a second, which most evaluations do not need

    return float(binomtest(b, b + c).pvalue) if b + c else 1.0


def read_other(path: Path) -> Evaluation:
    """Read the evaluation to compare with: a folder of one, or its file.

    Raises:
        MissingStage, DamagedFile, SchemaMismatch: there is none.
    """
    return Evaluation.read(path / "evaluation.json" if path.is_dir() else path)
