"""Rendered clips made to resemble a real camera's: a model of what the light meets between the lens and the file.

Renders are clean, and clean pictures are easy for a codec: nothing changes between frames but what moves. Real cameras
add noise to every pixel of every frame, which no codec can predict, so savings measured on renders alone would promise
too much. The model follows the light: the lens blurs and darkens the corners; the exposure wanders and flickers with
the lamps; behind a Bayer mosaic every pixel counts electrons, with shot noise (Poisson), read noise (normal) and its
own sensitivity; ten bits are kept; the camera then balances the colours, interpolates what the mosaic left out, and
sharpens. The noise so depends on the brightness, spans neighbouring pixels and is coloured, as in real pictures, which
white noise added to a finished picture is not. Its strength is that of small sensors indoors: at middle grey about two
of 255 steps in a well-lit room, four in a dim one.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]

BITS = 10
BLACK_LEVEL = 64
"""Of the analogue-to-digital converter, steps: noise around black is not cut off."""

SATURATION = 2**BITS - 1 - BLACK_LEVEL

SENSITIVITY = np.array([0.55, 1.0, 0.65], np.float32)
"""Red, green, blue of the sensor under white light; the balance that follows multiplies the noise by its inverse."""


@dataclass(frozen=True)
class RealCamera:
    """A camera and the light it works in.

    Args:
        full_well: electrons that a pixel counts where the picture is white; fewer in a dim room.
        read_noise: standard deviation, electrons.
        uneven: standard deviation of the pixels' sensitivities, relative.
        blur: standard deviation of the lens's blur, pixels.
        vignette: light that is missing in the corners, relative.
        flicker: amplitude of the lamps' flicker from frame to frame, relative.
        wander: standard deviation of the exposure's slow wander, relative.
        sharpening: weight of the detail that the camera adds.
        seed: of all noise.
    """

    full_well: float
    read_noise: float = 4.0
    uneven: float = 0.008
    blur: float = 0.7
    vignette: float = 0.3
    flicker: float = 0.008
    wander: float = 0.015
    sharpening: float = 0.5
    seed: int = 0

    def film(self, frames: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Record a rendered clip with this camera, both (T, H, W, 3) uint8 sRGB, H and W even."""
        rng = np.random.default_rng(self.seed)
        height, width = frames.shape[1:3]
        fixed = _falloff(height, width, self.vignette) * rng.normal(1, self.uneven, (height, width)).astype(np.float32)
        exposure = self._exposure(len(frames), rng)
        return np.stack([self._shot(f, fixed * gain, rng) for f, gain in zip(frames, exposure, strict=True)])

    def _exposure(self, count: int, rng: np.random.Generator) -> Floats:
        """(T,) gain of each frame: a slow wander, and the beat of the lamps with the shutter."""
        memory = 0.95
        wander = np.empty(count)
        value = 0.0
        for i, push in enumerate(rng.normal(0, self.wander * np.sqrt(1 - memory**2), count)):
            value = memory * value + push
            wander[i] = value
        beat = self.flicker * np.sin(2 * np.pi * (0.37 * np.arange(count) + rng.uniform()))
        return (1 + wander + beat).astype(np.float32)

    def _shot(self, picture: NDArray[np.uint8], gain: Floats, rng: np.random.Generator) -> NDArray[np.uint8]:
        light = cv2.GaussianBlur(_TO_LINEAR[picture], (0, 0), self.blur) * gain[..., None]
        raw = self._sensor(_mosaic(light * SENSITIVITY), rng)
        return _to_srgb(self._sharpened(_developed(raw)))

    def _sensor(self, light: Floats, rng: np.random.Generator) -> NDArray[np.uint16]:
        """(H, W) steps of the converter for the light of each pixel, 1 where the picture is white."""
        electrons = rng.poisson(light * self.full_well) + rng.normal(0, self.read_noise, light.shape)
        steps = np.round(electrons / self.full_well * SATURATION) + BLACK_LEVEL
        return np.clip(steps, 0, 2**BITS - 1).astype(np.uint16)

    def _sharpened(self, light: Floats) -> Floats:
        return light + self.sharpening * (light - cv2.GaussianBlur(light, (0, 0), 1.0))


def _falloff(height: int, width: int, missing: float) -> Floats:
    """(H, W) light that arrives, 1 in the middle and ``1 - missing`` in the corners."""
    y, x = np.mgrid[-1 : 1 : height * 1j, -1 : 1 : width * 1j]
    return (1 - missing * (x**2 + y**2) / 2).astype(np.float32)


def _mosaic(light: Floats) -> Floats:
    """(H, W): of each pixel the one colour that its filter lets through, in rows RGRG and GBGB."""
    raw = light[..., 1].copy()
    raw[0::2, 0::2] = light[0::2, 0::2, 0]
    raw[1::2, 1::2] = light[1::2, 1::2, 2]
    return raw


def _developed(raw: NDArray[np.uint16]) -> Floats:
    """(H, W, 3) linear RGB of a mosaic: balanced, then interpolated along edges.

    OpenCV names a mosaic after its second row and column, so RGGB is its ``BayerBG``. It interpolates whole numbers:
    16 bits of them lose nothing.
    """
    light = np.clip(raw.astype(np.float32) - BLACK_LEVEL, 0, None) / SATURATION
    light[0::2, 0::2] /= SENSITIVITY[0]
    light[1::2, 1::2] /= SENSITIVITY[2]
    whole = np.round(np.clip(light, 0, 1) * 65535).astype(np.uint16)
    return cv2.cvtColor(whole, cv2.COLOR_BayerBG2RGB_EA).astype(np.float32) / 65535


def _linear(srgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """IEC 61966-2-1, decoding."""
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


_TO_LINEAR = _linear(np.arange(256) / 255).astype(np.float32)


def _to_srgb(light: Floats) -> NDArray[np.uint8]:
    """IEC 61966-2-1, encoding."""
    light = np.clip(light, 0, 1)
    encoded = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.round(255 * encoded).astype(np.uint8)
