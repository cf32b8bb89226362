"""Registration by the table's grain, if the image model left it alone.

Correlation finds the shift for each of some scales, Gauss-Newton refines the best, and tiles confirm it: each by itself
must find the grain in its place. A fit is (4,) float64: scales along x and y, then shifts. It maps a pixel of the
picture to one of the empty table's, with pixel centres at whole numbers.

All gradients are those of the empty table (inverse compositional: S. Baker and I. Matthews, Lucas-Kanade 20 years on,
IJCV 2004). It has no objects, whose gradients would bias the fit.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np


@dataclass(frozen=True)
class GrainSettings:
    """Comparison of grain, in pictures of half the size.

    Args:
        factor: pixels of the picture per compared pixel.
        fine_px: smoother structures are light and shade, compared pixels.
        clip: multiple of the usual strength of the grain that counts in full; objects stand out more and must not.
        largest_shift_share: of the picture's sides.
        blurs_px: of the grain in each round of fitting, compared pixels.
        outlier: difference of the grain, whose largest value is 1, that counts in full in the fitting.
        tiles: along x and y.
        reach_px: a tile is searched as far from its place, compared pixels.
        tile_correlation, tile_drop: least correlation of a tile that is found, and by how much it is less at the
            reach from its place.
        least_tiles, least_tile_share: tiles that must be found within a pixel of their place, and their share of the
            visible tiles. Wrong fits had at most 3, a share of 0.12; right ones mostly twice as many as needed.
    """

    factor: int = 2
    fine_px: float = 5.0
    clip: float = 2.5
    largest_shift_share: float = 0.17
    blurs_px: tuple[float, ...] = (1.0, 1.0, 0.7, 0.7)
    outlier: float = 0.4
    tiles: tuple[int, int] = (6, 4)
    reach_px: int = 5
    tile_correlation: float = 0.25
    tile_drop: float = 0.005
    least_tiles: int = 6
    least_tile_share: float = 0.25


SETTINGS = GrainSettings()


def grain(lightness: np.ndarray) -> np.ndarray:
    """(h, w) float32 in [-1, 1], the fine structure of an (H, W) uint8 picture at half its size, of even strength."""
    size = [max(1, n // SETTINGS.factor) for n in lightness.shape[::-1]]
    small = cv2.resize(lightness, size, interpolation=cv2.INTER_AREA).astype(np.float32)
    fine = small - cv2.GaussianBlur(small, (0, 0), SETTINGS.fine_px)
    usual = float(np.median(np.abs(fine))) + 0.05  # at least the rounding of grey levels
    return np.clip(fine / (SETTINGS.clip * usual), -1, 1)


def grain_fit(
    picture: np.ndarray, empty: np.ndarray, scales: list[tuple[float, float]]
) -> tuple[np.ndarray, float] | None:
    """The fit of one picture's lightness (H, W) uint8 onto the empty table's, near one of the given scales.

    Returns:
        the fit, and the turn of the picture in pixels at its sides; None if too few tiles confirm the best fit.
    """
    theirs, ours = grain(picture), grain(empty)
    if min(ours.shape) < 8 * (SETTINGS.reach_px + 1) or not ours.any() or not theirs.any():
        return None
    _, best = max((_shifted(ours, theirs, scale) for scale in scales), key=lambda found: found[0])
    fit, turn = _refined(ours, theirs, best)
    found, seen = _found_tiles(ours, _moved(theirs, fit), fit)
    if found < max(SETTINGS.least_tiles, SETTINGS.least_tile_share * seen):
        return None
    # Pixel centres: x' + 0.5 = (x + 0.5) / factor.
    factor = SETTINGS.factor
    return np.array([*fit[:2], *(factor * fit[2:] + (factor - 1) / 2 * (1 - fit[:2]))]), factor * turn


def _moved(picture: np.ndarray, fit: np.ndarray) -> np.ndarray:
    warp = np.array([[fit[0], 0, fit[2]], [0, fit[1], fit[3]]])
    return cv2.warpAffine(picture, warp, picture.shape[::-1], flags=cv2.INTER_LINEAR)


def _shifted(ours: np.ndarray, theirs: np.ndarray, scale: tuple[float, float]) -> tuple[float, np.ndarray]:
    """The best correlation of a picture of this scale, and the fit that reaches it."""
    size = np.array(ours.shape[::-1])
    fit = np.array([*scale, *((1 - np.array(scale)) * (size - 1) / 2)])
    moved = _moved(theirs, fit)
    product = cv2.mulSpectrums(cv2.dft(ours), cv2.dft(moved), 0, conjB=True)
    width, height = (SETTINGS.largest_shift_share * size).astype(int)
    power = np.roll(cv2.idft(product, flags=cv2.DFT_SCALE), (height, width), axis=(0, 1))
    power = power[: 2 * height + 1, : 2 * width + 1]
    v, u = np.unravel_index(int(power.argmax()), power.shape)
    return float(power[v, u] / max(float(np.linalg.norm(moved)), 1e-6)), fit + [0, 0, u - width, v - height]


def _refined(ours: np.ndarray, theirs: np.ndarray, fit: np.ndarray) -> tuple[np.ndarray, float]:
    """Least squares of the difference: shifts and one growth, as no editor stretches; and the remaining turn."""
    height, width = ours.shape
    middle = np.array([(width - 1) / 2, (height - 1) / 2])
    x, y = np.arange(width, dtype=np.float32) - middle[0], np.arange(height, dtype=np.float32) - middle[1]
    step = np.zeros(4)
    for blur in SETTINGS.blurs_px:
        a, moved = cv2.GaussianBlur(ours, (0, 0), blur), _moved(cv2.GaussianBlur(theirs, (0, 0), blur), fit)
        gain = float((a * moved).sum() / max(float((a * a).sum()), 1e-6))
        left = np.clip(a - moved / max(gain, 0.02), -SETTINGS.outlier, SETTINGS.outlier)
        dx, dy = (cv2.Scharr(a, cv2.CV_32F, *order) / 32 for order in ((1, 0), (0, 1)))
        x_side, y_side = x / middle[0], y[:, None] / middle[0]
        slopes = np.stack([k.ravel() for k in (dx, dy, dx * x_side + dy * y_side, dy * x_side - dx * y_side)])
        step = np.linalg.solve(slopes @ slopes.T + 1e-6 * np.eye(4), slopes @ left.ravel())
        step = np.clip(step, -SETTINGS.reach_px, SETTINGS.reach_px)
        growth = 1 / (1 + step[2] / middle[0])
        fit = np.array([*(fit[:2] * growth), *(middle + growth * (fit[2:] - middle - step[:2]))])
    return fit, float(step[3])


def _found_tiles(ours: np.ndarray, moved: np.ndarray, fit: np.ndarray) -> tuple[int, int]:
    """Number of tiles of the empty table found in their places, and of those in the picture."""
    height, width = ours.shape
    reach, (across, down) = SETTINGS.reach_px, SETTINGS.tiles
    wide, high = (width - 2 * reach) // across, (height - 2 * reach) // down
    found, seen = 0, 0
    low, far = fit[2:], fit[2:] + fit[:2] * [width - 1, height - 1]
    for u in range(reach, reach + across * wide, wide):
        for v in range(reach, reach + down * high, high):
            middle = np.array([u + wide / 2, v + high / 2])
            if (middle < low).any() or (middle > far).any():
                continue
            window = moved[v - reach : v + high + reach, u - reach : u + wide + reach]
            likeness = cv2.matchTemplate(window, ours[v : v + high, u : u + wide], cv2.TM_CCOEFF_NORMED)
            seen += 1
            found += _is_peak(likeness)
    return found, seen


def _is_peak(likeness: np.ndarray) -> bool:
    """True if a tile is found in the middle and less well at the rim, unlike a mere line."""
    middle = slice(SETTINGS.reach_px - 1, SETTINGS.reach_px + 2)
    place = float(likeness[middle, middle].max())
    rim = max(float(side.max()) for side in (likeness[0], likeness[-1], likeness[:, 0], likeness[:, -1]))
    found = SETTINGS.tile_correlation <= place <= 1.001 and place >= float(likeness.max())
    return found and place >= rim + SETTINGS.tile_drop
