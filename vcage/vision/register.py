"""Registration: brings the answer of an image model into the frame of the picture that the model was given.

Image models answer in sizes of their own, mostly of the same aspect. Some crop or pad, zoom a little, and change
colours. They keep the table: its edges against the ground, and often its grain. So the fit uses the empty table alone
and ignores the objects, which were moved. A fit that the table does not confirm is not applied: the answer is resized
as a whole, and a note says so.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.vision.register_edges import Axis, EdgesAlong, confirmed_by, laid, warp_of
from vcage.vision.register_texture import grain_fit

UNSEEN = ": the table is not seen well enough to check where the picture lies over it"


@dataclass(frozen=True)
class RegistrationSettings:
    """Tolerances of the registration; stretches as logarithms.

    Args:
        same_aspect: stretch that is rounding: sizes are whole numbers.
        padded_aspect: stretch that may remain without the padding: the padded picture may have another aspect.
        bent_stretch: the edges are bent if both axes, each fitted by itself, differ by a larger stretch.
        bent_edge_px: image models bend an edge by as much.
        confirmed_px: largest error of the table's edges in an answer that lies where it should.
        least_shift_px: a fit that moves no corner by more is not worth resampling.
        largest_turn_px: turn of the picture, measured at its sides, above which a note says so.
        uniform_levels: grey levels by which the pixels of a padded border may differ.
    """

    same_aspect: float = 0.01
    padded_aspect: float = 0.03
    bent_stretch: float = 0.03
    bent_edge_px: float = 3.0
    confirmed_px: float = 1.25
    least_shift_px: float = 1.0
    largest_turn_px: float = 0.6
    uniform_levels: float = 6.0


SETTINGS = RegistrationSettings()

ZOOMS, FEW_ZOOMS = (np.exp(np.arange(np.log(low), np.log(high), 0.015)) for low, high in ((0.78, 1.14), (0.9, 1.06)))
"""Scales at which the grain is searched: editors zoom in by cropping, and out a little; less if the aspect changed."""


@dataclass(frozen=True)
class Registered:
    """A picture in the frame of the source.

    Args:
        picture: (H, W, 3) uint8 RGB in the source's size; the empty table beyond the answer.
        valid: (H, W) bool, pixels that the answer shows.
        warp: (2, 3) float64, pixels of the answer to pixels of the source; centres at whole numbers.
        notes: changes and their certainty, for the record; empty when nothing was changed.
    """

    picture: np.ndarray
    valid: np.ndarray
    warp: np.ndarray
    notes: list[str]


def register(target: np.ndarray, source: np.ndarray, background: np.ndarray) -> Registered:
    """Undo an image model's changes of size and frame.

    Args:
        target: (h, w, 3) uint8 RGB of any size.
        source: (H, W, 3) uint8 top view that the model was given.
        background: (H, W, 3) uint8, the same view of the empty table.

    Raises:
        ValueError: ``target`` is not such a picture, or source and background differ in size.
    """
    if source.shape != background.shape:
        raise ValueError(f"source and background differ in size: {source.shape} and {background.shape}")
    if target.ndim != 3 or target.shape[2] != 3 or target.dtype != np.uint8 or not target.size:
        raise ValueError(f"expected an (h, w, 3) uint8 picture, got {target.dtype} of the shape {target.shape}")
    size, notes = (source.shape[1], source.shape[0]), []
    u0, v0, u1, v1 = _content(target, size)
    content = target[v0:v1, u0:u1]
    if content.shape != target.shape:
        notes.append(f"padding was cut off; columns {u0} to {u1} and rows {v0} to {v1} are left")
    whole = _resized(content, size)
    x, y, note = _fit(whole, background, content.shape[1] / content.shape[0] * size[1] / size[0])
    if max(axis.largest_shift(length) for axis, length in zip((x, y), size)) < SETTINGS.least_shift_px:
        x, y = Axis(), Axis()
    laid_over, valid = _applied(whole, (x, y), background)
    resized = Axis.between((u0, u1), (0, size[0])), Axis.between((v0, v1), (0, size[1]))
    warp = warp_of((x.after(resized[0]), y.after(resized[1])))
    return Registered(laid_over, valid, warp, [*notes, *([note] if note else [])])


# --- fit of the answer over the source ----------------------------------------------------------------------


def _fit(whole: np.ndarray, background: np.ndarray, aspect: float) -> tuple[Axis, Axis, str]:
    """The fit along x and y of a picture, resized to the source's size, over the source; and a note on it.

    Args:
        whole: (H, W, 3) uint8, the picture.
        background: (H, W, 3) uint8, the empty table.
        aspect: ratio of the aspects of the picture and the source.
    """
    aspect = 1.0 if abs(np.log(aspect)) < SETTINGS.same_aspect else aspect
    empty, seen = (np.asarray(cv2.cvtColor(picture, cv2.COLOR_RGB2LAB)) for picture in (background, whole))
    along = [EdgesAlong.of(empty, seen, axis) for axis in (1, 0)]
    confirmed = confirmed_by(along, SETTINGS.confirmed_px)
    if confirmed and aspect == 1:
        return Axis(), Axis(), ""
    by_texture = _by_texture(whole, background, aspect)
    if by_texture is not None:
        return by_texture
    x, y = [Axis() if one.edges else None for one in along] if confirmed else _by_edges(along)
    return _completed(x, y, aspect, whole.shape[1::-1])


def _by_texture(whole: np.ndarray, background: np.ndarray, aspect: float) -> tuple[Axis, Axis, str] | None:
    """The fit by the table's grain, see :func:`_fit`; None if the grain is not visible.

    The aspect is exactly 1 if picture and source have the same.
    """
    # The model stretched the picture to the answer's aspect; or cropped or extended it, which keeps one side whole.
    plain = [(1.0, 1.0)] if aspect == 1 else [(1.0, 1.0), (1.0, 1 / aspect), (aspect, 1.0)]
    zooms = (1.0, *(ZOOMS if aspect == 1 else FEW_ZOOMS))
    theirs, ours = (cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY) for picture in (whole, background))
    found = grain_fit(theirs, ours, [(zoom * sx, zoom * sy) for sx, sy in plain for zoom in zooms])
    if found is None:
        return None
    (sx, sy, tx, ty), turn = found
    turned = "; it is turned a little, which is not undone" if abs(turn) > SETTINGS.largest_turn_px else ""
    return Axis(sx, tx), Axis(sy, ty), f"laid over the table by its grain: {_spelled((sx, sy))}{turned}"


def _by_edges(along: Sequence[EdgesAlong]) -> list[Axis | None]:
    """The fit of the table's edges along x and y; None for an axis without edges, and for both if one is ambiguous."""
    found: list[Axis | None] = []
    for one in along:
        ways = laid(one.empty, one.edges, one.seen) if one.edges else []
        if one.edges and len(ways) != 1:
            return [None, None]
        bent = bool(ways) and ways[0].largest_shift(len(one.seen.change)) < SETTINGS.bent_edge_px
        found.append(Axis() if bent else ways[0] if ways else None)
    return found


