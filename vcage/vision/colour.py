"""Colours in CIELAB: distances, palettes, pictures that are sampled at any scale, and colour transfer between them.

An image model changes the colours of a picture. The objects show how, as they stay the same; the table does not, as it
may be repainted. The transfer first uses the objects' colours together, then their pixels once some are found.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np

LIGHTNESS_WEIGHT = 0.5
"""Weight of lightness in :func:`distance`: shade changes lightness alone."""


@dataclass(frozen=True)
class TransferSettings:
    """Limits of a colour transfer.

    Args:
        least_gain, largest_gain: of a colour channel.
        object_salience: least salience of a pixel that belongs to an object.
        least_pixels: with fewer, colours are left alone.
        prior_share: weight of "the colours are right already" in the fit, as a share of the pixels' weight.
        rounds: of reweighted least squares.
    """

    least_gain: float = 0.7
    largest_gain: float = 1.5
    object_salience: float = 0.6
    least_pixels: int = 60
    prior_share: float = 0.05
    rounds: int = 5


TRANSFER = TransferSettings()


@dataclass(frozen=True)
class LabImage:
    """A picture in the colours and with the mask that are compared.

    Args:
        lab: (H, W, 3) float32 CIELAB.
        salience: (H, W) float32 in [0, 1]: 0 is table, 1 surely an object.
    """

    lab: np.ndarray
    salience: np.ndarray
    _levels: dict[float, np.ndarray] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, picture: np.ndarray, salience: np.ndarray) -> LabImage:
        """From an (H, W, 3) uint8 picture."""
        return cls(to_lab(picture), salience)

    def level(self, step: float) -> np.ndarray:
        """(h, w, 4) Lab and salience, ``step`` times smaller."""
        if step not in self._levels:
            if step == 1:
                self._levels[step] = np.dstack([self.lab, self.salience])
            else:
                height, width = self.salience.shape
                size = (max(1, round(width / step)), max(1, round(height / step)))
                self._levels[step] = cv2.resize(self.level(1), size, interpolation=cv2.INTER_AREA)
        return self._levels[step]

    def sample(self, pixels: np.ndarray, step: float) -> np.ndarray:
        """(..., 4) Lab and salience at pixels (..., 2) of the full picture, taken ``step`` times smaller."""
        flat = np.asarray(pixels, np.float32).reshape(len(pixels), -1, 2)
        level = self.level(step)
        u = flat[..., 0] * np.float32(level.shape[1] / self.lab.shape[1]) - np.float32(0.5)
        v = flat[..., 1] * np.float32(level.shape[0] / self.lab.shape[0]) - np.float32(0.5)
        taken = cv2.remap(level, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return taken.reshape(*np.shape(pixels)[:-1], 4)

    def scaled(self, gain: np.ndarray, offset: np.ndarray) -> LabImage:
        """With each channel times its gain (3,) plus its offset (3,)."""
        return LabImage(self.lab * gain.astype(np.float32) + offset.astype(np.float32), self.salience)

    def rgb(self) -> np.ndarray:
        """(H, W, 3) uint8 picture."""
        return np.clip(cv2.cvtColor(self.lab, cv2.COLOR_LAB2RGB) * 255 + 0.5, 0, 255).astype(np.uint8)


def to_lab(picture: np.ndarray) -> np.ndarray:
    """(H, W, 3) float32 CIELAB (L in [0, 100]) of an RGB uint8 picture."""
    return cv2.cvtColor(picture.astype(np.float32) / 255, cv2.COLOR_RGB2LAB)


def smoothed(picture: np.ndarray) -> np.ndarray:
    """(H, W, 3) float32 CIELAB of an RGB uint8 picture without pixel noise, to compare two views."""
    return to_lab(cv2.GaussianBlur(picture, (3, 3), 0))


def distance(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(...) colour distance of Lab arrays (..., 3), lightness counting less."""
    # Channel by channel: sums along an axis of three take numpy six times as long.
    lightness, green_red, blue_yellow = np.moveaxis(a - b, -1, 0)
    lightness = lightness * np.float32(LIGHTNESS_WEIGHT)
    return np.sqrt(lightness * lightness + green_red * green_red + blue_yellow * blue_yellow)


