"""Links that replace pictures in an HDF5 file, which were moved to a video beside it.

In place of the dataset of pictures there is a scalar string, the video's file name, with attributes that describe the
stream and the dataset; the dataset's own attributes stay with it.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any, Self

import h5py
import numpy as np
from pydantic import AfterValidator, Field, ValidationError
from pydantic.dataclasses import dataclass

from vcage.base.errors import DamagedFile
from vcage.base.placeholders import require_fetched
from vcage.base.video_files import frame_size
from vcage.base.videos import frame_count
from vcage.datasets.hdf5_contents import address, datasets_in
from vcage.datasets.picture_lengths import AGAIN, STRICT, LengthsPlace
from vcage.datasets.stored_pictures import ARRAY, FIXED, PADDED, VLEN, PictureKind, picture_channels, picture_kind

LINK_SCHEMA = "vcage.pictures_in_video/1"

OURS = "vcage_"
"""Prefix of the attributes that describe the link; all others are the dataset's own."""

RANKS = {ARRAY: (3, 4), FIXED: (1,), PADDED: (2,), VLEN: (1,)}
"""Numbers of axes that datasets of pictures have, by kind."""

RESTORE = f"restore the link, or {AGAIN}"

MISSING = "keep the videos in the folder of their HDF5 file, under the names they were given; or compress again"


def _bare_name(file: str) -> str:
    if Path(file).name != file or file in ("", ".."):
        raise ValueError(f"{file!r} is not the bare name of a file")
    return file


Count = Annotated[int, Field(gt=0)]


@dataclass(frozen=True, config=STRICT)
class Stream:
    """The pictures of one camera in a video.

    Args:
        camera: the camera's name.
        key: of the dataset that held the pictures.
        file: name of the MP4 file in the folder of the HDF5 file.
        frames: number of pictures.
        width, height: pixels.
        storage: of the pictures in the dataset: ``raw``, or a kind of picture file such as ``jpeg``.
        swapped: true if red and blue change places in restored pictures, as they had there for readers of the
            layout; in the video they are right.

    Raises:
        ValueError: a field has another type or value.
    """

    camera: str
    key: str
    file: Annotated[str, AfterValidator(_bare_name)]
    frames: Count
    width: Count
    height: Count
    storage: str
    swapped: bool


@dataclass(frozen=True, config=STRICT)
class Original:
    """The properties of the dataset that held the pictures, to make it again.

    Args:
        kind: see :func:`vcage.datasets.stored_pictures.picture_kind`.
        shape, maxshape: as h5py gives them.
        channels: of a picture.
        chunks, compression, compression_opts, shuffle, fletcher32: as h5py gives them.

    Raises:
        ValueError: no dataset of pictures has these values.
    """

    kind: PictureKind
    shape: list[Count]
    maxshape: list[Count | None]
    channels: Count
    chunks: list[Count] | None
    compression: str | None
    compression_opts: Any
    shuffle: bool
    fletcher32: bool

    def __post_init__(self) -> None:
        if len(self.shape) not in RANKS[self.kind]:
            raise ValueError(f"original_shape is {self.shape}, which is not that of pictures of the kind {self.kind}")
        if any(len(one) != len(self.shape) for one in (self.maxshape, self.chunks or self.shape)):
            raise ValueError("original_shape, original_maxshape and original_chunks differ in their number of axes")

    @classmethod
    def of(cls, dataset: h5py.Dataset) -> Self:
        """Return the properties of a dataset of pictures with at least one.

        Raises:
            DamagedFile: its first picture cannot be decoded.
        """
        return cls(
            kind=picture_kind(dataset),
            shape=list(dataset.shape),
            maxshape=list(dataset.maxshape),
            channels=picture_channels(dataset, dataset.name),
            chunks=list(dataset.chunks) if dataset.chunks else None,
            compression=dataset.compression,
            compression_opts=dataset.compression_opts,
            shuffle=bool(dataset.shuffle),
            fletcher32=bool(dataset.fletcher32),
        )

    def filters(self) -> dict[str, Any]:
        """Return arguments of ``create_dataset`` to filter data the same way."""
        filters = {name: getattr(self, name) for name in ("compression", "compression_opts", "shuffle", "fletcher32")}
        return {name: value or None if name in ("shuffle", "fletcher32") else value for name, value in filters.items()}


@dataclasses.dataclass(frozen=True)
class Link:
    """A link in a file.

    Args:
        stream: the video.
        original: the dataset that held the pictures.
        lengths: places of the pictures' lengths in bytes.

    Raises:
        ValueError: the dataset had another shape than its pictures.
    """

    stream: Stream
    original: Original
    lengths: tuple[LengthsPlace, ...] = ()

    def __post_init__(self) -> None:
        stream, shape = self.stream, self.original.shape
        expected = [stream.frames, stream.height, stream.width] if self.original.kind == ARRAY else [stream.frames]
        if shape[: len(expected)] != expected:
            raise ValueError(
                f"original_shape is {shape}, the pictures are {stream.frames} of {stream.width}x{stream.height}"
            )
        if self.original.kind == ARRAY and shape[3:] not in ([], [self.original.channels]):
            raise ValueError(f"original_shape is {shape}, original_channels {self.original.channels}")

    def video(self, path: Path) -> Path:
        """Return the video of a link in the HDF5 file ``path``.

        Raises:
            DamagedFile: it is missing, was not fetched, or is no regular file.
        """
        video = path.parent / self.stream.file
        require_fetched(video)
        if not video.is_file():
            raise DamagedFile(f"{path} refers to {video}, which is not there", hint=MISSING)
        return video

    def whole_video(self, path: Path) -> Path:
        """Return the video, with the number and size of the old pictures.

        Raises:
            DamagedFile: it is not there or damaged, or holds another number of frames, or of another size.
        """
        video, stream = self.video(path), self.stream
        frames, (height, width) = frame_count(video), frame_size(video)
        if frames != stream.frames:
            raise DamagedFile(f"{video} holds {frames} frames, {path} had {stream.frames} pictures", hint=AGAIN)
        if (height, width) != (stream.height, stream.width):
            raise DamagedFile(
                f"{video}: frame 0 is {width}x{height}, the pictures were {stream.width}x{stream.height}",
                hint=AGAIN,
            )
        return video


