"""Frames of openpi's websocket protocol: MessagePack, with arrays as maps that have byte-string keys.

Source: ``openpi_client/msgpack_numpy.py`` of https://github.com/Physical-Intelligence/openpi (its format).
"""

from __future__ import annotations

from typing import Any

import msgpack
import numpy as np


def pack(message: Any) -> bytes:
    """The frame of a message: maps, lists, text, numbers and arrays."""
    return bytes(msgpack.packb(message, default=_encoded))


def unpack(frame: bytes) -> Any:
    """The message of a frame; arrays are read-only."""
    return msgpack.unpackb(frame, object_hook=_decoded)


def _encoded(value: Any) -> dict[bytes, Any]:
    if isinstance(value, np.ndarray) and value.dtype.kind in "biufSU":
        return {b"__ndarray__": True, b"data": value.tobytes(), b"dtype": value.dtype.str, b"shape": value.shape}
    if isinstance(value, np.generic):
        return {b"__npgeneric__": True, b"data": value.item(), b"dtype": value.dtype.str}
    raise TypeError(f"{type(value).__name__} cannot be sent")


def _decoded(found: dict[Any, Any]) -> Any:
    if b"__ndarray__" in found:
        return np.frombuffer(found[b"data"], np.dtype(found[b"dtype"])).reshape(found[b"shape"])
    if b"__npgeneric__" in found:
        return np.dtype(found[b"dtype"]).type(found[b"data"])
    return found
