"""Tables one after the other in numbered Parquet files, and rows read back from many files in batches."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from numpy.typing import NDArray

from vcage.base.errors import DamagedFile

COMPRESSION = "snappy"

ROWS_AT_ONCE = 16384

MEND = "the data set is damaged or not complete: fetch or export it again"


class ParquetSeries:
    """Writes tables of one schema, one row group each; a new file is begun when one is full.

    Args:
        pattern: path with the fields ``chunk_index`` and ``file_index``.
        per_chunk: files in a folder.
        full: size in bytes from which a file takes no more.
        first: number of the first file, counted over all chunks.
    """

    def __init__(self, pattern: str, per_chunk: int, full: int, first: int = 0):
        self._pattern, self._per_chunk, self._full = pattern, per_chunk, full
        self._number = first
        self._writer: pq.ParquetWriter | None = None

    def place(self) -> dict[str, int]:
        """``chunk_index`` and ``file_index`` of the file that takes the next table; a full one is closed."""
        if self._writer is not None and self._path.stat().st_size >= self._full:
            self.close()
            self._number += 1
        return numbered(self._number, self._per_chunk)

    def write(self, table: pa.Table) -> None:
        """Add a table to the file of :meth:`place`."""
        self.place()
        if self._writer is None:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            self._writer = pq.ParquetWriter(self._path, table.schema, compression=COMPRESSION)
        self._writer.write_table(table)

    def close(self) -> None:
        """Make the file that is open readable."""
        if self._writer is not None:
            self._writer.close()
            self._writer = None

    @property
    def _path(self) -> Path:
        return Path(self._pattern.format(**numbered(self._number, self._per_chunk)))


def numbered(number: int, per_chunk: int) -> dict[str, int]:
    """The fields ``chunk_index`` and ``file_index`` of the file of that number."""
    return {"chunk_index": number // per_chunk, "file_index": number % per_chunk}


def column_names(path: Path) -> list[str]:
    """The columns of a table, without reading it.

    Raises:
        DamagedFile: it cannot be read.
    """
    try:
        return pq.read_schema(path).names
    except (OSError, pa.ArrowException) as error:
        raise DamagedFile(f"{path} cannot be read: {error}", hint=MEND) from error


def read_table(path: Path, columns: Sequence[str] | None = None, rows: pc.Expression | None = None) -> pa.Table:
    """A table, or some of its columns and rows.

    Raises:
        DamagedFile: it cannot be read, or lacks a column.
    """
    try:
        table = pq.read_table(path, columns=columns, filters=rows)
    except (OSError, pa.ArrowException) as error:
        raise DamagedFile(f"{path} cannot be read: {error}", hint=MEND) from error
    missing = set(columns or ()) - set(table.column_names)
    if missing:
        raise DamagedFile(f"{path} lacks the columns {sorted(missing)}", hint=MEND)
    return table


def read_batches(paths: Iterable[Path], columns: Sequence[str]) -> Iterator[dict[str, NDArray[Any]]]:
    """The rows of all files, :data:`ROWS_AT_ONCE` at most: name → (n, D), of numbers or of lists of D numbers.

    Raises:
        DamagedFile: a file cannot be read.
    """
    for path in paths:
        try:
            with pq.ParquetFile(path) as file:
                for batch in file.iter_batches(ROWS_AT_ONCE, columns=list(columns)):
                    yield {name: _rows(batch.column(name)) for name in columns}
        except (OSError, KeyError, pa.ArrowException) as error:
            raise DamagedFile(f"{path} cannot be read: {error}", hint=MEND) from error


def _rows(column: pa.Array) -> NDArray[Any]:
    values = column.flatten() if pa.types.is_nested(column.type) else column
    return values.to_numpy(zero_copy_only=False).reshape(len(column), -1)
