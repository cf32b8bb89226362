"""ColorVideoVDP of still pictures in NumPy and OpenCV.

The package cvvdp holds the display models, the parameters and the tables of contrast sensitivity that are read here. It
computes with PyTorch, for videos as well: on one core three times as long for a pair of pictures, after an import of
more than a second. The losses are the same but for roundings of the fifth decimal, see ``tests/video/test_jod.py``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from vcage.video.bands import Band, Planes, across, along, bands

XYZ_TO_LMS = (
    (0.187596268556126, 0.585168649077728, -0.026384263306304),
    (-0.133397430663221, 0.405505777260049, 0.034502127690364),
    (0.000244379021663, -0.000542995890619, 0.019406849066323),
)
"""CIE 2006 cone responses."""

LMS_TO_DKL = ((1.0, 1.0, 0.0), (1.0, -2.311130179947035, 0.0), (-1.0, -1.0, 50.977571328718781))
"""Opponent colours about the white D65."""

TINY = 1e-5
"""Added before a power, and its power taken off after it, as in the package."""


@dataclass(frozen=True)
class Display:
    """Light of a display, and how large its pixels are seen.

    Args:
        light: (256,) light of a channel's values, cd/m².
        to_dkl: (3, 3) from this light to opponent colours.
        pixels_per_degree: in the middle of the display.
    """

    light: NDArray[np.float32]
    to_dkl: NDArray[np.float64]
    pixels_per_degree: float

    @classmethod
    def of(cls, model: Mapping[str, Any], colour_space: Mapping[str, Any]) -> Display:
        """Return the display of one of the package's models that takes sRGB.

        Args:
            model: see the package's ``display_models.json``.
            colour_space: sRGB in its ``color_spaces.json``.
        """
        peak = model["max_luminance"]
        black = model["min_luminance"] if "min_luminance" in model else peak / model.get("contrast", 500)
        reflected = model.get("E_ambient", 0) / math.pi * model.get("k_refl", 0.005)
        values = np.arange(256) / 255
        linear = np.where(values > 0.04045, ((values + 0.055) / 1.055) ** 2.4, values / 12.92)
        light = (peak - black) * np.clip(model.get("exposure", 1) * linear, 0, 1) + black + reflected
        to_xyz = np.array([colour_space[row] for row in ("RGB2X", "RGB2Y", "RGB2Z")])
        to_dkl = np.linalg.multi_dot([LMS_TO_DKL, XYZ_TO_LMS, to_xyz])
        return cls(light.astype(np.float32), to_dkl, _pixels_per_degree(model))

    def shown(self, picture: NDArray[np.uint8]) -> Planes:
        """Return a (H, W, 3) uint8 sRGB picture in opponent colours."""
        return np.stack(cv2.split(cv2.transform(cv2.LUT(picture, self.light), self.to_dkl)), axis=1)


def _pixels_per_degree(model: Mapping[str, Any], metres_per_inch: float = 0.0254) -> float:
    if "pixels_per_degree" in model:
        return float(model["pixels_per_degree"])
    width, height = model["resolution"]
    if "fov_diagonal" in model:
        away = math.hypot(width, height) / 2 / math.tan(math.radians(model["fov_diagonal"] / 2))  # in pixels
    else:
        metres = model.get("diagonal_size_meters", model.get("diagonal_size_inches", 0) * metres_per_inch)
        distance = model.get("viewing_distance_meters", model.get("viewing_distance_inches", 0) * metres_per_inch)
        away = distance * math.hypot(width, height) / metres
    return 1 / (2 * math.degrees(math.atan(0.5 / away)))


@dataclass(frozen=True)
class StillMetric:
    """ColorVideoVDP for pairs of pictures on one display.

    Args:
        display: that shows them.
        parameters: the package's ``cvvdp_parameters.json``, of the masking model "mult-mutual".
        sensitivity: the package's table that these name, of log10 sensitivity by light and frequency.
    """

    display: Display
    parameters: Mapping[str, Any]
    sensitivity: Mapping[str, Any]

    def loss(self, test: NDArray[np.uint8], reference: NDArray[np.uint8]) -> float:
        """Return the loss of a (H, W, 3) uint8 sRGB picture against a reference, JOD."""
        pair = np.concatenate([self.display.shown(test), self.display.shown(reference)], axis=1)
        seen = np.array([self._difference(band) for band in bands(pair, self.display.pixels_per_degree)])
        chroma = self.parameters["ch_chrom_w"]
        seen *= np.array([1.0, chroma, chroma])
        seen[-1] *= self.parameters["baseband_weight"][:3]
        over_bands = _norm(seen, self.parameters["beta_sch"])
        together = float(_norm(over_bands, self.parameters["beta_tch"])) * self.parameters["image_int"]
        return self._objectionable(max(0.0, together))  # roundings of equal pictures may be below

    def _objectionable(self, difference: float, straight_below: float = 0.1) -> float:
        """Return JOD of a difference: a power of it, and a straight line near zero."""
        scale, exponent = self.parameters["jod_a"], self.parameters["jod_exp"]
        if difference <= straight_below:
            return scale * straight_below ** (exponent - 1) * difference
        return scale * difference**exponent

    def _difference(self, band: Band) -> NDArray[np.float64]:
        """Return (3,) how much of a band's difference is seen in each channel."""
        seen = self._sensitivity(band)
        test, reference = (
            np.multiply(band.test, seen, out=band.test),
            np.multiply(band.reference, seen, out=band.reference),
        )
        difference = np.abs(test - reference) if band.base else self._masked(test, reference)
        exponent = self.parameters["beta"]
        return _root(_power(difference, exponent).mean(axis=2, dtype=np.float64).mean(axis=0), exponent)

    def _sensitivity(self, band: Band) -> Planes:
        """Return (H, 3, W) the sensitivity to contrast at the reference's light, with the gain of masking."""
        table = self._sensitivities(band.cycles_per_degree, band.base)
        (first, *_, last), steps = self._log_light, table.shape[1] - 1
        place = cv2.log(band.background)
        place *= steps / (math.log(10) * (last - first))
        place += 0.5 - steps * first / (last - first)
        nearest = np.clip(place, 0, steps, out=place).astype(np.intp)
        return np.stack([sensitivities.take(nearest) for sensitivities in table], axis=1)

    def _sensitivities(self, cycles_per_degree: float, base: bool, steps: int = 2**14) -> NDArray[np.float32]:
        """Return (3, steps + 1) sensitivities at a frequency, evenly spaced in the logarithm of light."""
        key = cycles_per_degree, base
        if key not in self._known:
            light, place = self._log_light, math.log10(cycles_per_degree)
            logs = [_interpolated(table, self._log_frequencies, place) for table in self._tables]
            logs = [np.interp(np.linspace(light[0], light[-1], steps + 1), light, one) for one in logs]
            gains = np.ones((3, 1)) if base else np.array([[1.0], [1.45], [1.0]])
            found = gains * 10 ** (np.array(logs) + self.parameters["sensitivity_correction"] / 20)
            self._known[key] = found.astype(np.float32)
        return self._known[key]

    @cached_property
    def _known(self) -> dict[tuple[float, bool], NDArray[np.float32]]:
        return {}

    @cached_property
    def _log_light(self) -> NDArray[np.float64]:
        return np.log10(self.sensitivity["L_bkg"])

    @cached_property
    def _log_frequencies(self) -> NDArray[np.float64]:
        return np.log10(self.sensitivity["rho"])

    @cached_property
    def _tables(self) -> list[NDArray[np.float64]]:
        return [np.array(self.sensitivity[f"o0_c{channel}"]) for channel in (1, 2, 3)]

    def _masked(self, test: Planes, reference: Planes) -> Planes:
        """Return (H, 3, W) differences that are left where both pictures have contrast of their own."""
        difference = _power(np.abs(test - reference), self.parameters["mask_p"])
        common = np.minimum(np.abs(test, out=test), np.abs(reference, out=reference), out=test)
        common = _blurred(common, self.parameters["pu_dilate"])
        common *= np.float32(10 ** self.parameters["mask_c"])
        for channel, exponent in enumerate(self.parameters["mask_q"][:3]):
            common[:, channel] = _power(common[:, channel].copy(), exponent)
        weights = 2 ** np.reshape(self.parameters["xcm_weights"], (4, 4))[:3, :3].astype(np.float32)
        masking = weights.T @ common
        masking += 1
        difference /= masking
        most = np.float32(10 ** self.parameters["d_max"])
        return np.divide(most * difference, most + difference, out=difference)


