"""Pieces of bytes that wait in a file until the longest is known, as datasets of strings of one length need it."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO


class Spool:
    """Pieces in a file, in order.

    Args:
        file: open for reading and writing, empty.
        pieces: taken one at a time.

    Attributes:
        sizes: length of each piece, bytes.
    """

    def __init__(self, file: IO[bytes], pieces: Iterable[bytes]):
        self._file = file
        self.sizes = [file.write(piece) for piece in pieces]

    @property
    def longest(self) -> int:
        """Length of the longest piece, bytes."""
        return max(self.sizes)

    def __len__(self) -> int:
        return len(self.sizes)

    def __iter__(self) -> Iterator[bytes]:
        self._file.seek(0)
        for size in self.sizes:
            yield self._file.read(size)


@contextmanager
def spooled(pieces: Iterable[bytes], folder: Path) -> Iterator[Spool]:
    """All of ``pieces`` in a file without a name in ``folder``, which is gone afterwards."""
    with tempfile.TemporaryFile(dir=folder) as file:
        yield Spool(file, pieces)
