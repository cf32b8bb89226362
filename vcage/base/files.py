"""Files on disk: atomic writes, content hashes, the project's data files, the cache, and run folders.

Nothing here is ever half-written: a file or folder appears under its name only when it is whole
(written beside it, then renamed), so ``kill -9`` at any moment leaves the previous state.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import os
import posixpath
import shutil
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Any

from vcage.base import reading
from vcage.base.errors import DiskFull, InputFileError, OutputFolderError
from vcage.base.folders import real_path, require_utf8
from vcage.base.inside import path_complaint, require_no_links
from vcage.base.leftovers import PARTIAL, REPLACED, recover

# --- data that travels with the package ----------------------------------------------------------------


def resource(*parts: str) -> Path:
    """A path inside the project's data (``prompts/``, ``assets/``, ``skills/``, pages of ``docs/``).

    In a checkout these are top-level folders; in an installed wheel they lie in ``vcage/_data``.
    """
    package = Path(__file__).resolve().parents[1]
    installed = package / "_data"
    root = installed if installed.is_dir() else package.parent
    return root.joinpath(*parts)


def cache_path(*parts: str) -> Path:
    """A path in the user's cache, made or not: ``$VCAGE_CACHE`` or ``$XDG_CACHE_HOME/vcage``."""
    return _user_folder("VCAGE_CACHE", "XDG_CACHE_HOME", ".cache").joinpath(*parts)


def _user_folder(own: str, shared: str, default: str) -> Path:
    """The folder that our variable names, or the one of ours in that of a shared variable, by default under home."""
    named = os.environ.get(own)
    return Path(named) if named else Path(os.environ.get(shared) or Path.home() / default, "vcage")


def cache_dir(*parts: str) -> Path:
    """A folder of the user's cache (see :func:`cache_path`), made on demand."""
    path = cache_path(*parts)
    make_folder(path, "name a folder that can be written: export VCAGE_CACHE=/another/folder")
    return path


def data_path(*parts: str) -> Path:
    """A path in the user's data folder, existing or not: ``$VCAGE_DATA`` or ``$XDG_DATA_HOME/vcage``.

    Unlike the cache it cannot be made again by itself.
    """
    return _user_folder("VCAGE_DATA", "XDG_DATA_HOME", ".local/share").joinpath(*parts)


def sha256_file(path: Path) -> str:
    """Hex SHA-256 of a file's content."""
    digest = hashlib.sha256()
    with open(path, "rb") as handle:
        while block := handle.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""The disk, the quota or the largest size of a file is reached."""

REFUSED = (errno.EACCES, errno.EPERM, errno.EROFS, errno.ENOTDIR, errno.EISDIR, errno.EEXIST)
"""A path may not be written, or something of another kind is in its place."""

ANOTHER_FOLDER = "give another --out, or make the folder writable"


@contextlib.contextmanager
def writing(path: Path, hint: str = ANOTHER_FOLDER) -> Iterator[None]:
    """Turn the operating system's refusals to write into errors that name the way out."""
    try:
        yield
    except OSError as error:
        if error.errno in NO_ROOM:
            raise DiskFull(
                f"no space left to write {path}", hint="free some space and run the same command again"
            ) from error
        if error.errno in REFUSED:
            raise OutputFolderError(f"cannot write {path}: {error.strerror}", hint=hint) from error
        raise


def make_folder(path: Path, hint: str = ANOTHER_FOLDER) -> None:
    """Make a folder and those above it; where the system makes none (``/proc``), it calls them missing."""
    with writing(path, hint):
        try:
            path.mkdir(parents=True, exist_ok=True)
        except FileNotFoundError as error:
            raise OutputFolderError(f"cannot make the folder {path}: {error.strerror}", hint=hint) from error


@contextlib.contextmanager
def atomic_path(path: Path) -> Iterator[Path]:
    """Yield a path beside ``path`` to write to; it takes the name ``path`` only if the block succeeds."""
    path = Path(path)
    part = path.with_name(f"{path.stem}{PARTIAL}{os.getpid()}{path.suffix}")
    with writing(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            yield part
            with open(part, "rb") as handle:
                os.fsync(handle.fileno())
            os.replace(part, path)
        finally:
            part.unlink(missing_ok=True)


def write_bytes(path: Path, data: bytes) -> Path:
    """Write a whole file atomically."""
    with atomic_path(path) as part:
        part.write_bytes(data)
    return Path(path)


def write_text(path: Path, text: str) -> Path:
    """Write a whole UTF-8 text file atomically."""
    return write_bytes(path, text.encode())


def write_json(path: Path, value: Any) -> Path:
    """Write JSON atomically: two-space indent, keys in the order given, a final newline."""
    return write_text(path, json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False) + "\n")


def read_json(path: Path, *, nan: bool = False) -> Any:
    """Read a JSON file; see :func:`vcage.base.reading.read_json`.

    Raises:
        MissingStage: the file is not there.
        DamagedFile: it is not JSON; names the line.
    """
    return reading.read_json(Path(path), stage_of_file(path), nan=nan)


