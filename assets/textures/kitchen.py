"""What kitchen things are coated and labelled with: glazes, enamel, steel, syrup behind glass, motifs."""

from __future__ import annotations

import cv2
import numpy as np

from vcage.objects.modelling import materials
from vcage.objects.modelling.noise import Colour, clouds, noise, over, shaded

GLAZES = {"white": (240, 238, 232), "blue": (62, 104, 160), "red": (178, 48, 44), "green": (112, 150, 116)}


def enamel(rng: np.random.Generator, colour: Colour, chips: bool = True, size: int = 256) -> np.ndarray:
    """Glossy enamel with fine pale speckles."""
    picture = materials.plastic(rng, colour, size)
    if chips:
        spots = noise(rng, (size, size), (size // 3, size // 3)) > 0.985
        picture = over(picture, (236, 232, 224), cv2.blur(spots.astype(np.float32), (2, 2)) * 0.8)
    return picture


def steel(rng: np.random.Generator, size: int = 256) -> np.ndarray:
    """Satin steel: scratches along the rows that are too fine to look like grain."""
    fine = noise(rng, (size, size), (size, 12))
    return shaded(np.full((size, size, 3), (206, 208, 211), dtype=np.uint8), 0.95 + 0.07 * fine)


def syrup(rng: np.random.Generator, colour: Colour, lumps: Colour | None = None, size: int = 256) -> np.ndarray:
    """Jam or honey behind glass: lighter where light comes through, with pieces of fruit if ``lumps`` is given."""
    shape = (size, size)
    picture = shaded(np.full((*shape, 3), colour, dtype=np.uint8), 0.75 + 0.5 * clouds(rng, shape, (3, 6)))
    if lumps is not None:
        picture = over(picture, lumps, np.clip((noise(rng, shape, (14, 20)) - 0.66) * 5, 0, 0.75))
    return picture


def with_motif(picture: np.ndarray, motif: np.ndarray, centre: tuple[float, float], height: float) -> np.ndarray:
    """The picture with a motif whose pure black is transparent; ``height`` is a share of the picture's."""
    rows, columns = picture.shape[:2]
    size = round(height * rows)
    small = cv2.resize(motif, (size, size), interpolation=cv2.INTER_AREA)
    cover = cv2.resize((motif.sum(axis=2) > 0).astype(np.float32), (size, size), interpolation=cv2.INTER_AREA)
    r, c = round(centre[1] * rows - size / 2), round(centre[0] * columns - size / 2)
    out = picture.copy()
    part = out[r : r + size, c : c + size]
    full = small / np.maximum(cover, 1e-3)[..., None]  # undo the mixing with the black around
    out[r : r + size, c : c + size] = (part * (1 - cover[..., None]) + np.clip(full, 0, 255) * cover[..., None]).round()
    return out


def from_centre(size: int) -> np.ndarray:
    """(size, size) distance from the middle; 1 at the middle of each edge."""
    axis = np.linspace(-1, 1, size)
    return np.hypot(*np.meshgrid(axis, axis))
