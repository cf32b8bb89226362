"""Paths of the files of a LeRobot data set: always in its own folder, whatever its description says.

Links in the folder are followed to its own files, to the store of the tool that fetched it (the cache of Hugging
Face, git-annex), and from a file of the format to another of that kind, as where videos lie on another disk. A link
that leads elsewhere is refused: a foreign data set could name any file by it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from vcage.base.errors import DamagedFile
from vcage.base.folders import files_below, is_hidden
from vcage.base.placeholders import require_fetched
from vcage.datasets.lerobot.parquet import FETCH_AGAIN

INFO = Path("meta/info.json")

FIELD = re.compile(r"\{(\w+)(?::([^{}]{1,4}))?\}")
"""A field of a pattern of paths, and its format, as in ``{episode_index:06d}``."""

SUFFIXES = (".parquet", ".mp4", ".png", ".jpg", ".jpeg")
DESCRIPTIONS = (
    *("info.json", "stats.json", "modality.json", "episodes.jsonl", "episodes_stats.jsonl"),
    *("tasks.jsonl", "subtasks.jsonl", "picture_levels.json"),
)
"""Suffixes and names of the format's own files; links may lead to files of the same outside the data set."""

OF_THE_REPOSITORY = Path(".gitattributes")
"""The one hidden file that is a data set's own: it says how the hub stores the others."""


def placed(root: Path, field: str, pattern: Any, **names: int | str) -> Path:
    """Return the path of a data set's file by a pattern of its description.

    Args:
        root: folder of the data set.
        field: name of the pattern there, for messages.
        pattern: with fields in braces.
        names: value of each field.

    Raises:
        DamagedFile: the pattern leads out of the folder, or has fields that are not known; names file and field.
    """
    where = f"{root / INFO}: {field}"
    return own_file(root, inside(_filled(pattern, where, names), where), where)


def _filled(pattern: Any, where: str, names: Mapping[str, int | str]) -> str:
    """Return a pattern with values in place of its fields, which are integers or texts and nothing else."""
    if not isinstance(pattern, str):
        raise DamagedFile(f"{where} is {pattern!r}, not a pattern of paths", hint=FETCH_AGAIN)
    try:
        text = FIELD.sub(lambda match: format(names[match[1]], match[2] or ""), pattern)
    except (KeyError, ValueError, TypeError) as error:
        raise DamagedFile(f"{where} is {pattern!r}, which cannot be filled in: {error}", hint=FETCH_AGAIN) from error
    if "{" in text or "}" in text:
        raise DamagedFile(f"{where} is {pattern!r}, which has a field that is not known", hint=FETCH_AGAIN)
    return text


def inside(path: str, where: str) -> Path:
    """Return a path that stays in its data set.

    Args:
        path: relative to the data set.
        where: file and field that name it, for the message.

    Raises:
        DamagedFile: it does not.
    """
    found = Path(path)
    if found.is_absolute() or ".." in found.parts or "\0" in path or not found.parts:
        raise DamagedFile(f"{where} names the path {path!r}, which is not inside the data set", hint=FETCH_AGAIN)
    return found


def own_file(root: Path, file: Path, where: str = "") -> Path:
    """Return the whole path of a file of a data set, which need not exist.

    Args:
        root: folder of the data set.
        file: relative to it.
        where: file and field that name it, for the message.

    Raises:
        DamagedFile: a link leads out of the data set.
    """
    path, home = root / file, root.resolve()
    try:
        real = path.resolve()
    except (OSError, RuntimeError) as error:  # a link to itself
        raise DamagedFile(f"{path} cannot be followed: {error}", hint="fix the link, or remove it") from error
    alike = real.suffix == file.suffix and (file.suffix in SUFFIXES or real.name == file.name in DESCRIPTIONS)
    if alike or any(real.is_relative_to(folder) for folder in (home, *_stores(home))):
        return path
    raise DamagedFile(
        f"{path}{f', which {where} names,' * bool(where)} is a link to {real}, outside the data set",
        hint="put the file itself there, or remove the link",
    )


def _stores(home: Path) -> list[Path]:
    """Return the stores of download tools, to which a data set's files are links."""
    around = (home, *home.parents)
    return [folder.parent / "blobs" for folder in around if folder.name == "snapshots"] + [
        folder / ".git/annex/objects" for folder in around
    ]


def own_files(root: Path, below: Path = Path()) -> list[Path]:
    """Return all files of a data set, or of a folder of it, relative to it in natural order, without hidden ones.

    Raises:
        DamagedFile: a link leads out of the data set or to nothing, or a file was not fetched.
    """
    if not (root / below).is_dir():
        return []
    files = [path.relative_to(root) for path in files_below(root / below, repeated=True)]
    if below == Path() and (root / OF_THE_REPOSITORY).is_file():
        files.append(OF_THE_REPOSITORY)
    for file in files:
        require_fetched(own_file(root, file))
    return files


def is_own(file: Path) -> bool:
    """True if no part of a path is a hidden name."""
    return not any(map(is_hidden, file.parts))
