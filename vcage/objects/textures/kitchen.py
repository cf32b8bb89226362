"""What kitchen things are coated and labelled with: enamel, non-stick, turned wood, jar labels."""

from __future__ import annotations

import cv2
import numpy as np

from vcage.objects.textures import materials, prints
from vcage.objects.textures.noise import Colour, blend, clouds, noise, over, shaded


def enamel(rng: np.random.Generator, colour: Colour, chips: bool = True, size: int = 256) -> np.ndarray:
    """Glossy enamel with fine pale speckles."""
    picture = materials.plastic(rng, colour, size)
    if chips:
        spots = noise(rng, (size, size), (size // 3, size // 3)) > 0.985
        picture = over(picture, (236, 232, 224), cv2.blur(spots.astype(np.float32), (2, 2)) * 0.8)
    return picture


def nonstick(rng: np.random.Generator, colour: Colour = (58, 58, 60), size: int = 384) -> np.ndarray:
    """A coated pan seen from above: fine rings of the turning tool, lighter towards the middle of the floor."""
    away = _away(size)
    rings = 0.95 + 0.1 * (0.5 + 0.5 * np.sin(away * 260))
    picture = shaded(np.full((size, size, 3), colour, dtype=np.uint8), rings * (1.12 - 0.2 * away))
    flecks = noise(rng, (size, size), (size // 3, size // 3)) > 0.97
    return over(picture, (150, 150, 150), flecks * 0.25)


def steel(rng: np.random.Generator, size: int = 256) -> np.ndarray:
    """Satin steel: scratches along the rows that are too fine to look like grain."""
    fine = noise(rng, (size, size), (size, 12))
    return shaded(np.full((size, size, 3), (206, 208, 211), dtype=np.uint8), 0.95 + 0.07 * fine)


def steel_bowl(rng: np.random.Generator, size: int = 384) -> np.ndarray:
    """The inside of a steel pot seen from above: brushed in circles."""
    away = _away(size)
    scratch = rng.random(size).astype(np.float32)
    tone = 0.84 + 0.16 * np.interp(away, np.linspace(0, 1.5, size), scratch)
    return shaded(np.full((size, size, 3), (198, 200, 203), dtype=np.uint8), tone)


def marble(rng: np.random.Generator, size: int = 256) -> np.ndarray:
    """White marble with grey veins."""
    shape = (size, size)
    veins = 1 - np.abs(clouds(rng, shape, (2, 3), 5) - 0.5) * 34
    picture = blend((242, 241, 238), (222, 222, 222), clouds(rng, shape, (3, 3)))
    return over(picture, (140, 142, 148), np.clip(veins, 0, 1) * 0.7)


def gingham(rng: np.random.Generator, colour: Colour, checks: int = 10, size: int = 256) -> np.ndarray:
    """Checked cotton: white, light and full squares."""
    stripe = (np.arange(size) * checks // size) % 2
    cover = (stripe[:, None] + stripe[None]) / 2
    cloth = over(np.full((size, size, 3), 248, dtype=np.uint8), colour, cover * 0.92)
    return shaded(cloth, 0.9 + 0.14 * noise(rng, (size, size), (size // 3, size // 3)))


def syrup(rng: np.random.Generator, colour: Colour, lumps: Colour | None = None, size: int = 256) -> np.ndarray:
    """Jam or honey behind glass: lighter where light comes through, with pieces of fruit if ``lumps`` is given."""
    shape = (size, size)
    picture = shaded(np.full((*shape, 3), colour, dtype=np.uint8), 0.75 + 0.5 * clouds(rng, shape, (3, 6)))
    if lumps is not None:
        picture = over(picture, lumps, np.clip((noise(rng, shape, (14, 20)) - 0.66) * 5, 0, 0.75))
    return picture


def jar_label(words: tuple[str, str], ground: Colour, ink: Colour, motif: np.ndarray | None = None) -> np.ndarray:
    """A wrap-around label (192, 768): two lines and a picture, in front and at the back.

    Args:
        words: large line and small line.
        motif: (n, n, 3) picture on its own, whose pure black is left out.
    """
    label = prints.canvas(768, 192, ground)
    for low, high in ((0.05, 0.08), (0.92, 0.95)):
        label = prints.rectangle(label, (0, low), (1, high), ink)
    for x in (0.25, 0.75):
        label = prints.text(label, words[0], (x, 0.72 if motif is not None else 0.42), 0.15, ink)
        label = prints.text(label, words[1], (x, 0.87 if motif is not None else 0.7), 0.1, ink)
        if motif is not None:
            label = stamped(label, motif, (x, 0.36), 0.5)
    return np.roll(label, 192, axis=1)  # one print in front, one at the back


def stamped(picture: np.ndarray, motif: np.ndarray, centre: tuple[float, float], height: float) -> np.ndarray:
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


def strawberry(size: int = 128) -> np.ndarray:
    """A strawberry as a motif on black."""
    picture = np.zeros((size, size, 3), dtype=np.uint8)
    outline = [
        (0.5, 0.96),
        (0.24, 0.66),
        (0.14, 0.4),
        (0.28, 0.26),
        (0.5, 0.3),
        (0.72, 0.26),
        (0.86, 0.4),
        (0.76, 0.66),
    ]
    cv2.fillPoly(picture, [_pixels(outline, size)], (206, 28, 40), cv2.LINE_8)
    for x, y in ((0.34, 0.44), (0.5, 0.5), (0.66, 0.44), (0.42, 0.62), (0.58, 0.62), (0.5, 0.78)):
        cv2.circle(picture, (round(x * size), round(y * size)), size // 36, (250, 220, 120), -1)
    leaf = [(0.5, 0.4), (0.22, 0.34), (0.4, 0.24), (0.34, 0.08), (0.5, 0.2), (0.66, 0.08), (0.6, 0.24), (0.78, 0.34)]
    cv2.fillPoly(picture, [_pixels(leaf, size)], (70, 140, 60), cv2.LINE_8)
    return picture


def round_fruit(colour: Colour, size: int = 128) -> np.ndarray:
    """Three round fruits with a leaf as a motif on black: apricots or berries."""
    picture = np.zeros((size, size, 3), dtype=np.uint8)
    leaf = [(0.5, 0.32), (0.6, 0.1), (0.86, 0.06), (0.76, 0.26)]
    cv2.fillPoly(picture, [_pixels(leaf, size)], (80, 140, 70), cv2.LINE_8)
    for i, (x, y) in enumerate(((0.34, 0.42), (0.66, 0.44), (0.5, 0.7))):
        shade = tuple(int(max(1, c * (0.86 + 0.07 * i))) for c in colour)
        cv2.circle(picture, (round(x * size), round(y * size)), round(0.22 * size), shade, -1)
        cv2.circle(picture, (round((x - 0.07) * size), round((y - 0.08) * size)), size // 22, (250, 240, 226), -1)
    return picture


def bee(size: int = 128) -> np.ndarray:
    """A bee as a motif on black."""
    picture = np.zeros((size, size, 3), dtype=np.uint8)
    for x, turn in ((0.36, -30), (0.64, 30)):
        cv2.ellipse(
            picture, (round(x * size), round(0.34 * size)), (size // 9, size // 4), turn, 0, 360, (226, 236, 240), -1
        )
    cv2.ellipse(picture, (size // 2, round(0.56 * size)), (size // 3, size // 5), 0, 0, 360, (246, 190, 40), -1)
    body = (picture == (246, 190, 40)).all(axis=2)
    columns = np.arange(size)[None] / size
    stripes = (((columns > 0.36) & (columns < 0.44)) | ((columns > 0.54) & (columns < 0.62)) | (columns > 0.74)) & body
    picture[stripes] = (46, 34, 24)
    return picture


def _away(size: int) -> np.ndarray:
    """(size, size) distance from the middle; 1 at the middle of each edge."""
    axis = np.linspace(-1, 1, size)
    return np.hypot(*np.meshgrid(axis, axis))


def _pixels(points: list[tuple[float, float]], size: int) -> np.ndarray:
    return np.round(np.array(points) * size).astype(np.int32)
