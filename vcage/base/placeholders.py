"""Placeholders of files: pointers of Git LFS, git-annex and Xet, links without a target, AppleDouble files."""

from __future__ import annotations

import stat
from pathlib import Path

from vcage.base.errors import DamagedFile
from vcage.base.reading import kind_of_file

_LFS = "a Git LFS pointer, not the file itself, which `git lfs pull` fetches"
_ANNEX = "a git-annex pointer, not the file itself, which `git annex get` fetches"

PLACEHOLDERS = {
    b"version https://git-lfs.github.com/spec/": _LFS,
    b"version https://hawser.github.com/spec/": _LFS,
    b"/annex/objects/": _ANNEX,
    b"# xet version ": "a Xet pointer, not the file itself, which `git xet checkout` fetches",
    b"\x00\x05\x16\x07": "an AppleDouble file, in which macOS keeps what belongs to another file",
}
"""First bytes of a file → what it is."""


def require_fetched(path: Path) -> None:
    """Nothing, if a file is there with its own content; a path where nothing is passes too.

    Raises:
        DamagedFile: it is a placeholder, a link to nothing, or no regular file; names it.
    """
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        if path.is_symlink():
            raise _dangling(path) from None
        return
    except (OSError, ValueError) as error:
        raise DamagedFile(f"{path} cannot be read: {error}", hint="check the path") from error
    if not stat.S_ISREG(mode):
        raise DamagedFile(f"{path} is no regular file but {kind_of_file(mode)}", hint="give the file itself")
    try:
        with open(path, "rb") as handle:
            head = handle.read(64)
    except OSError as error:
        raise DamagedFile(f"{path} cannot be read: {error.strerror}", hint="make it readable") from error
    for magic, what in PLACEHOLDERS.items():
        if head.startswith(magic):
            raise DamagedFile(f"{path} is {what}", hint="fetch the file itself, or remove this one")


def _dangling(path: Path) -> DamagedFile:
    target, fetched = str(path.readlink()), ""
    if ".git/annex/" in target:
        fetched = ": `git annex get` fetches it"
    elif "/blobs/" in target:
        fetched = ": `hf download` fetches it"
    return DamagedFile(f"{path} is a link to {target}, which is not there{fetched}", hint="fix the link, or remove it")