@contextlib.contextmanager
def atomic_folder(path: Path) -> Iterator[Path]:
    """Yield an empty folder beside ``path`` that replaces ``path`` only if the block succeeds.

    A killed replacement is repaired by :func:`vcage.base.leftovers.recover`, which runs on entry.
    """
    path = Path(path)
    recover(path)
    part = path.with_name(f"{path.name}{PARTIAL}{os.getpid()}")
    old = path.with_name(f"{path.name}{REPLACED}{os.getpid()}")
    with writing(path):
        part.mkdir(parents=True)
        try:
            yield part
            if path.exists():
                os.replace(path, old)
            os.replace(part, path)
        except BaseException:
            if old.exists() and not path.exists():
                os.replace(old, path)
            raise
        finally:
            shutil.rmtree(part, ignore_errors=True)
            shutil.rmtree(old, ignore_errors=True)


def link_or_copy(source: str | Path, target: str | Path) -> None:
    """Give a file that is never written over a second name; copy it where the file system has no links."""
    try:
        os.link(source, target)
    except OSError:
        shutil.copy2(source, target)


def whole(folder: Path) -> bool:
    """True if a folder's name marks no partial work and no folder under replacement."""
    return PARTIAL not in folder.name and REPLACED not in folder.name


# --- run folders ---------------------------------------------------------------------------------------


PRODUCERS = {
    "place": "select_place",
    "inpaint": "inpaint_plan",
    "match": "match",
    "optimize": "optimize",
    "subtasks": "search_subtasks",
    "episodes": "collect",
    "verify": "verify",
    "compress": "compress",
    "export": "export",
}
"""Folder of the run → the stage that writes it, in the order of the chain."""


def stage_of_file(path: Path) -> str:
    """The stage that writes a file, by its folder or the parent folder; empty without one."""
    folder = Path(path).parent
    return PRODUCERS.get(folder.name) or PRODUCERS.get(folder.parent.name, "")


OWN = frozenset(
    (*PRODUCERS, "renders", "exchanges", "ask", "report", "timings", "options", "unfinished", "in-use", "probe")
)
"""Names of our files and folders in a run folder, up to the first dot."""


class RunFolder:
    """The folder of one run: where each stage's files lie (see ``docs/architecture.md``, "The chain").

    Raises :class:`InputFileError` as soon as one of its files is asked for, where anything of it is a link.

    Example:
        >>> RunFolder("runs/blocks").layout  # the optimised scene

    Args:
        root: the folder given as ``--out``; it need not exist yet.
    """

    def __init__(self, root: str | Path):
        self.root = real_path(root)

    def __str__(self) -> str:
        return str(self.root)

    @cached_property
    def _own(self) -> Path:
        """The root, after checking that none of our files in it leads elsewhere."""
        self.require_no_links()
        return self.root

    def require_no_links(self) -> None:
        """Nothing, if all of ours in the folder is folders and regular files; done by itself before a file is named.

        Raises:
            InputFileError: something is a link, or a pipe, socket or device.
        """
        require_no_links(self.root, OWN)

    scene = property(lambda self: self._own / "place" / "scene.json")
    plan = property(lambda self: self._own / "inpaint" / "plan.json")
    matches = property(lambda self: self._own / "match" / "matches.json")
    layout = property(lambda self: self._own / "optimize" / "scene.json")
    subtasks = property(lambda self: self._own / "subtasks" / "subtasks.json")
    episodes = property(lambda self: self._own / "episodes" / "episodes.json")
    verdicts = property(lambda self: self._own / "verify" / "verdicts.json")
    compression = property(lambda self: self._own / "compress" / "compression.json")
    export = property(lambda self: self._own / "export" / "export.json")
    exchanges = property(lambda self: self._own / "exchanges", doc="The folder of what models were asked.")
    questions = property(lambda self: self._own / "ask", doc="The folder of what the agent is asked.")
    documents = property(
        lambda self: (
            *(self.scene, self.plan, self.matches, self.layout, self.subtasks),
            *(self.episodes, self.verdicts, self.compression, self.export),
        ),
        doc="The JSON of each stage, in the order of the chain.",
    )
    report = property(lambda self: self._own / "report.html")
    timings = property(lambda self: self._own / "timings.json")
    options = property(lambda self: self._own / "options.json")
    unfinished = property(lambda self: self._own / "unfinished.json")

    def file(self, name: str, stage: str = "") -> Path:
        """The file that a record names.

        Args:
            name: its path in the run folder, or from a stage's folder.
            stage: name of that folder.

        Raises:
            InputFileError: the path leads out of the run folder, or to what is not a part of a run: only in these is it
                sure that nothing is a link.
        """
        inside = posixpath.normpath(posixpath.join(stage, name)) if stage else name
        complaint = path_complaint(inside)
        if complaint is None and Path(inside).parts[0].partition(".")[0] not in OWN:
            complaint = f"expected a path in a folder of a stage, got {name[:80]!r}"
        if complaint:
            raise InputFileError(f"{self}: {complaint}", hint="correct the record that names it")
        return self._own / inside

    def relative(self, path: Path) -> str:
        """``path`` as written into records: relative to the run folder, with forward slashes."""
        return Path(path).resolve().relative_to(self.root).as_posix()

    def make(self) -> RunFolder:
        """Make the folder and prove that it can be written.

        Raises:
            OutputFolderError: it cannot.
        """
        require_utf8(self.root, OutputFolderError)
        probe = self.root / f"probe{PARTIAL}{os.getpid()}"
        make_folder(self.root)
        with writing(self.root):
            probe.touch()
            probe.unlink(missing_ok=True)  # a process of another machine may have the same number
        return self
