"""One self-contained HTML page per run, made from the files of the stages.

The page marks unfinished stages as missing, and computes no result of its own.
"""

from __future__ import annotations

import base64
import logging
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import cv2
import numpy as np
from pydantic import ValidationError

from vcage.apps.asking import STAGE_OF_PROMPT
from vcage.apps.channel_sheet import channel_sheet
from vcage.apps.html import rendered
from vcage.apps.report.previews import Preview, previews
from vcage.base.drawing import distinct_colours
from vcage.base.errors import DamagedFile, InputFileError, MissingStage, StaleStage
from vcage.base.files import RunFolder, write_bytes
from vcage.base.leftovers import recover
from vcage.base.pictures import jpeg, read_picture
from vcage.base.version import __version__
from vcage.episodes.question import CUSTOMER, TOP
from vcage.episodes.store import read_log
from vcage.models.exchanges import Exchanges
from vcage.plans.kept import relations_kept_in
from vcage.runs.accepted import judged_steps, refusals
from vcage.runs.added_channels import RECORD as ADDED_CHANNELS
from vcage.runs.by_products import read_timings
from vcage.schema.base import StageDocument
from vcage.schema.compression import Compression
from vcage.schema.episodes import Difference, Episode, Episodes, Verdict, Verdicts
from vcage.schema.export import Export
from vcage.schema.matches import Matches
from vcage.schema.plan import Plan
from vcage.schema.randomisation import WorldRanges
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtasks

logger = logging.getLogger(__name__)

TEMPLATE = Path(__file__).with_name("page.html.jinja")

D = TypeVar("D", bound=StageDocument)


@dataclass(frozen=True)
class PageSettings:
    """Settings of the page.

    Args:
        jpeg_quality: of pictures.
        max_previews: accepted episodes shown as videos, the first ones: no browser opens a page with hundreds
            of them.
    """

    jpeg_quality: int = 88
    max_previews: int = 12


SETTINGS = PageSettings()


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
            f"{run} holds no run: {run.scene} does not exist", hint="run select_place first", maker="select_place"
        )
    recover(run.report)
    page = rendered(TEMPLATE, _context(run))
    return write_bytes(run.report, page.encode(errors="replace"))  # JSON may hold halves of characters


_TIMES = ("start", "before", "moment", "later", "after")
"""The times of a verdict's pictures, in the order in which its card shows them."""


def report_is_current(run: RunFolder) -> bool:
    """True if the page of a run exists and is newer than everything that it shows."""
    if not run.report.exists():
        return False
    made = run.report.stat().st_mtime_ns
    shown = (*run.documents, run.file(ADDED_CHANNELS))
    return all(path.stat().st_mtime_ns < made for path in shown if path.exists())


def _context(run: RunFolder) -> dict[str, Any]:
    """Gather the template's values: the documents, None for a stage that has not run, and their details."""
    scene, plan, layout = Scene.read(run.scene), _read(run.plan, Plan), _read(run.layout, Scene)
    matches, subtasks = _read(run.matches, Matches), _read(run.subtasks, Subtasks)
    episodes, again = _read(run.episodes, Episodes), _read(run.verdicts, Verdicts)
    documents = {"scene": scene, "plan": plan, "matches": matches, "layout": layout, "subtasks": subtasks}
    documents |= {"episodes": episodes, "judged_again": again}
    documents |= {"compression": _read(run.compression, Compression), "export": _read(run.export, Export)}
    cards = _episode_cards(run, episodes)
    return {
        **documents,
        **_starts(scene, episodes),
        **_attempts(run, episodes),
        "documents": [document for document in documents.values() if document is not None],
        "notes": [note for document in (plan, matches) if document for note in document.notes],
        "refusals": Counter(r.reason for r in subtasks.refused).most_common() if subtasks else [],
        "kept": relations_kept_in(layout, plan.relations) if plan and layout else None,
        "differences": [_difference_card(run, one) for one in again.differences] if again else [],
        "title": scene.instruction or f"Every sub-task of {scene.template}",
        "name": run.root.name,
        "version": __version__,
        "pictures": _stage_pictures(run),
        "cards": cards,
        "channels": _channels_url(run, cards),
        "counted": [card for card in cards if card["accepted"]],
        "previewed": SETTINGS.max_previews,
        "timings": read_timings(run),
        "exchanges": Exchanges(run.exchanges).all(),
        "asked_by": STAGE_OF_PROMPT | {"judge_subtask": "collect, verify"},
    }


def _attempts(run: RunFolder, episodes: Episodes | None) -> dict[str, Any]:
    """Attempts not accepted, and cards of the verdicts that refused them or that the state contradicts."""
    attempts = read_log(run.episodes.parent) if episodes else []
    rejections = [attempt for attempt in attempts if not attempt.accepted]
    disputed = [attempt for attempt in attempts if attempt.disputed]
    return {
        "rejections": rejections,
        "refused": [_verdict_card(run, a.verdict, a.subtask) for a in rejections if a.verdict and not a.disputed],
        "disputes": [{"attempt": a, **_verdict_card(run, a.verdict, a.subtask)} for a in disputed if a.verdict],
    }


