"""Which episodes of a run count: what collect accepted, and verify has not refused since.

A refused episode stays on disk where it is, and is left out of all that follows.
"""

from __future__ import annotations

import logging
import shutil
from pathlib import Path

from vcage.base.errors import DamagedFile, MissingStage, NotJudged
from vcage.base.files import RunFolder, sha256_file
from vcage.schema.episodes import Episode, Episodes, Verdict, Verdicts

logger = logging.getLogger(__name__)


def accepted_episodes(run: RunFolder) -> list[Episode]:
    """The episodes that count, which have a file; none when nothing was collected yet.

    Raises:
        NotJudged: verify judged other episodes than there are now.
        DamagedFile, SchemaMismatch: what was collected, or judged, cannot be read.
    """
    collected = Episodes.read(run.episodes).episodes if run.episodes.exists() else []
    refused = refusals(run)
    return [e for e in collected if e.accepted and e.file is not None and e.file not in refused]


def judged_steps(run: RunFolder, episode: Episode) -> list[tuple[str, Verdict]]:
    """The sub-tasks of an episode, each with its verdict.

    Raises:
        DamagedFile: there are not as many of the one as of the other.
    """
    if len(episode.subtasks) != len(episode.verdicts):
        raise DamagedFile(
            f"{run.episodes}: field episodes: episode {episode.index} has {len(episode.verdicts)} verdicts on "
            f"{len(episode.subtasks)} sub-tasks; expected one on each",
            hint="put back what was written",
            maker="collect",
        )
    return list(zip(episode.subtasks, episode.verdicts, strict=True))


def refusals(run: RunFolder) -> dict[str, str]:
    """File of an episode that collect accepted → why verify refuses it; none where verify has not looked.

    Raises:
        NotJudged, DamagedFile, SchemaMismatch: see :func:`accepted_episodes`.
    """
    if not run.verdicts.exists() or not run.episodes.exists():
        return {}
    verdicts, judged = Verdicts.read(run.verdicts), run.relative(run.episodes)
    if verdicts.provenance.inputs.get(judged) != sha256_file(run.episodes):
        raise NotJudged(
            f"{run.verdicts} judges other episodes than {run.episodes} has now",
            maker="verify",
            details={"changed": [f"input {judged}"]},
        )
    return verdicts.refused


def none_counts(run: RunFolder) -> MissingStage | None:
    """The error of a run in which no episode counts: says why, and how there may be some.

    None where some do, or nothing was collected yet.
    """
    if not run.episodes.exists() or accepted_episodes(run):
        return None
    refused = refusals(run)
    if not refused:
        hint = "collect others: another --seed gives another layout"
        return MissingStage(f"{run.episodes} holds no accepted episode", hint=hint, maker="collect")
    record = Episodes.read(run.episodes)
    most = 2 * -(-sum(episode.accepted for episode in record.episodes) // len(record.chains))
    return MissingStage(
        f"no episode counts: {'; '.join(f'verify refused {file}: {reason}' for file, reason in refused.items())}",
        hint=f"accept in {run.verdicts} what is wrongly refused there, or collect more",
        maker="collect",
        details={"refused": refused, "more": {"episodes": [f"--episodes={most}"]}},
    )


def withdraw(data_sets: Path) -> None:
    """Remove exported data sets of which no episode counts any more; they can be exported again when some do."""
    if data_sets.exists():
        logger.warning("%s is removed, as none of its episodes counts any more", data_sets)
        shutil.rmtree(data_sets)


def decided_by(run: RunFolder) -> list[Path]:
    """The files that say which episodes count: inputs of whatever takes these."""
    return [run.episodes, *([run.verdicts] if run.verdicts.exists() else [])]
