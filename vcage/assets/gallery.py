"""A contact sheet of given pictures: one labelled cell per name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import cv2
import numpy as np

from vcage.files import write_bytes

LABEL = 18
"""Height of a label, pixels."""


def compose_gallery(pictures: Mapping[str, Sequence[np.ndarray]], path: Path, columns: int = 4) -> Path:
    """Write a PNG with one labelled cell per name, in the order given; a cell holds its pictures side by side.

    Args:
        pictures: name → pictures (h, w, 3) uint8 RGB of any sizes; they are scaled to the first one's height.
        path: of the PNG.
        columns: cells per row.

    Raises:
        ValueError: there is no picture.
    """
    if not any(len(views) for views in pictures.values()):
        raise ValueError("no picture to show")
    height = next(views[0].shape[0] for views in pictures.values() if len(views))
    cells = [_cell(name, views, height) for name, views in pictures.items() if len(views)]
    width = max(cell.shape[1] for cell in cells)
    cells = [_padded(cell, width) for cell in cells]
    cells += [np.full_like(cells[0], 255)] * (-len(cells) % columns)
    rows = [np.hstack(cells[i : i + columns]) for i in range(0, len(cells), columns)]
    ok, data = cv2.imencode(".png", np.vstack(rows)[..., ::-1])
    if not ok:
        raise ValueError(f"cannot encode a picture of {width} x {height} pixels per cell")
    return write_bytes(Path(path), data.tobytes())


def _cell(name: str, views: Sequence[np.ndarray], height: int) -> np.ndarray:
    scaled = [
        cv2.resize(v, (round(v.shape[1] * height / v.shape[0]), height), interpolation=cv2.INTER_AREA) for v in views
    ]
    row = np.hstack(scaled)
    label = np.full((LABEL, row.shape[1], 3), 255, dtype=np.uint8)
    cv2.putText(label, name, (4, LABEL - 5), cv2.FONT_HERSHEY_SIMPLEX, 0.42, (40, 40, 40), 1, cv2.LINE_AA)
    return np.vstack([label, row])


def _padded(cell: np.ndarray, width: int) -> np.ndarray:
    return np.pad(cell, ((0, 0), (0, width - cell.shape[1]), (0, 0)), constant_values=255)
