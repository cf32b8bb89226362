"""The rows of the compression benchmark: what all clips of a kind measure together in one format."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain
from statistics import fmean, median
from typing import Any

from benchmarks._compression_formats import JPEG, LEROBOT, LIMIT, PNG
from benchmarks._compression_measures import Measured

BASELINES = {"vs_png": PNG.name, "vs_jpeg_hdf5": JPEG.name, "vs_lerobot_av1": LEROBOT.name}

DIGITS = 5


def rows(measured: Iterable[Measured]) -> list[dict[str, Any]]:
    """A row for each kind of clips and format, in the order of their first measurement.

    ``vs_x`` is the share of the bytes that is saved against x on the same clips, ``vs_raw`` against uint8 pictures.
    Losses are of single frames, JOD; ``heldout`` ones of frames that are no keyframes. Times are the CPU's: of encoding
    once, of the whole search, and of reading one random frame from the closed file. ``clips_in_limit`` counts those
    whose keyframes all lose less than 0.1 JOD.
    """
    groups: dict[tuple[str, str], list[Measured]] = {}
    for one in measured:
        groups.setdefault((one.clips, one.format), []).append(one)
    sizes = {key: sum(one.bytes for one in group) for key, group in groups.items()}
    return [
        {"format": name, "clips": clips}
        | _figures(group)
        | _savings(clips, group, sizes)
        | _losses(group)
        | _costs(group)
        for (clips, name), group in groups.items()
    ]


def _figures(group: Sequence[Measured]) -> dict[str, Any]:
    crfs = [one.crf for one in group if one.crf is not None]
    return {
        "count": len(group),
        "gop": group[0].gop,
        "crf": median(crfs) if crfs else None,
        "bytes": sum(one.bytes for one in group),
        "bytes_per_frame": round(sum(one.bytes for one in group) / sum(one.frames for one in group)),
    }


def _savings(clips: str, group: Sequence[Measured], sizes: dict[tuple[str, str], int]) -> dict[str, float]:
    size, raw = sum(one.bytes for one in group), sum(one.raw_bytes for one in group)
    others = {name: sizes[clips, baseline] for name, baseline in BASELINES.items()}
    return {name: round(1 - size / other, DIGITS) for name, other in {"vs_raw": raw, **others}.items()}


def _losses(group: Sequence[Measured]) -> dict[str, Any]:
    keyframes = list(chain.from_iterable(one.losses_keyframes for one in group))
    held_out = list(chain.from_iterable(one.losses_heldout for one in group))
    return {
        "clips_in_limit": sum(max(one.losses_keyframes) < LIMIT for one in group),
        "jod_loss_keyframes_max": max(keyframes),
        "jod_loss_heldout_max": max(held_out),
        "jod_loss_heldout_mean": round(fmean(held_out), DIGITS),
    }


def _costs(group: Sequence[Measured]) -> dict[str, float]:
    frames = sum(one.frames for one in group)
    return {
        "encode_ms_per_frame": round(sum(one.encode_ms * one.frames for one in group) / frames, 2),
        "search_ms_per_frame": round(sum(one.search_ms * one.frames for one in group) / frames, 1),
        "encodes_max": max(one.encodes for one in group),
        "random_decode_ms": round(fmean(one.decode_ms for one in group), 2),
    }
