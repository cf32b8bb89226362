"""JSON files that a simulator writes beside its HDF5: read within bounds, and not through links."""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path
from typing import Any

from vcage.base.errors import DamagedFile

LARGEST_BYTES = 64 << 20


def read_beside(path: Path) -> Any:
    """The content of a JSON file beside a recording; None where there is none, or a link in its place.

    Raises:
        DamagedFile: it is too large, cannot be read, or is no JSON.
    """
    if path.is_symlink() or not path.is_file():
        return None
    hint = "mend the file, or remove it and give with options what it says"
    try:
        stat = path.stat()
        if stat.st_size > LARGEST_BYTES:
            raise DamagedFile(f"{path} is larger than {LARGEST_BYTES >> 20} MiB", hint=hint)
        return _kept_content(path, stat.st_size, stat.st_mtime_ns)
    except (OSError, ValueError, RecursionError) as error:
        raise DamagedFile(f"{path} cannot be read as JSON: {error}", hint=hint) from error


@lru_cache(maxsize=8)
def _kept_content(path: Path, _size: int, _changed: int) -> Any:
    """The content of a file that describes many recordings, each of which asks for it."""
    return json.loads(path.read_text(encoding="utf-8-sig"))
