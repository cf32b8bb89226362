"""Measure a clip in a format: bytes, losses, times; kept in the cache, as a clip takes minutes."""

from __future__ import annotations

import hashlib
import logging
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from importlib import metadata
from pathlib import Path

import av
import cv2

import benchmarks
from benchmarks._compression_clips import Clip, Film
from benchmarks._compression_episodes import VERSION
from benchmarks._compression_formats import Format, Found, Made
from benchmarks._compression_stored import random_decode_ms
from vcage import video as compression
from vcage.base import videos
from vcage.base.files import cache_dir, read_json, write_json
from vcage.datasets.packing.settings import CompressionSettings
from vcage.video.jod import JodMetric

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Measured:
    """One clip in one format.

    Args:
        clip, clips, format: names of the clip, its kind and the format.
        frames, raw_bytes: of the clip.
        bytes: of the stored pictures.
        losses_keyframes, losses_heldout: of the frames that a search judges and of others, JOD.
        encode_ms, search_ms, encodes, gop, crf, pixel_format, limit: see :class:`Made`.
        decode_ms: CPU time to read a random frame from the closed file.
    """

    clip: str
    clips: str
    format: str
    frames: int
    raw_bytes: int
    bytes: int
    losses_keyframes: list[float]
    losses_heldout: list[float]
    encode_ms: float
    search_ms: float
    decode_ms: float
    encodes: int
    gop: int | None
    crf: int | None
    pixel_format: str | None
    limit: float | None


def measure_clip(clip: Clip, formats: Sequence[Format]) -> list[Measured]:
    """A clip in every format; what the same code has measured before is taken from the cache."""
    path = cache_dir("benchmarks", "compression", f"results-{code_hash()}") / f"{clip.name}.json"
    known = {record["format"]: Measured(**record) for record in read_json(path)} if path.exists() else {}
    missing = [form for form in formats if form.name not in known]
    if missing:
        film, metric = clip.load(), JodMetric()
        for form in missing:
            known[form.name] = measure(clip, form, film, metric, known)
            write_json(path, [asdict(one) for one in known.values()])
            logger.info("%s as %s: %d bytes", clip.name, form.name, known[form.name].bytes)
    return [known[form.name] for form in formats]


def measure(clip: Clip, form: Format, film: Film, metric: JodMetric, known: Mapping[str, Measured]) -> Measured:
    """One clip in one format; ``known`` has the formats that come before by name."""
    before = {name: Found(max(m.losses_keyframes), m.crf, m.pixel_format) for name, m in known.items()}
    with tempfile.TemporaryDirectory() as folder:
        made = form.make(film, metric, Path(folder), before)
        return Measured(
            clip=clip.name,
            clips=clip.kind,
            format=form.name,
            frames=len(film.frames),
            raw_bytes=film.frames.nbytes,
            bytes=made.stored.bytes,
            losses_keyframes=_losses(film, made, film.keyframes, metric),
            losses_heldout=_losses(film, made, film.held_out, metric),
            encode_ms=made.encode_ms,
            search_ms=made.search_ms,
            decode_ms=random_decode_ms(made.stored, len(film.frames)),
            encodes=made.encodes,
            gop=made.gop,
            crf=made.crf,
            pixel_format=made.pixel_format,
            limit=made.limit,
        )


def _losses(film: Film, made: Made, indices: Sequence[int], metric: JodMetric) -> list[float]:
    return metric.loss(made.stored.read(indices), film.frames[list(indices)]).tolist()


@cache
def code_hash() -> str:
    """Hash of everything that affects a measurement: new code, versions or default choices mean a new one."""
    versions = f"{av.__version__} {cv2.__version__} {metadata.version('cvvdp')} {VERSION}"
    digest = hashlib.sha256(f"{versions} {CompressionSettings().choices()}".encode())
    files = [Path(videos.__file__)]
    files += [path for folder in compression.__path__ for path in sorted(Path(folder).glob("*.py"))]
    files += [path for folder in benchmarks.__path__ for path in sorted(Path(folder).glob("_compression_*.py"))]
    for path in files:
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
