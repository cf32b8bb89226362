"""Lays a picture over the empty table by the table's grain, where an image model left that alone.

Correlation finds the shift for each of some scales, Gauss-Newton makes the best exact, and tiles confirm it: each for
itself must find the grain just there. A fit is (4,) float64: scales along x and y, then shifts; it maps a pixel of the
picture to one of the empty table's, with pixel centres at whole numbers.

Gradients are those of the empty table throughout (S. Baker and I. Matthews, Lucas-Kanade 20 years on, IJCV 2004: the
inverse compositional way): it has no objects, whose own gradients would pull the fit to where they vanish.
"""

from __future__ import annotations

import cv2
import numpy as np

HALF = 2
"""Pixels of the picture per pixel that is compared."""

FINE = 5.0
"""What is smoother than this many compared pixels is light and shade, not grain."""

CLIP = 2.5
"""Times the usual strength of the grain that counts in full: objects stand out more, and must not."""

ROOM = 0.17
"""Shifts that are looked for, as a share of the picture's sides."""

BLURS = (1.0, 1.0, 0.7, 0.7)
"""Compared pixels by which the grain is blurred in each round of fitting."""

OUTLIER = 0.4
"""Difference of the grain, whose largest value is 1, that counts in full in the fitting."""

TILES = (6, 4)
"""Along x and y."""

REACH = 5
"""Compared pixels around its place in which a tile is looked for."""

ALIKE, FALL = 0.25, 0.005
"""Correlation of a tile that is found, and by how much it is less at :data:`REACH` from its place."""

CONFIRMED, SHARE = 6, 0.25
"""Tiles that must be found within a pixel of their place, and share of those that the picture shows. At wrong fits at
most 3 were, a share of 0.12; at right ones mostly twice as many as must."""