def write_link(group: h5py.Group, name: str, link: Link) -> h5py.Dataset:
    """Put a link under ``name`` and return its dataset.

    Args:
        group: of the new file.
        name: in the group.
        link: to be written.
    """
    dataset = group.create_dataset(name, data=link.stream.file, dtype=h5py.string_dtype("utf-8"), track_times=False)
    dataset.attrs[f"{OURS}schema"] = LINK_SCHEMA
    for key, value in asdict(link.stream).items():
        dataset.attrs[f"{OURS}{key}"] = value
    for key, value in asdict(link.original).items():
        dataset.attrs[f"{OURS}original_{key}"] = json.dumps(value)
    if link.lengths:
        dataset.attrs[f"{OURS}lengths"] = json.dumps([asdict(place) for place in link.lengths])
    return dataset


def read_link(dataset: h5py.Dataset) -> Link | None:
    """Return the link that a dataset is; None where it is none.

    Raises:
        DamagedFile: it is one, of another version or not whole.
    """
    found = dataset.attrs.get(f"{OURS}schema")
    if found is None:
        return None
    what = f"{dataset.file.filename}:{dataset.name}"
    if found != LINK_SCHEMA:
        raise DamagedFile(f"{what} is a link {found!r}, expected {LINK_SCHEMA!r}", hint="update vcage")
    try:
        attributes = {name.removeprefix(OURS): value for name, value in dataset.attrs.items() if name.startswith(OURS)}
        stream = {field.name: _plain(attributes[field.name]) for field in dataclasses.fields(Stream)}
        original = {one.name: json.loads(attributes[f"original_{one.name}"]) for one in dataclasses.fields(Original)}
        lengths = tuple(LengthsPlace(**place) for place in json.loads(attributes.get("lengths", "[]")))
        return Link(Stream(**stream), Original(**original), lengths)
    except (KeyError, ValueError, TypeError) as error:
        raise DamagedFile(f"{what} is not a whole link to a video: {_first(error)}", hint=AGAIN) from error


def _first(error: Exception) -> str:
    """Return one line for an error: of pydantic, record, field and message of the first."""
    if not isinstance(error, ValidationError):
        return str(error)
    first = error.errors()[0]
    return f"{'.'.join([error.title, *map(str, first['loc'])])}: {first['msg']}"


def require_own_videos(scalars: Iterable[h5py.Dataset]) -> None:
    """Check that each link of a file names a video of its own.

    Args:
        scalars: all scalar datasets of the file.

    Raises:
        DamagedFile: a link is not whole, its text and its attribute name different videos, it describes the pictures
            of another camera, or two links name one video.
    """
    owners: dict[str, str] = {}
    for dataset in scalars:
        link = read_link(dataset)
        if link is None:
            continue
        what, video = f"{dataset.file.filename}:{dataset.name}", link.stream.file
        text = dataset.asstr(errors="replace")[()] if h5py.check_string_dtype(dataset.dtype) else dataset[()]
        if text != video:
            raise DamagedFile(f"{what} refers to {text}, its attribute {OURS}file to {video}", hint=RESTORE)
        if _camera_names(dataset.name) != _camera_names(link.stream.key) and not _is_same(dataset, link.stream.key):
            raise DamagedFile(f"{what} is the link of {link.stream.key}", hint=RESTORE)
        if video in owners:
            raise DamagedFile(f"{what} refers to {video}, and so does {owners[video]}", hint=RESTORE)
        owners[video] = dataset.name


def _camera_names(key: str) -> list[str]:
    """Return the end of a key, which tells cameras apart; the rest may change when demonstrations are moved."""
    return key.split("/")[-2:]


def _is_same(dataset: h5py.Dataset, key: str) -> bool:
    """True if ``key`` is another name of a dataset."""
    other = dataset.file.get(key)
    return isinstance(other, h5py.Dataset) and address(other) == address(dataset)


def find_links(part: h5py.Group) -> dict[str, Link]:
    """Return all links of a file, or of a group of it: key in the file → link.

    Raises:
        DamagedFile: see :func:`read_link`.
    """
    links = ((one.name.lstrip("/"), read_link(one)) for one in datasets_in(part).values())
    return {key: link for key, link in links if link is not None}


def _plain(value: Any) -> Any:
    """Return a value from HDF5 as a Python value."""
    return value.item() if isinstance(value, np.generic) else value
