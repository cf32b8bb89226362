"""A picture of a question on which two critics differ: their views, their verdicts, and the truth."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence

import numpy as np

from vcage.base.drawing import EDGE, INK, PAPER, WARNING, WORDS, Canvas, Colour, contact_sheet
from vcage.schema.episodes import Difference, Verdict
from vcage.tasks.setting import Seen


def draw_difference(found: Difference, seen: Seen, line_px: int = 28, letters: int = 120) -> np.ndarray:
    """Draw the views before and after side by side, other moments below, and the verdicts under them.

    Args:
        found: the difference; a verdict that contradicts the simulator's state is red.
        seen: the pictures shown to both critics, (H, W, 3) uint8 RGB.
        line_px: height of a line of text.
        letters: per line, as wide as an average verdict's.

    Returns:
        (H', W', 3) uint8, two views wide.
    """
    sheet, lines = contact_sheet(_views(seen)), list(_lines(found, letters))
    below = np.full((len(lines) * line_px + EDGE, sheet.shape[1], 3), PAPER, dtype=np.uint8)
    canvas = Canvas(below, text_size=WORDS)
    for number, (line, colour) in enumerate(lines):
        canvas.text((EDGE, number * line_px), line, fill=colour)
    return np.vstack([sheet, canvas.picture()])


def _views(seen: Seen) -> Sequence[tuple[str, np.ndarray]]:
    """Return captions and pictures: before and after of each camera in the order of use, then the others."""
    cameras = dict.fromkeys(camera for pictures in seen.values() for camera in pictures)
    order = [(when, camera) for camera in cameras for when in ("before", "after")]
    order += [(when, camera) for when in seen if when not in ("before", "after") for camera in cameras]
    return [(f"{when}, {camera}", seen[when][camera]) for when, camera in order if camera in seen.get(when, {})]


def _lines(found: Difference, letters: int) -> Iterator[tuple[str, Colour]]:
    """Yield the text, line by line, with its colour."""
    said = [("while collecting", found.earlier_verdict), ("again", found.verdict)]
    paragraphs = [(f"Episode {found.episode}, step {found.step}, attempt {found.attempt}: {found.text}", INK)]
    paragraphs += [(_verdict(when, v), WARNING if v.accepted != found.truth.success else INK) for when, v in said]
    paragraphs += [(f"The simulator's state says {'yes' if found.truth.success else 'no'}: {found.truth.reason}", INK)]
    for words, colour in paragraphs:
        yield from ((line, colour) for line in textwrap.wrap(words, letters, subsequent_indent="    "))


def _verdict(when: str, said: Verdict) -> str:
    yes = "yes" if said.accepted else "no"
    return f"{said.provider}, {when}, says {yes} ({said.confidence:.2f}): {said.reason}"