def grain(lightness: np.ndarray) -> np.ndarray:
    """(h, w) float32 in [-1, 1] of an (H, W) uint8 picture, at half its size: what is fine, made equally strong."""
    size = [max(1, n // HALF) for n in lightness.shape[::-1]]
    small = cv2.resize(lightness, size, interpolation=cv2.INTER_AREA).astype(np.float32)
    fine = small - cv2.GaussianBlur(small, (0, 0), FINE)
    # At least the rounding of grey levels.
    usual = float(np.median(np.abs(fine))) + 0.05
    return np.clip(fine / (CLIP * usual), -1, 1)


def grain_fit(
    picture: np.ndarray, empty: np.ndarray, scales: list[tuple[float, float]]
) -> tuple[np.ndarray, float] | None:
    """The fit of one picture's lightness (H, W) uint8 onto the empty table's, with about one of these scales.

    Returns:
        the fit, and by how many pixels the picture is turned at its sides; None when too few tiles confirm the best.
    """
    theirs, ours = grain(picture), grain(empty)
    if min(ours.shape) < 8 * (REACH + 1) or not ours.any() or not theirs.any():
        return None
    _, best = max((_shifted(ours, theirs, scale) for scale in scales), key=lambda found: found[0])
    fit, turn = _refined(ours, theirs, best)
    found, seen = _found_tiles(ours, _moved(theirs, fit), fit)
    if found < max(CONFIRMED, SHARE * seen):
        return None
    # Pixel centres: x' + 0.5 = (x + 0.5) / HALF.
    return np.array([*fit[:2], *(HALF * fit[2:] + (HALF - 1) / 2 * (1 - fit[:2]))]), HALF * turn


def _moved(picture: np.ndarray, fit: np.ndarray) -> np.ndarray:
    warp = np.array([[fit[0], 0, fit[2]], [0, fit[1], fit[3]]])
    return cv2.warpAffine(picture, warp, picture.shape[::-1], flags=cv2.INTER_LINEAR)


def _shifted(ours: np.ndarray, theirs: np.ndarray, scale: tuple[float, float]) -> tuple[float, np.ndarray]:
    """The best correlation of a picture of this scale, and the fit with the shift that has it."""
    size = np.array(ours.shape[::-1])
    fit = np.array([*scale, *((1 - np.array(scale)) * (size - 1) / 2)])
    moved = _moved(theirs, fit)
    product = cv2.mulSpectrums(cv2.dft(ours), cv2.dft(moved), 0, conjB=True)
    width, height = (ROOM * size).astype(int)
    power = np.roll(cv2.idft(product, flags=cv2.DFT_SCALE), (height, width), axis=(0, 1))
    power = power[: 2 * height + 1, : 2 * width + 1]
    v, u = np.unravel_index(int(power.argmax()), power.shape)
    return float(power[v, u] / max(float(np.linalg.norm(moved)), 1e-6)), fit + [0, 0, u - width, v - height]


def _refined(ours: np.ndarray, theirs: np.ndarray, fit: np.ndarray) -> tuple[np.ndarray, float]:
    """Least squares of the difference: shifts and one growth, as no editor stretches; and the turn that is left."""
    height, width = ours.shape
    middle = np.array([(width - 1) / 2, (height - 1) / 2])
    x, y = np.arange(width, dtype=np.float32) - middle[0], np.arange(height, dtype=np.float32) - middle[1]
    step = np.zeros(4)
    for blur in BLURS:
        a, moved = cv2.GaussianBlur(ours, (0, 0), blur), _moved(cv2.GaussianBlur(theirs, (0, 0), blur), fit)
        gain = float((a * moved).sum() / max(float((a * a).sum()), 1e-6))
        left = np.clip(a - moved / max(gain, 0.02), -OUTLIER, OUTLIER)
        dx, dy = (cv2.Scharr(a, cv2.CV_32F, *order) / 32 for order in ((1, 0), (0, 1)))
        x_side, y_side = x / middle[0], y[:, None] / middle[0]
        slopes = np.stack([k.ravel() for k in (dx, dy, dx * x_side + dy * y_side, dy * x_side - dx * y_side)])
        step = np.linalg.solve(slopes @ slopes.T + 1e-6 * np.eye(4), slopes @ left.ravel())
        step = np.clip(step, -REACH, REACH)
        growth = 1 / (1 + step[2] / middle[0])
        fit = np.array([*(fit[:2] * growth), *(middle + growth * (fit[2:] - middle - step[:2]))])
    return fit, float(step[3])


def _found_tiles(ours: np.ndarray, moved: np.ndarray, fit: np.ndarray) -> tuple[int, int]:
    """How many tiles of the empty table are found where they should be, and how many the picture shows."""
    height, width = ours.shape
    wide, high = (width - 2 * REACH) // TILES[0], (height - 2 * REACH) // TILES[1]
    found, seen = 0, 0
    low, far = fit[2:], fit[2:] + fit[:2] * [width - 1, height - 1]
    for u in range(REACH, REACH + TILES[0] * wide, wide):
        for v in range(REACH, REACH + TILES[1] * high, high):
            middle = np.array([u + wide / 2, v + high / 2])
            if (middle < low).any() or (middle > far).any():
                continue
            window = moved[v - REACH : v + high + REACH, u - REACH : u + wide + REACH]
            likeness = cv2.matchTemplate(window, ours[v : v + high, u : u + wide], cv2.TM_CCOEFF_NORMED)
            seen += 1
            found += _is_peak(likeness)
    return found, seen


def _is_peak(likeness: np.ndarray) -> bool:
    """Whether a tile is found in the middle, and not as well at the rim: along a mere line it is."""
    place = float(likeness[REACH - 1 : REACH + 2, REACH - 1 : REACH + 2].max())
    rim = max(float(side.max()) for side in (likeness[0], likeness[-1], likeness[:, 0], likeness[:, -1]))
    return ALIKE <= place <= 1.001 and place >= float(likeness.max()) and place >= rim + FALL
