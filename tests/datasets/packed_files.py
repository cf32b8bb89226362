"""Recordings packed as the compression does it: every camera's pictures in a lossless video beside the file."""

from __future__ import annotations

from pathlib import Path

from vcage.datasets.packed import Stream, write_packed
from vcage.datasets.recordings.opening import open_hdf5
from vcage.video.codec import EncoderSettings, encode


def streams(source: Path) -> list[Stream]:
    """Return the links to the videos of a recording."""
    recording = open_hdf5(source)
    return [
        Stream(
            camera=camera.name,
            key=camera.key,
            file=f"{source.stem}.{camera.name}.mp4",
            frames=camera.frames,
            width=camera.width,
            height=camera.height,
            storage=camera.storage,
            swapped=recording.put_back_swapped(camera.name),
        )
        for camera in recording.cameras
    ]


def pack(source: Path, target: Path) -> Path:
    """The packed file, with lossless videos beside it."""
    target.parent.mkdir(exist_ok=True)
    for stream in streams(source):
        pictures = open_hdf5(source).pictures(stream.camera)
        (target.parent / stream.file).write_bytes(encode(pictures, 10.0, EncoderSettings(gop=2), None))
    return write_packed(source, target, streams(source))
