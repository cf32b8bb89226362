"""Writers of LeRobot data sets, one episode after the other, new or added to."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

from vcage.base.errors import OutputFolderError, UnknownName, UsageError
from vcage.base.files import atomic_folder
from vcage.base.folders import is_empty_folder
from vcage.base.leftovers import recover
from vcage.datasets.lerobot.meta import INFO
from vcage.datasets.lerobot.v3 import WriterV30, WriterV31
from vcage.datasets.lerobot.v21 import WriterV21
from vcage.datasets.lerobot.writer import LeRobotWriter

FORMATS: dict[str, type[LeRobotWriter]] = {
    "lerobot-v2.1": WriterV21,
    "lerobot-v3.0": WriterV30,
    "lerobot-v3.1": WriterV31,
}


@contextmanager
def open_writer(
    version: str, out: Path, encodings: Mapping[str, Mapping[str, Any]] | None = None, *, append: bool = False
) -> Iterator[LeRobotWriter]:
    """Open a writer of episodes; the data set appears when the block ends, whole or not at all.

    Memory is that of one episode, for any number of them; a v3.0 set is read again at the end for its quantiles.

    Args:
        version: one of :data:`FORMATS`.
        out: folder of the data set; an old one is replaced.
        encodings: camera → facts about its encoding for ``info.json`` beyond those of the video, such as
            ``{"video.crf": 18}``; ``{"video.pix_fmt": None}`` leaves open a fact that differs between its videos.
        append: add to the data set at ``out``. Its files stay as they are (hard links where the disk knows them, else
            copies), new ones come beside them, and numbers of episodes, frames, tasks and sub-tasks go on. A data set
            that lerobot wrote can be added to where its features agree; one without ``subtask_index``, or without the
            columns of language, stays without.

    Example:
        >>> with open_writer("lerobot-v3.0", out) as writer:
        ...     for episode in episodes:
        ...         writer.add(episode)

    Raises:
        UnknownName: there is no such version.
        UsageError: no episode was added; or with ``append``, there is no data set, or it is of another layout.
        OutputFolderError: ``out`` holds something else than a data set, or cannot be written.
        DamagedFile: with ``append``, a file of the data set is missing or damaged.
    """
    if version not in FORMATS:
        raise UnknownName("LeRobot format", version, FORMATS)
    out = Path(out)
    recover(out)
    there = (out / INFO).is_file()
    if append and not there:
        raise UsageError(f"{out} holds no LeRobot data set to add to", hint="check the path, or write a new data set")
    if out.exists() and not there and not is_empty_folder(out):
        raise OutputFolderError(f"{out} is in the way: it is not a LeRobot data set", hint="give another folder")
    with atomic_folder(out) as folder, closing(FORMATS[version](folder, encodings or {})) as writer:
        if append:
            writer.resume(out)
        yield writer
        writer.finish()
