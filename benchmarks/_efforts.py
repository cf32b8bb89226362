"""Compare the efforts of each codec: the encoder's time, and the bytes where all stay below the same loss."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, get_args

from benchmarks._compression_formats import GOP, Searched
from benchmarks._compression_measures import Measured
from vcage.schema.compression import Effort
from vcage.video.choices import Choices
from vcage.video.encoders import CODECS

DEFAULT = "default"
"""The effort that bytes are compared with."""

EFFORTS: tuple[Effort, ...] = get_args(Effort)


def effort_formats() -> list[Searched]:
    """Every codec with every effort, searched with the project's GOP for the fewest bytes below the benchmark's loss.

    A codec without a lossless form may not reach that; each effort is then searched for a loss of its own.
    """
    return [
        Searched(_name(codec, effort), Choices(codec, effort, gops=(GOP,))) for codec in CODECS for effort in EFFORTS
    ]


def effort_rows(measured: Iterable[Measured]) -> list[dict[str, Any]]:
    """One row for each codec and effort: CPU milliseconds a picture, bytes, and their share of the default's bytes.

    There is no share (None) where the efforts were searched for different losses: their bytes do not compare.
    """
    groups: dict[str, list[Measured]] = {}
    for one in measured:
        groups.setdefault(one.format, []).append(one)
    sizes = {name: sum(one.bytes for one in group) for name, group in groups.items()}
    limits = {name: [one.limit for one in group] for name, group in groups.items()}
    rows = []
    for name, group in groups.items():
        codec, effort = name.rsplit("-", 1)
        frames, default = sum(one.frames for one in group), _name(codec, DEFAULT)
        rows.append(
            {
                "codec": codec,
                "effort": effort,
                "pictures": frames,
                "encode_ms_per_frame": round(sum(one.encode_ms * one.frames for one in group) / frames, 2),
                "search_ms_per_frame": round(sum(one.search_ms * one.frames for one in group) / frames, 1),
                "bytes": sizes[name],
                "of_default": round(sizes[name] / sizes[default], 3) if limits[name] == limits[default] else None,
                "jod_loss_keyframes_max": max(max(one.losses_keyframes) for one in group),
            }
        )
    return rows


def _name(codec: str, effort: str) -> str:
    return f"{codec}-{effort}"
