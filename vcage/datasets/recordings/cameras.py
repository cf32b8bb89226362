"""The stored pictures of a recording's camera."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class RecordedCamera:
    """The stored pictures of one camera.

    Args:
        name: short name, as in ``cam_high``.
        key: of the pictures in the file.
        frames: number of pictures.
        width, height: of the first picture, pixels.
        storage: ``raw``, a kind of picture file such as ``jpeg``, or the codec of a video, such as ``hevc``.
        stored_bytes: size as stored.
        channels: of the stored pictures: 1 grey, 3 RGB, 4 RGBA; they are read as RGB.
    """

    name: str
    key: str
    frames: int
    width: int
    height: int
    storage: str
    stored_bytes: int
    channels: int = 3

    @property
    def raw_bytes(self) -> int:
        """Size of the pictures as uint8 RGB."""
        return self.frames * self.width * self.height * 3

    @property
    def notes(self) -> list[str]:
        """Notes for the user where the stored pictures are not RGB."""
        if self.channels == 1:
            return [f"{self.name} is grey; it is read as RGB"]
        return [f"{self.name} has an alpha channel; it is laid over white"] if self.channels == 4 else []
