"""The frames of openpi's websocket protocol: MessagePack, with arrays as maps.

Source: ``openpi_client/msgpack_numpy.py`` of https://github.com/Physical-Intelligence/openpi (its format).
An array is a map with the byte-string keys ``__ndarray__``, ``data`` (C order), ``dtype`` and ``shape``; a numpy scalar
one with ``__npgeneric__``, ``data`` and ``dtype``.
"""

from __future__ import annotations

from typing import Any

import msgpack
import numpy as np

REFUSED_KINDS = "VOc"
"""Kinds of dtypes that the format does not carry: structures, objects and complex numbers."""


def pack(message: Any) -> bytes:
    """The frame of a message: maps, lists, text, numbers and arrays.

    Raises:
        TypeError: a value that the format does not carry.
    """
    return bytes(msgpack.packb(message, default=_encoded) or b"")


def unpack(frame: bytes) -> Any:
    """The message of a frame; arrays are read-only, and sequences are lists.

    Raises:
        ValueError: the bytes are no such frame.
    """
    try:
        return msgpack.unpackb(frame, object_hook=_decoded)
    except (msgpack.UnpackException, KeyError, TypeError, ValueError) as error:
        raise ValueError(f"a frame of {len(frame)} bytes is not MessagePack with arrays: {error}") from error


def _encoded(value: Any) -> dict[bytes, Any]:
    if isinstance(value, (np.ndarray, np.generic)) and value.dtype.kind in REFUSED_KINDS:
        raise TypeError(f"an array of {value.dtype} cannot be sent")
    if isinstance(value, np.ndarray):
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
