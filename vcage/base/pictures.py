"""Pictures in a run folder: PNG, 8-bit RGB, and 16-bit label images."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from vcage.base.errors import DamagedFile, MissingStage
from vcage.base.files import maker_of, write_bytes


def write_picture(path: Path, picture: np.ndarray) -> Path:
    """Write a (H, W, 3) uint8 RGB picture as PNG."""
    return write_bytes(path, cv2.imencode(".png", cv2.cvtColor(picture, cv2.COLOR_RGB2BGR))[1].tobytes())


def jpeg(picture: np.ndarray, quality: int) -> bytes:
    """A (H, W, 3) uint8 RGB picture as a JPEG file of that quality, 0 to 100."""
    bgr = cv2.cvtColor(picture, cv2.COLOR_RGB2BGR)
    return cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes()


def write_labels(path: Path, labels: np.ndarray) -> Path:
    """Write a (H, W) label image as 16-bit PNG."""
    return write_bytes(path, cv2.imencode(".png", labels.astype(np.uint16))[1].tobytes())


def read_picture(path: Path) -> np.ndarray:
    """Read a picture as (H, W, 3) uint8 RGB; grey becomes RGB, alpha is laid over white.

    Raises:
        MissingStage: it is not there.
        DamagedFile: it is not a picture.
    """
    return rgb_of_decoded(_decode(path))


def rgb_of_decoded(picture: np.ndarray) -> np.ndarray:
    """(H, W, 3) uint8 RGB of what OpenCV decoded; 16 bits become 8, grey becomes RGB, alpha is laid over white."""
    if picture.dtype == np.uint16:
        picture = (picture // 257).astype(np.uint8)
    return cv2.cvtColor(three_channels(picture), cv2.COLOR_BGR2RGB)


def three_channels(picture: np.ndarray) -> np.ndarray:
    """(H, W, 3) of a uint8 picture that is grey (H, W), or has three channels or four; alpha is laid over white."""
    if picture.ndim == 2:
        return cv2.cvtColor(picture, cv2.COLOR_GRAY2RGB)
    if picture.shape[2] == 4:
        alpha = picture[..., 3:].astype(np.float32) / 255
        return np.round(picture[..., :3] * alpha + 255 * (1 - alpha)).astype(np.uint8)
    return picture


def read_labels(path: Path) -> np.ndarray:
    """Read a label image as (H, W) int32; raises as :func:`read_picture`."""
    labels = _decode(path)
    if labels.ndim != 2:
        raise DamagedFile(f"{path} is a colour picture, not a label image", maker="select_place")
    return labels.astype(np.int32)


def _decode(path: Path) -> np.ndarray:
    if not path.is_file():
        raise MissingStage(f"{path} does not exist", hint="the stage that writes it comes first", maker=maker_of(path))
    data = np.frombuffer(path.read_bytes(), np.uint8)
    picture = cv2.imdecode(data, cv2.IMREAD_UNCHANGED) if len(data) else None
    if picture is None:
        raise DamagedFile(f"{path} is not a picture", hint="mend it", maker=maker_of(path))
    return picture
