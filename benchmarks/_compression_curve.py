"""Bytes against the loss of the worst held-out frame, over CRFs, as figures and as a picture."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter

from benchmarks._compression_clips import Clip
from benchmarks._compression_formats import GOP, LEROBOT, LIMIT
from benchmarks._compression_measures import code_hash
from vcage.base.files import atomic_path, cache_dir, read_json, write_json
from vcage.base.videos import decode
from vcage.video.codec import EncoderSettings, encode
from vcage.video.encoders import CODECS
from vcage.video.jod import JodMetric

CRFS = {"hevc": (14, 18, 22, 26, 32), "h264": (14, 18, 22, 26, 32), "av1": (8, 16, 24, 32, 42)}
"""AV1 counts to 63."""


@dataclass(frozen=True)
class Point:
    """One encoding of a clip: bytes per frame, and the loss of the worst held-out frame, JOD."""

    clip: str
    format: str
    crf: int
    bytes_per_frame: float
    jod_loss_heldout_max: float


def curve(clip: Clip) -> list[Point]:
    """A clip by every codec in its best pixel format at several CRFs, and as LeRobot has it."""
    path = cache_dir("benchmarks", "compression", f"results-{code_hash()}") / f"curve-{clip.name}.json"
    if not path.exists():
        write_json(path, [asdict(point) for point in _points(clip)])
    return [Point(**record) for record in read_json(path)]


def _points(clip: Clip) -> list[Point]:
    film, metric = clip.load(), JodMetric()

    def point(name: str, crf: int, video: bytes) -> Point:
        losses = metric.loss(decode(video, film.held_out), film.frames[film.held_out])
        return Point(clip.name, name, crf, len(video) / len(film.frames), float(losses.max()))

    points = []
    for codec in CODECS:
        settings = EncoderSettings(codec, gop=GOP)
        name = f"{codec}-g{GOP}"
        points += [point(name, crf, encode(film.frames, film.fps, settings, crf)) for crf in CRFS[codec]]
    with tempfile.TemporaryDirectory() as folder:
        LEROBOT.make(film, metric, Path(folder), {})
        video = (Path(folder) / f"{LEROBOT.name}.mp4").read_bytes()
    return [*points, point(LEROBOT.name, LEROBOT.crf, video)]


def draw(points: Sequence[Point], path: Path) -> Path:
    """Write the curves as a picture, a panel for each clip, a line for each format; the type is the suffix's."""
    clips = list(dict.fromkeys(point.clip for point in points))
    figure = Figure(figsize=(6 * len(clips), 4.5), layout="constrained")
    for axes, clip in zip(figure.subplots(1, len(clips), squeeze=False)[0], clips, strict=True):
        _draw_clip(axes, clip, [point for point in points if point.clip == clip])
    with atomic_path(path) as part:
        figure.savefig(part, dpi=120)
    return path


def _draw_clip(axes: Axes, clip: str, points: Sequence[Point]) -> None:
    for name in dict.fromkeys(point.format for point in points):
        line = sorted((p.bytes_per_frame / 1000, p.jod_loss_heldout_max) for p in points if p.format == name)
        axes.plot(*zip(*line, strict=True), marker="o", label=name)
    axes.axhline(LIMIT, color="grey", linestyle=":", label=f"{LIMIT} JOD")
    axes.set(title=clip, xlabel="kB per frame", ylabel="worst held-out frame, JOD lost", xscale="log", yscale="log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1, 2, 3, 5)))
        axis.set_major_formatter(FormatStrFormatter("%g"))
        axis.set_minor_formatter(NullFormatter())
    axes.grid(visible=True, alpha=0.3)
    axes.legend()
