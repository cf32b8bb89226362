"""What a user may choose about compression: one place for its defaults."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from vcage.base.errors import UnknownName, UsageError
from vcage.schema.compression import Reduce, SharedBy
from vcage.video.choices import LOSSLESS, Choices, Criterion
from vcage.video.encoders import CODECS
from vcage.video.jod import DISPLAY
from vcage.video.keyframes import COUNT

AUTO = "auto"

GOPS = (10, 30, 120)
"""What is tried where the GOP may be chosen, the one that is searched first."""


@dataclass(frozen=True)
class CompressionSettings:
    """How videos are encoded and judged.

    Args:
        max_loss: loss that no scored frame may reach, JOD.
        reduce: over the scored frames, 'max' or 'mean'.
        display: ColorVideoVDP's display model.
        guard: score held-out frames too, and search again where they fail.
        scope: what shares a CRF: all episodes of a camera, as LeRobot can represent, or none, each episode its own.
        crf: given instead of searched; :data:`LOSSLESS` for none.
        codec: 'hevc', 'av1' or 'h264'.
        preset: the encoder's; none takes the codec's usual one.
        pixel_format: FFmpeg's name; 'auto' tries those of the codec.
        gop: frames from one random-access point to the next; 'auto' tries several.
        keyframes: how many frames are scored for each video.

    Raises:
        UsageError, UnknownName: a value is out of range or not known.
    """

    max_loss: float = 0.1
    reduce: Reduce = "max"
    display: str = DISPLAY
    guard: bool = True
    scope: SharedBy = "camera"
    crf: int | None = None
    codec: str = "hevc"
    preset: str = ""
    pixel_format: str = AUTO
    gop: int | str = 10
    keyframes: int = COUNT

    def __post_init__(self) -> None:
        if self.codec not in CODECS:
            raise UnknownName("codec", self.codec, CODECS)
        lowest, highest = CODECS[self.codec].min_crf, CODECS[self.codec].max_crf
        if self.crf not in (None, LOSSLESS) and not lowest <= self.crf <= highest:
            raise UsageError(f"crf is {self.crf}, expected {lowest} … {highest} for {self.codec}, or lossless")
        if self.crf == LOSSLESS and not CODECS[self.codec].lossless_format:
            raise UsageError(
                f"{self.codec} has no lossless form here",
                hint=f"take --codec {' or '.join(name for name, facts in CODECS.items() if facts.lossless_format)}",
            )
        if self.max_loss <= 0:
            raise UsageError(
                f"the largest loss is {self.max_loss} JOD, which no video stays under",
                hint="give a number above 0, or --crf lossless",
            )
        self.choices().settings(self.pixel_formats[0] if self.pixel_formats else "")

    @property
    def pixel_formats(self) -> tuple[str, ...]:
        """Those that may be chosen; none for all of the codec."""
        return () if self.pixel_format == AUTO else (self.pixel_format,)

    def choices(self) -> Choices:
        """What the search may choose from."""
        gops = GOPS if self.gop == AUTO else (int(self.gop),)
        if self.crf is None:
            return Choices(self.codec, self.preset, self.pixel_formats, gops)
        formats = self.pixel_formats or CODECS[self.codec].pixel_formats[:1]
        return Choices(self.codec, self.preset, formats, gops[:1], upper=self.crf)

    def criterion(self) -> Criterion:
        """When a video passes; a given CRF always does."""
        if self.crf is not None:
            return Criterion(float("inf"), self.reduce, guard=False)
        return Criterion(self.max_loss, self.reduce, self.guard)

    def options(self) -> dict[str, Any]:
        """What changes the result, JSON-serialisable."""
        return asdict(self)