def _completed(x: Axis | None, y: Axis | None, aspect: float, size: Sequence[int]) -> tuple[Axis, Axis, str]:
    """The fit by the edges of the table along x and y; an open axis is centred, and the note says so.

    Args:
        x, y: fits of the edges.
        aspect: exactly 1 if picture and source have the same.
        size: width and height of the source, pixels.
    """
    if x is None and y is None:
        how = "resized as a whole" if aspect == 1 else "taken to be cropped evenly"
        x, y = _centred(min(1.0, aspect), size[0]), _centred(min(1.0, 1 / aspect), size[1])
        return x, y, f"{how}{UNSEEN}"
    if x is None or y is None:
        return _with_one_centred(x, y, aspect, size)
    if min(abs(np.log(x.scale / y.scale / shape)) for shape in (1.0, aspect)) > SETTINGS.bent_stretch:
        return Axis(), Axis(), f"resized as a whole{UNSEEN}"
    return x, y, f"laid over the table by its edges: {_spelled((x.scale, y.scale))}"


def _with_one_centred(x: Axis | None, y: Axis | None, aspect: float, size: Sequence[int]) -> tuple[Axis, Axis, str]:
    """:func:`_completed` for one open axis."""
    side = "across" if x is None else "along"
    x = x or _centred(_open_scale((y or Axis()).scale, aspect), size[0])
    y = y or _centred(_open_scale(x.scale, 1 / aspect), size[1])
    if aspect == 1 and (x, y) == (Axis(), Axis()):
        return x, y, ""
    how = f"laid over the table by its edges: {_spelled((x.scale, y.scale))}"
    return x, y, f"{how}; {side} the table it was not checked, and is taken to be centred"


