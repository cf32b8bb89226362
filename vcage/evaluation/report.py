"""The page of an evaluation: figures, comparisons, and videos of failures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from vcage.apps.html import rendered
from vcage.apps.report.previews import video_url
from vcage.base.files import write_text
from vcage.schema.evaluation import Comparison, Evaluation

PAGE = "report.html"
TEMPLATE = Path(__file__).with_name("report.html.jinja")


def write_page(
    out: Path,
    record: Evaluation,
    videos: Mapping[int, Path],
    comparisons: Sequence[Comparison] = (),
    links: Mapping[str, str] | None = None,
) -> Path:
    """Write ``report.html``, which needs no other file but the pages that it links to.

    Args:
        out: folder of the evaluation.
        record: of it.
        videos: seed → the MP4 of its rollout.
        comparisons: with other evaluations.
        links: name of a comparison → the page of the other one, from here.
    """
    values = {
        "record": record,
        "facts": record.facts(),
        "comparisons": comparisons,
        "links": links or {},
        "videos": {seed: video_url(path.read_bytes()) for seed, path in videos.items()},
    }
    return write_text(out / PAGE, rendered(TEMPLATE, values))
