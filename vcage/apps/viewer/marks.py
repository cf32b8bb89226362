"""Sub-tasks on the timeline: begin and end of each, verdict and truth."""

from __future__ import annotations

from vcage.apps.viewer.motion import Plot
from vcage.apps.viewer.rerun_log import Clock, RerunLog, rr
from vcage.datasets.episode import EpisodeData, Segment

LOG, NOW = "subtasks/log", "subtasks/now"
"""Entities: the log of all sub-tasks, and the text of the one that goes on."""

NUMBER, CRITIC, TRUTH = "marks/subtask", "marks/critic", "marks/truth"
"""Entities: which sub-task it is, from 1; the critic's verdict and the truth at its end, 1 for success."""


POINTS = {
    CRITIC: ("critic", (213, 94, 0), 9.0),
    TRUTH: ("truth", (0, 158, 115), 5.0),
}
"""Entity → name, colour and size of its points. The last is drawn over the first, which shows around it."""

MARGIN = 0.5
"""Room below and above the points and the numbers."""


def log_segments(log: RerunLog, clock: Clock, episode: EpisodeData) -> list[Plot]:
    """Log the sub-tasks.

    Args:
        log: where it is written.
        clock: when the episode's frames are.
        episode: whose sub-tasks.
    """
    if not episode.segments:
        return []
    _log_texts(log, clock, episode.segments)
    log.always(NUMBER, rr.SeriesLines(names="sub-task", colors=[(120, 120, 120)], widths=2.0))
    numbers = [sum(s.start <= frame for s in episode.segments) for frame in range(len(clock))]
    log.numbers(NUMBER, clock, numbers)
    ends = clock.at([s.end - 1 for s in episode.segments])
    for entity, (name, colour, size) in POINTS.items():
        points = rr.SeriesPoints(names=name, colors=[colour], markers="circle", marker_sizes=size)
        log.always(entity, points)
    log.numbers(CRITIC, ends, [s.verdict.accepted for s in episode.segments])
    log.numbers(TRUTH, ends, [s.truth.success for s in episode.segments])
    bounds = (-MARGIN, len(episode.segments) + MARGIN)
    return [Plot("Sub-task, verdict, truth", [NUMBER, *POINTS], bounds)]


def _log_texts(log: RerunLog, clock: Clock, segments: list[Segment]) -> None:
    starts = clock.at([s.start for s in segments])
    ends = clock.at([s.end - 1 for s in segments])
    cards = rr.TextDocument.columns(text=[_card(s) for s in segments], media_type=["text/markdown"] * len(segments))
    begun = rr.TextLog.columns(text=[f"{s.subtask}: {s.text}" for s in segments], level=["INFO"] * len(segments))
    endings = [f"{s.subtask}: {_verdict(s)}; {_truth(s)}" for s in segments]
    ended = rr.TextLog.columns(text=endings, level=[_level(s) for s in segments])
    log.rows(NOW, starts, cards)
    log.rows(LOG, starts, begun)
    log.rows(LOG, ends, ended)


def _card(segment: Segment) -> str:
    tries = "1 attempt" if segment.attempts == 1 else f"{segment.attempts} attempts"
    how = f"{segment.arm} arm, contact point {segment.contact}, {tries}, frames {segment.start} to {segment.end - 1}"
    return f"**{segment.text}**\n\n{how}\n\n{_verdict(segment)}\n\n{_truth(segment)}"


def _verdict(segment: Segment) -> str:
    verdict = segment.verdict
    outcome = "accepted" if verdict.accepted else "refused"
    return f"Critic {outcome} ({verdict.provider}, {verdict.confidence:.2f}): {verdict.reason}"


def _truth(segment: Segment) -> str:
    return f"Truth {'success' if segment.truth.success else 'failure'}: {segment.truth.reason}"


def _level(segment: Segment) -> str:
    """Warn where the critic was wrong."""
    return "INFO" if segment.verdict.accepted == segment.truth.success else "WARN"