def _interpolated(table: NDArray[np.float64], places: NDArray[np.float64], place: float) -> NDArray[np.float64]:
    """Return (N,) values between the columns of an (N, P) table at P places; beyond its ends, the lines go on."""
    before = int(np.clip(np.searchsorted(places, place) - 1, 0, len(places) - 2))
    part = (place - places[before]) / (places[before + 1] - places[before])
    return table[:, before] + part * (table[:, before + 1] - table[:, before])


def _power(values: Planes, exponent: float) -> Planes:
    """Return powers of values of at least 0, which change."""
    values += np.float32(TINY)
    rows = values.reshape(-1, values.shape[-1])  # as OpenCV takes the last axis of three for channels
    cv2.pow(rows, exponent, dst=rows)
    values -= np.float32(TINY**exponent)
    return values


def _norm(values: NDArray[np.float64], exponent: float) -> NDArray[np.float64]:
    """Return the norm of values along their first axis."""
    return _root(((values + TINY) ** exponent - TINY**exponent).sum(axis=0), exponent)


def _root(values: NDArray[np.float64], exponent: float) -> NDArray[np.float64]:
    """Return roots of values of at least 0."""
    return (values + TINY) ** (1 / exponent) - TINY ** (1 / exponent)


def _blurred(planes: Planes, sigma: float) -> Planes:
    """Return planes blurred by a Gaussian, mirrored beyond their edges; small ones as they are."""
    half = int(2 * sigma)
    if min(planes.shape[0], planes.shape[2]) <= half:
        return planes
    weights = np.exp(-0.5 * (np.arange(-half, half + 1) / sigma) ** 2)
    weights /= weights.sum()
    return across(along(planes, weights, cv2.BORDER_REFLECT_101), weights, cv2.BORDER_REFLECT_101)