def _open_scale(known: float, aspect: float) -> float:
    """The scale of the open axis: for square pixels, or stretched if square pixels would exceed the picture."""
    square = known * aspect
    return square if square <= 1 + SETTINGS.same_aspect else min(square, known, key=lambda scale: abs(np.log(scale)))


def _centred(scale: float, length: int) -> Axis:
    return Axis(float(scale), float((1 - scale) * (length - 1) / 2))


def _spelled(scale: Sequence[float]) -> str:
    return f"scaled by {scale[0]:.3f} and {scale[1]:.3f}"


# --- padding ---------------------------------------------------------------------------------------------------


def _content(picture: np.ndarray, size: tuple[int, int]) -> tuple[int, int, int, int]:
    """The box (u0, v0, u1, v1) without the padding that an editor added to reach its own aspect.

    Even ground beside a table looks like a padding, so a border is one only if the rest has the aspect of the source.
    """
    whole = 0, 0, picture.shape[1], picture.shape[0]
    for box in (whole, unpadded(picture)):
        if abs(np.log((box[2] - box[0]) / (box[3] - box[1]) * size[1] / size[0])) < SETTINGS.padded_aspect:
            return box
    return whole


def unpadded(picture: np.ndarray) -> tuple[int, int, int, int]:
    """The box (u0, v0, u1, v1) without borders of one colour; at least half of each side."""
    box = [0, 0, picture.shape[1], picture.shape[0]]
    for axis, lines in enumerate((picture.transpose(1, 0, 2), picture)):
        first, last = _border(lines), len(lines) - _border(lines[::-1])
        if last - first >= len(lines) / 2:
            box[axis], box[axis + 2] = first, last
    return box[0], box[1], box[2], box[3]


def _border(lines: np.ndarray) -> int:
    """Number of lines from the first on that have the colour of the first all along, except one pixel in fifty."""
    colour = np.median(lines[0], axis=0)
    for k, line in enumerate(lines):
        off = np.abs(line - colour).max(axis=1)
        rank = -(len(off) // 50) - 1
        if np.partition(off, rank)[rank] >= SETTINGS.uniform_levels:
            return k
    return len(lines)


# --- resampling ------------------------------------------------------------------------------------------------


def _resized(picture: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """The picture in a size (width, height); shrunk by averaging, as sampling would skip pixels."""
    if picture.shape[1::-1] == size:
        return picture
    smaller = size[0] <= picture.shape[1] and size[1] <= picture.shape[0]
    return cv2.resize(picture, size, interpolation=cv2.INTER_AREA if smaller else cv2.INTER_CUBIC)


def _applied(whole: np.ndarray, fit: tuple[Axis, Axis], background: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(the picture resampled, with the empty table beyond it; (H, W) bool, the pixels that it shows)."""
    size, warp = whole.shape[1::-1], warp_of(fit)
    if fit == (Axis(), Axis()):
        return whole, np.ones(whole.shape[:2], bool)
    valid = cv2.warpAffine(np.ones(whole.shape[:2], np.uint8), warp, size, flags=cv2.INTER_NEAREST) > 0
    whole = cv2.warpAffine(whole, warp, size, flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    return np.where(valid[..., None], whole, background), valid
