"""Options of compression, for every command that compresses."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Annotated, Any, ClassVar

from tyro.conf import arg

from vcage.base.errors import UnknownName, UsageError
from vcage.base.options import POSITIVE, UNSAID, between, choice, positive, value
from vcage.schema.compression import Effort, Reduce, SharedBy
from vcage.video.choices import LOSSLESS, Choices, Criterion
from vcage.video.encoders import CODECS
from vcage.video.jod import DISPLAY
from vcage.video.keyframes import SETTINGS as KEYFRAMES

AUTO = "auto"

GOP_HELP = (
    "frames from one random-access point to the next; few make random frames quick to decode, auto tries several for "
    "the fewest bytes"
)


def _crf(text: str) -> int:
    if text == "lossless":
        return LOSSLESS
    if text.isdecimal():
        return int(text)
    raise ValueError(f"{text!r} is neither a CRF, a whole number from 0 on, nor 'lossless'")


def _gop(text: str) -> int | str:
    return text if text == AUTO else positive(text)


CRF = value(_crf, "N", show=lambda crf: "lossless" if crf == LOSSLESS else str(crf))
"""A CRF, or "lossless"."""


@dataclass(frozen=True)
class CompressionSettings:
    """Settings of the encoding and its judge.

    Example:
        >>> CompressionSettings(max_loss=0.05, codec="av1")

    Raises:
        UsageError, UnknownName: a value is out of range or not known.
    """

    GOPS: ClassVar[tuple[int, ...]] = (10, 30, 120)
    """tried where the GOP is not given, the one to search first"""

    max_loss: Annotated[float, between(0, 10, "JOD")] = 0.1
    """loss that no scored frame reaches"""
    reduce: Reduce = "max"
    """what of the scored frames' losses must stay below"""
    display: Annotated[str, arg(metavar="NAME")] = DISPLAY
    """ColorVideoVDP's display model, which a loss depends on"""
    guard: bool = True
    """score one in ten of the other frames too, and search again where they fail"""
    scope: SharedBy = "camera"
    """one CRF for all episodes of a camera, as LeRobot can represent, or one for each"""
    crf: Annotated[int | None, CRF, UNSAID] = None
    """this CRF instead of a search; or 'lossless'"""
    codec: Annotated[str, choice(tuple(CODECS))] = "hevc"
    """video codec"""
    effort: Effort = "default"
    """for HEVC, best takes a sixth fewer bytes and 2.5 times the time, fast half as many bytes more in half the time"""
    pixel_format: Annotated[str, arg(metavar="NAME")] = AUTO
    """FFmpeg's name; auto tries those of the codec"""
    gop: Annotated[int | str, value(_gop, "N"), arg(help=GOP_HELP)] = 10
    keyframes: Annotated[int, POSITIVE] = KEYFRAMES.count
    """frames that the search scores in each video"""

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
        """Allowed pixel formats; empty for all of the codec."""
        return () if self.pixel_format == AUTO else (self.pixel_format,)

    @property
    def agrees(self) -> bool:
        """True if the episodes of a camera share a CRF that is searched."""
        return self.scope == "camera" and self.crf is None

    def choices(self) -> Choices:
        """Return the choices of the search."""
        gops = self.GOPS if self.gop == AUTO else (int(self.gop),)
        if self.crf is None:
            return Choices(self.codec, self.effort, self.pixel_formats, gops)
        formats = self.pixel_formats or CODECS[self.codec].pixel_formats[:1]
        return Choices(self.codec, self.effort, formats, gops[:1], upper=self.crf)

    def criterion(self) -> Criterion:
        """Return the criterion to pass; a given CRF always does."""
        if self.crf is not None:
            return Criterion(float("inf"), self.reduce, guard=False)
        return Criterion(self.max_loss, self.reduce, self.guard)

    def options(self) -> dict[str, Any]:
        """Return the options that change the result, JSON-serialisable."""
        return asdict(self)