def palette(colours: np.ndarray, count: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """The main colours of (n, 3) Lab pixels: centres (k, 3) and shares (k,), the most frequent first.

    k-means from evenly spaced pixels of the lightness order, so the same pixels give the same palette.
    """
    samples = np.ascontiguousarray(colours.reshape(-1, 3), dtype=np.float32)
    count = min(count, len(samples))
    order = np.argsort(samples[:, 0], kind="stable")
    seeds = order[np.linspace(0, len(order) - 1, 2 * count + 1).astype(int)[1::2]]
    labels = np.argmin(((samples[:, None] - samples[seeds][None]) ** 2).sum(-1), axis=1).astype(np.int32)
    criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 20, 0.5)
    _, labels, centres = cv2.kmeans(samples, count, labels[:, None].copy(), criteria, 1, cv2.KMEANS_USE_INITIAL_LABELS)
    shares = np.bincount(labels.ravel(), minlength=count) / len(samples)
    ranked = np.argsort(-shares, kind="stable")
    return centres[ranked], shares[ranked]


def palette_distance(lab: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """(...) distance of each pixel (..., 3) to the nearest palette colour."""
    return np.min([distance(lab, centre) for centre in centres.astype(np.float32)], axis=0)


def transfer_statistics(image: LabImage, source: LabImage, masks: np.ndarray) -> LabImage:
    """The picture with mean and deviation of its salient colours set to those of the objects of the source.

    E. Reinhard et al., Color Transfer between Images, IEEE CG&A 2001.

    Args:
        image: the picture whose colours change.
        source: the picture with the right colours.
        masks: (H, W) bool, the objects in the source.
    """
    known = source.lab[masks]
    standing = cv2.erode((image.salience > TRANSFER.object_salience).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    found = image.lab[standing]
    if min(len(known), len(found)) < TRANSFER.least_pixels:
        return image
    gain = known.std(axis=0) / np.maximum(found.std(axis=0), 1e-3)
    gain = np.clip(gain, TRANSFER.least_gain, TRANSFER.largest_gain)
    return image.scaled(gain, known.mean(axis=0) - gain * found.mean(axis=0))


def transfer_pixelwise(image: LabImage, known: np.ndarray, found: np.ndarray) -> LabImage:
    """The picture with gain and offset of each channel fitted to pairs of pixels, (n, 3) Lab.

    Ridge regression by iteratively reweighted least squares (Cauchy weights): outliers (highlights, shadows, wrong
    matches) lose their weight.

    Args:
        image: the picture whose colours change.
        known: right colours of the pixels.
        found: their colours in the picture.
    """
    if len(known) < TRANSFER.least_pixels:
        return image
    gain, offset = np.ones(3), np.zeros(3)
    for channel in range(3):
        x, y = found[:, channel].astype(np.float64), known[:, channel].astype(np.float64)
        middle = float(np.median(x))
        design = np.stack([x - middle, np.ones_like(x)], axis=1)
        prior = np.diag([TRANSFER.prior_share * 100.0, TRANSFER.prior_share]) * len(x)
        answer = np.array([1.0, middle])
        for _ in range(TRANSFER.rounds):
            left = y - design @ answer
            weight = 1 / (1 + (left / max(1.4826 * float(np.median(np.abs(left))), 1.0)) ** 2)
            matrix = (design * weight[:, None]).T @ design + prior
            answer = np.linalg.solve(matrix, (design * weight[:, None]).T @ y + prior @ [1.0, middle])
        gain[channel] = np.clip(answer[0], TRANSFER.least_gain, TRANSFER.largest_gain)
        offset[channel] = answer[1] - gain[channel] * middle
    return image.scaled(gain, offset)
