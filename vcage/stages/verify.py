"""Judge collected episodes again, or any pair of pictures of a run's table (paper, section III-C)."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vcage.base.errors import StaleStage
from vcage.base.files import RunFolder
from vcage.base.options import Flag
from vcage.base.pictures import write_picture
from vcage.base.progress import Progress, silent
from vcage.episodes.differences import draw_difference
from vcage.episodes.second_judge import JudgedStep, SecondJudge
from vcage.episodes.store import confusion, log_path, read_log
from vcage.runs.accepted import DECISIONS, decided, judged_steps
from vcage.runs.context import StageContext
from vcage.runs.edits import Edit, Editable
from vcage.runs.stage import Job, ModelOptions, StageResult, stage_seed
from vcage.schema.base import Provenance
from vcage.schema.episodes import BY_HAND, Attempt, Difference, Episodes, Verdict, Verdicts

logger = logging.getLogger(__name__)

_Tried = tuple[Attempt, JudgedStep]
"""An attempt, and its judged sub-task."""


@dataclass(frozen=True, kw_only=True)
class Options(ModelOptions):
    """Options of judging again."""

    refused: Flag = False
    """judge the rejected attempts, too, with stored pictures: to compare two critics"""


def job(run: RunFolder, options: Options, context: StageContext) -> Job:
    """Return the work of the stage."""
    return Job(
        run=run,
        output=run.verdicts,
        inputs=[run.layout, run.subtasks, run.episodes, log_path(run.episodes.parent)],
        seed=stage_seed(run, options.seed),
        options={"refused": True} if options.refused else {},
        providers=context.models.providers("critic"),
    )


def summary(record: Verdicts) -> dict[str, Any]:
    """Return a few facts for the caller."""
    return {
        "episodes": len(record.episodes),
        "verified": len(record.episodes) - len(record.refused),
        "refused": record.refused,
        "taken_over": record.taken_over,
        "critic": record.critic.model_dump(mode="json"),
        "earlier_critic": record.earlier_critic.model_dump(mode="json"),
        "not_kept": record.not_kept,
        "differ": len(record.differences),
    }


def execute(
    run: RunFolder, options: Options, context: StageContext, progress: Progress = silent
) -> StageResult[Verdicts]:
    """Write ``verify/verdicts.json``: a verdict on every sub-task of the accepted episodes, and both critics counted.

    With ``refused`` also on every other attempt with stored pictures and truth; else these are not judged.
    Verdicts of the same critic on the same pictures, from collecting, are taken over unless ``force`` is set. Decisions
    by hand stay where there are other episodes by now. Where the two critics differ, a picture in
    ``verify/differences`` shows their pictures.
    """
    stage = job(run, options, context)
    earlier = None if options.force else _of_other_episodes(stage)

    def make(folder: Path, provenance: Provenance) -> Verdicts:
        then = Episodes.read(run.episodes).provenance
        same_critic = (provenance.version, provenance.providers["critic"]) == (
            then.version,
            then.providers.get("critic"),
        )
        judge = SecondJudge(run, context, take_over=same_critic and not options.force)
        return _decided(earlier, _judged(run, judge, folder, provenance, progress, refused=options.refused))

    return stage.do(Verdicts, make, force=options.force or earlier is not None)


def _of_other_episodes(stage: Job) -> Verdicts | None:
    """Return earlier verdicts that are stale only because the number of episodes has changed."""
    try:
        stage.finished(Verdicts, force=False)
    except StaleStage as error:
        run = stage.run
        grown = {f"input {run.relative(path)}" for path in (run.episodes, log_path(run.episodes.parent))}
        if {*error.details["changed"]} <= grown:
            return Verdicts.read(run.verdicts)
        raise
    return None


def _decided(earlier: Verdicts | None, record: Verdicts) -> Verdicts:
    """Return verdicts with earlier decisions by hand on the same episodes."""
    if earlier is None:
        return record
    known = {v.question: v for said in earlier.episodes.values() for v in said if v.provider == BY_HAND}
    episodes = {name: [known.get(v.question, v) for v in said] for name, said in record.episodes.items()}
    return record.model_copy(update={"episodes": episodes, "edited": earlier.edited})


def _accept(edit: Edit[Verdicts]) -> Verdicts:
    """Take the decisions of a person."""
    was = edit.was.episodes
    episodes = {
        name: [decided(*pair) for pair in zip(was[name], said, strict=True)]
        for name, said in edit.record.episodes.items()
    }
    return edit.record.model_copy(update={"episodes": episodes})


EDITABLE = Editable(Verdicts, fields=[f"episodes.*.*.{said}" for said in DECISIONS], accept=_accept)


def _judged(
    run: RunFolder, judge: SecondJudge, folder: Path, provenance: Provenance, progress: Progress, *, refused: bool
) -> Verdicts:
    """Judge every sub-task of the accepted episodes, whose pictures must exist; with ``refused`` also every other
    attempt that can be judged."""
    collected = Episodes.read(run.episodes)
    accepted = [episode for episode in collected.episodes if episode.accepted]
    steps = [JudgedStep(e.index, *step) for e in accepted for step in judged_steps(run, e)]
    tried = _judged_attempts(run, None if refused else steps)
    counted = _countable(tried, judge)
    said = judge.judge_all([*steps, *(step for _, step in counted)], progress)
    return Verdicts(
        provenance=provenance,
        accept=collected.accept,
        episodes={e.file or f"episode {e.index}": [said[tuple(v.pictures)] for v in e.verdicts] for e in accepted},
        taken_over=judge.taken_over,
        critic=confusion([a.model_copy(update={"verdict": said[step.pictures]}) for a, step in counted]),
        earlier_critic=confusion([attempt for attempt, _ in counted]),
        not_kept=len(tried) - len(counted),
        differences=list(_differences(judge, counted, said, folder)),
    )


def _judged_attempts(run: RunFolder, verified: Iterable[JudgedStep] | None) -> list[_Tried]:
    """Return every judged attempt; with ``verified`` only those of these steps."""
    tried = [(a, JudgedStep(a.episode, a.subtask, a.verdict)) for a in read_log(run.episodes.parent) if a.verdict]
    if verified is None:
        return tried
    pictures = {step.pictures for step in verified}
    return [(attempt, step) for attempt, step in tried if step.pictures in pictures]


def _countable(tried: Sequence[_Tried], judge: SecondJudge) -> list[_Tried]:
    """Return the attempts with stored pictures and truth, which count."""
    found = [(attempt, step) for attempt, step in tried if attempt.truth and judge.has_pictures(step)]
    if tried and not found:
        logger.warning("verify: none of %d judged attempts has stored pictures and truth: nothing to count", len(tried))
    return found


def _differences(
    judge: SecondJudge,
    counted: Iterable[_Tried],
    said: Mapping[tuple[str, ...], Verdict],
    folder: Path,
) -> Iterator[Difference]:
    """Record and draw every attempt on which the two verdicts differ."""
    for attempt, step in counted:
        verdict = said[step.pictures]
        if verdict.accepted == step.earlier.accepted:
            continue
        found = Difference(
            episode=attempt.episode,
            step=attempt.step,
            attempt=attempt.attempt,
            subtask=attempt.subtask,
            text=judge.subtask(step).text,
            earlier_verdict=step.earlier.model_copy(update={"pictures": judge.picture_paths(step)}),
            verdict=verdict,
            truth=attempt.truth,  # pyrefly: ignore
            picture=f"differences/e{attempt.episode:06d}-s{attempt.step}-a{attempt.attempt}.png",
        )
        write_picture(folder / found.picture, draw_difference(found, judge.pictures(step)))
        yield found