def _starts(scene: Scene, episodes: Episodes | None) -> dict[str, Any]:
    """Start places of the objects in the accepted episodes, and refused layouts."""
    spread = episodes.spread() if episodes else {}
    colours = zip(spread, distinct_colours(len(spread)), strict=True)
    lower, upper = scene.table.rectangle.tolist()
    refused = sum((Counter(e.layouts_refused) for e in episodes.episodes), Counter()) if episodes else Counter()
    ranges = _world_ranges(episodes) if episodes else WorldRanges()
    return {
        "ranges": ranges.model_dump(exclude_defaults=True),
        "spread": spread,
        "colours": {name: "rgb({}, {}, {})".format(*colour) for name, colour in colours},
        "tabletop": (*lower, *upper),
        "refused_layouts": dict(refused.most_common()),
    }


def _world_ranges(episodes: Episodes) -> WorldRanges:
    """Read the ranges of the worlds of a collection.

    Raises:
        DamagedFile: its provenance does not say so.
    """
    try:
        return WorldRanges.model_validate(episodes.provenance.options["randomise"]["world"])
    except (KeyError, TypeError, ValidationError) as error:
        raise DamagedFile(
            "episodes.json: field provenance.options.randomise does not state the randomisation of the episodes",
            hint="restore the written file",
            maker="collect",
        ) from error


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
    return [
        {"title": title, "caption": caption, "url": url, "path": path}
        for title, caption, path in wanted
        if (url := _picture_url(run.file(path)))
    ]


def _episode_cards(run: RunFolder, episodes: Episodes | None) -> list[dict[str, Any]]:
    shown = episodes.episodes if episodes else []
    refused = _refused_by_verify(run)
    seen = [e for e in shown if e.accepted and e.file and e.file not in refused and run.file(e.file).is_file()]
    seen = seen[: SETTINGS.max_previews]
    shown_as = previews([(run.file(str(e.file)), e.fps) for e in seen])
    by_index = {e.index: preview for e, preview in zip(seen, shown_as, strict=True)}
    return [_episode_card(run, e, by_index.get(e.index), refused.get(e.file or "")) for e in shown]


def _channels_url(run: RunFolder, cards: Sequence[dict[str, Any]]) -> str | None:
    """The channels of the first episode that counts as a data URL; None where cameras took colour alone."""
    file = next((run.file(card["episode"].file) for card in cards if card["accepted"] and card["episode"].file), None)
    sheet = channel_sheet(file) if file is not None and file.is_file() else None
    return None if sheet is None else _data_url(sheet)


def _refused_by_verify(run: RunFolder) -> dict[str, str]:
    """Return the reason for each episode file refused by verify; verdicts on vanished episodes do not count."""
    try:
        return refusals(run)
    except StaleStage:
        return {}


def _episode_card(run: RunFolder, episode: Episode, preview: Preview | None, refused: str | None) -> dict[str, Any]:
    return {
        "episode": episode,
        "accepted": episode.accepted and refused is None,
        "why_not": refused if episode.accepted else episode.reason,
        "preview": preview,
        "verdicts": [_verdict_card(run, verdict, subtask) for subtask, verdict in judged_steps(run, episode)],
    }


def _verdict_card(run: RunFolder, verdict: Verdict, subtask: str) -> dict[str, Any]:
    found: list[tuple[int, str, str]] = []
    for name in verdict.pictures:
        rest, _, camera = Path(name).stem.rpartition("-")
        when = rest.rpartition("-")[2]
        url = _picture_url(run.file(name, "episodes"), max_width=480)
        if url and (when in ("moment", "later") or camera in (TOP, CUSTOMER)):
            found.append((_TIMES.index(when) if when in _TIMES else 0, url, f"{when}, {camera}"))
    found.sort(key=lambda one: one[0])
    return {"verdict": verdict, "subtask": subtask, "pictures": [{"url": url, "of": of} for _, url, of in found]}


def _difference_card(run: RunFolder, found: Difference) -> dict[str, Any]:
    return {"difference": found, "url": _picture_url(run.file(found.picture, "verify"))}


# --- pictures as data URLs, so that the page is one file ------------------------------------


def _picture_url(path: Path, max_width: int = 960) -> str | None:
    """A picture as a data URL, scaled down to ``max_width``; None when it is not there or cannot be read."""
    if not path.exists():
        return None
    try:
        picture = read_picture(path)
    except InputFileError as error:
        logger.warning("the report leaves a picture out: %s", error.message)
        return None
    height, width = picture.shape[:2]
    if width > max_width:
        picture = cv2.resize(picture, (max_width, round(height * max_width / width)), interpolation=cv2.INTER_AREA)
    return _data_url(picture)


def _data_url(picture: np.ndarray) -> str:
    return "data:image/jpeg;base64," + base64.b64encode(jpeg(picture, SETTINGS.jpeg_quality)).decode()
