"""Pictures on the wire: PNG and base64 in, whatever a server sends out.

OpenCV is imported when a picture is there: ``vcage doctor`` looks for the providers' keys before it is installed.
"""

from __future__ import annotations

import base64
import binascii

import numpy as np

from vcage.base.errors import DamagedFile, EndpointFailed, OversizedFile

MIN_EDGE_PX = 64
"""Pixels; less is a place kept for a picture."""


def encode_png(picture: np.ndarray) -> bytes:
    """PNG of an (H, W, 3) RGB picture."""
    import cv2

    _, data = cv2.imencode(".png", cv2.cvtColor(picture, cv2.COLOR_RGB2BGR))
    return data.tobytes()


def encode_base64(picture: np.ndarray) -> str:
    """Base64 (standard alphabet) of the picture's PNG."""
    return base64.b64encode(encode_png(picture)).decode()


def data_url(picture: np.ndarray) -> str:
    """The picture as a ``data:`` URL."""
    return f"data:image/png;base64,{encode_base64(picture)}"


def decode_base64(text: object, source: str) -> np.ndarray:
    """(H, W, 3) RGB of a base64 picture in either alphabet, with or without padding or a ``data:`` head.

    The type is found from the bytes: servers do not always name it truly.

    Raises:
        EndpointFailed: it is not base64, or no whole picture of a size that can be used; names ``source``.
    """
    from vcage.base.pictures import read_picture

    if not isinstance(text, str):
        raise EndpointFailed(f"{source} sent {type(text).__name__} for a picture", hint="check the base URL")
    if text.startswith("data:"):
        text = text.partition(",")[2]
    text = "".join(text.split()).rstrip("=").replace("-", "+").replace("_", "/")
    try:
        data = base64.b64decode(text + "=" * (-len(text) % 4), validate=True)
    except binascii.Error as error:
        raise EndpointFailed(f"{source} sent a picture that is not base64: {error}", hint="run it again") from error
    try:
        picture = read_picture(data)
    except OversizedFile as error:
        raise EndpointFailed(f"{source}: {error.message}", hint="run it again, or take another model") from error
    except DamagedFile as error:
        raise EndpointFailed(
            f"{source} sent {len(data)} bytes that are not a complete picture: {error.message}", hint="run it again"
        ) from error
    height, width = picture.shape[:2]
    if min(height, width) < MIN_EDGE_PX:
        raise EndpointFailed(
            f"{source} sent a picture of {width} x {height} pixels, which is not a complete picture",
            hint="run it again",
        )
    return picture
