"""One self-contained HTML page per run, made from the files that the stages left.

Stages that have not run are said to be missing; the page never computes a result of its own.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import jinja2
import numpy as np

from vcage import __version__
from vcage.apps.report.embed import picture_url, video_url
from vcage.base.errors import MissingStage
from vcage.base.files import RunFolder, recover, write_text
from vcage.datasets.reader import EpisodeReader
from vcage.plans.kept import Kept, relations_kept_in
from vcage.schema.base import StageDocument
from vcage.schema.compression import Compression
from vcage.schema.episodes import Attempt, Episode, Episodes, Verdict
from vcage.schema.export import Export
from vcage.schema.matches import Matches
from vcage.schema.plan import Plan
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtasks
from vcage.stages.episode_store import read_log
from vcage.stages.stage import read_timings

D = TypeVar("D", bound=StageDocument)


def write_report(run: RunFolder) -> Path:
    """Write ``report.html`` of a run, whole or partly done.

    Example:
        >>> write_report(RunFolder("runs/blocks"))

    Raises:
        MissingStage: not even the first stage has run.
        DamagedFile, SchemaMismatch: a stage's file cannot be read.
    """
    if not run.scene.exists():
        raise MissingStage(
            f"{run} holds no run: {run.scene} does not exist", hint="run select_place first, or vcage run"
        )
    recover(run.report)
    return write_text(run.report, _template().render(**_context(run)))


def _context(run: RunFolder) -> dict[str, Any]:
    episodes = _read(run.episodes, Episodes)
    documents = {
        "scene": _read(run.scene, Scene),
        "plan": _read(run.plan, Plan),
        "matches": _read(run.matches, Matches),
        "layout": _read(run.layout, Scene),
        "subtasks": _read(run.subtasks, Subtasks),
        "episodes": episodes,
        "compression": _read(run.compression, Compression),
        "export": _read(run.export, Export),
    }
    rejections = _rejections(run) if episodes else []
    return {
        **documents,
        "kept": _kept(documents["plan"], documents["layout"]),
        "notes": _notes(documents["plan"], documents["matches"]),
        "version": __version__,
        "name": run.root.name,
        "pictures": _stage_pictures(run),
        "cards": [_episode_card(run, e) for e in episodes.episodes] if episodes else [],
        "rejections": rejections,
        "refused": [_verdict_card(run, a.verdict, a.subtask) for a in rejections if a.verdict],
        "timings": read_timings(run),
        "provenances": [d.provenance for d in documents.values() if d is not None],
        "refusals": _refusals(documents["subtasks"]),
    }


def _read(path: Path, document: type[D]) -> D | None:
    return document.read(path) if path.exists() else None


def _stage_pictures(run: RunFolder) -> list[dict[str, str]]:
    """Title, caption and data URL of each stage's picture that exists."""
    wanted = [
        ("Initial placement", "Selected objects at collision-free random places, seen from above", "place/source.png"),
        ("Segmentation", "Which pixel belongs to which object", "place/segmentation_view.png"),
        ("Target picture", "The layout plan, drawn by the image editor", "inpaint/target.png"),
        ("Correspondences", "Where each object was found again in the target picture", "match/overlay.png"),
        ("Layout before and after", "Matched targets, and the collision-free optimum", "optimize/layout.png"),
        ("Final scene", "The optimised scene, rebuilt in the simulator and settled", "optimize/top.png"),
    ]
    found = []
    for title, caption, path in wanted:
        url = picture_url(run.root / path)
        if url is not None:
            found.append({"title": title, "caption": caption, "url": url, "path": path})
    return found


def _kept(plan: Plan | None, layout: Scene | None) -> Kept | None:
    """Which of the plan's relations hold in the final scene."""
    return relations_kept_in(layout, plan.relations) if plan and layout else None


def _notes(plan: Plan | None, matches: Matches | None) -> list[str]:
    """What the stages said of the target picture; of single objects the table of matches tells."""
    return (plan.notes if plan else []) + (matches.notes if matches else [])


def _refusals(subtasks: Subtasks | None) -> list[tuple[str, int]]:
    """Reasons of refusal with how often each was given, the most frequent first."""
    if subtasks is None:
        return []
    return Counter(refusal.reason for refusal in subtasks.refused).most_common()


# --- episodes ------------------------------------------------------------------------------------------


def _episode_card(run: RunFolder, episode: Episode) -> dict[str, Any]:
    path = run.root / episode.file if episode.file else None
    video = _preview(path, episode.fps) if path and path.is_file() else None
    judged = zip(episode.verdicts, episode.subtasks, strict=True)
    return {"episode": episode, "video": video, "verdicts": [_verdict_card(run, v, s) for v, s in judged]}


def _verdict_card(run: RunFolder, verdict: Verdict, subtask: str) -> dict[str, Any]:
    urls = [picture_url(run.episodes.parent / picture, max_width=480) for picture in verdict.pictures]
    return {"verdict": verdict, "subtask": subtask, "pictures": [url for url in urls if url]}


def _preview(path: Path, fps: float) -> str | None:
    """All cameras of an episode side by side; None of a rejected one, which is kept without pictures."""
    with EpisodeReader(path) as reader:
        return video_url(_side_by_side(reader), fps) if reader.cameras else None


def _side_by_side(reader: EpisodeReader) -> Iterator[np.ndarray]:
    tracks = [reader.images(camera) for camera in reader.cameras]
    for i in range(len(tracks[0])):
        yield np.concatenate([track[i] for track in tracks], axis=1)


def _rejections(run: RunFolder) -> list[Attempt]:
    """Attempts that were not accepted, from the log."""
    return [attempt for attempt in read_log(run.episodes.parent) if not attempt.accepted]


@cache
def _template() -> jinja2.Template:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("vcage.apps.report", package_path=""),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["size"] = _size
    environment.filters["percent"] = lambda share: f"{100 * share:.2f} %"
    return environment.get_template("page.html.jinja")


def _size(count: float) -> str:
    """Bytes for people: 1.2 MB."""
    for unit in ("B", "kB", "MB", "GB"):
        if count < 1000 or unit == "GB":
            return f"{count:.0f} {unit}" if unit == "B" else f"{count:.1f} {unit}"
        count /= 1000
    raise AssertionError("unreachable")
