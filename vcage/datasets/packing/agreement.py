"""Agreement of a camera's episodes on pixel format, GOP and CRF, in few encodings.

The episode that is likely to allow the least loss chooses. The others are encoded with its choice at its CRF, in
growing batches, each at most at the CRF that earlier ones allow. Episodes encoded above the final CRF are encoded
again. The steps do not depend on the number of processes, so neither does the result.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby

from vcage.schema.compression import VideoStream
from vcage.video.choices import LOSSLESS, Choices


@dataclass(frozen=True)
class Bound:
    """The agreement of a camera's episodes so far.

    Args:
        pixel_format, gop: of all.
        crf: the highest that is still possible; :data:`LOSSLESS` if none is.
    """

    pixel_format: str
    gop: int
    crf: int

    def kept_by(self, stream: VideoStream) -> bool:
        """True if a stream is already encoded so."""
        if self.crf == LOSSLESS:
            return stream.lossless
        return (stream.pixel_format, stream.gop, stream.crf) == (self.pixel_format, self.gop, self.crf)


def agreed_by(streams: Iterable[VideoStream]) -> dict[str, Bound]:
    """Return camera → the agreement of its videos; without those whose pixel formats or GOPs differ."""
    bounds: dict[str, Bound] = {}
    cameras = groupby(sorted(streams, key=lambda stream: stream.camera), key=lambda stream: stream.camera)
    for camera, group in cameras:
        own = list(group)
        if len({(stream.pixel_format, stream.gop) for stream in own}) == 1:
            lowest = min(LOSSLESS if stream.crf is None else stream.crf for stream in own)
            bounds[camera] = Bound(own[0].pixel_format, own[0].gop, lowest)
    return bounds


Step = tuple[Sequence[str], Choices]
"""The next work: names of episodes, and the choices of their searches."""


@dataclass
class Agreement:
    """One camera's episodes on the way to their agreement.

    Args:
        episodes: their names, those likely to allow least first; at least one.
        choices: of the first one's search: the pixel formats possible for all episodes, the best first.
        bound: the agreement so far; at first, that of other episodes before.
        apart: true where they need not agree: each is searched for itself, or all have a CRF that was given.
        batch_growth: episodes that have been encoded after a batch, for each before it. More keep more processes busy,
            fewer are encoded in vain where one of them allows less.
    """

    episodes: Sequence[str]
    choices: Choices
    bound: Bound | None = None
    apart: bool = False
    batch_growth: int = 2
    _streams: dict[str, VideoStream] = field(default_factory=dict)

    def next_step(self) -> Step | None:
        """Return the next work; None when all are encoded as agreed."""
        bound, encoded = self.bound, len(self._streams)
        if self.apart:
            return None if encoded else (self.episodes, self.choices)
        if bound is None:
            return self.episodes[:1], self.choices
        if encoded < len(self.episodes) and bound.crf != LOSSLESS:
            return self.episodes[encoded : max(1, self.batch_growth * encoded)], self._below(bound)
        waiting = [name for name in self.episodes if not self._is_stored(name, bound)]
        return (waiting, self._below(bound)) if waiting else None

    def take(self, found: Mapping[str, VideoStream]) -> None:
        """Continue from the results of a step.

        Args:
            found: episode → its video.
        """
        self._streams |= found
        if self.apart:
            return
        bound, first = self.bound, next(iter(found.values()))
        if any(one.crf is None for one in found.values()):
            self._none_passes(bound or Bound(first.pixel_format, first.gop, LOSSLESS))
            return
        lowest = min(one.crf for one in found.values() if one.crf is not None)
        self.bound = Bound(first.pixel_format, first.gop, lowest)

    def staying(self, streams: Sequence[VideoStream]) -> int:
        """Return how many of its videos are encoded at the CRF that all known ones allow."""
        if self.apart:
            return len(streams)
        if self.bound is None:
            return sum(one.episode == self.episodes[0] for one in streams)
        lowest = min([self.bound.crf, *(LOSSLESS if one.crf is None else one.crf for one in streams)])
        return sum(replace(self.bound, crf=lowest).kept_by(one) for one in streams)

    def _none_passes(self, bound: Bound) -> None:
        """Where an episode passes at no CRF, try the best pixel format, and then lossless encoding."""
        best = self.choices.pixel_formats[0]
        if bound.crf == LOSSLESS or bound.pixel_format == best:
            self.bound = replace(bound, crf=LOSSLESS)
            return
        self.bound, self.choices = None, replace(self.choices, pixel_formats=(best,), gops=(bound.gop,))
        self._streams.clear()

    def _below(self, bound: Bound) -> Choices:
        pixel_format = self.choices.pixel_formats[0] if bound.crf == LOSSLESS else bound.pixel_format
        return replace(self.choices, pixel_formats=(pixel_format,), gops=(bound.gop,), upper=bound.crf)

    def _is_stored(self, name: str, bound: Bound) -> bool:
        return name in self._streams and bound.kept_by(self._streams[name])
