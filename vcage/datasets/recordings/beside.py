"""JSON files that a simulator writes beside its HDF5: read within bounds, and not through links."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any

from vcage.base.errors import DamagedFile, OversizedFile
from vcage.base.placeholders import require_fetched
from vcage.base.reading import read_json


def read_beside(path: Path, max_bytes: int = 64 << 20) -> Any:
    """Return the content of a JSON file beside a recording; None where there is none, or a link in its place.

    Raises:
        DamagedFile: it was not fetched, is no regular file, or is no JSON.
        OversizedFile: it is too large.
        InputFileError: it may not be read.
    """
    if path.is_symlink() or not path.exists():
        return None
    require_fetched(path)
    stat = path.stat()
    if stat.st_size > max_bytes:
        raise OversizedFile(
            f"{path} has {stat.st_size:,} bytes; at most {max_bytes:,} are read", hint="leave its recordings out"
        )
    try:
        return _cached_content(path, stat.st_size, stat.st_mtime_ns)
    except DamagedFile as error:
        hint = "mend the file, or remove it and give with options what it says"
        raise DamagedFile(error.message, hint=hint, details=error.details) from error


@lru_cache(maxsize=8)
def _cached_content(path: Path, _size: int, _changed: int) -> Any:
    """Return the content of a file that describes many recordings, each of which asks for it."""
    return read_json(path, nan=True)
