"""Parquet files of a LeRobot data set: written one after the other, read in batches, rewritten with other columns."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from numpy.typing import NDArray

from vcage.base.errors import DamagedFile, OversizedFile
from vcage.base.placeholders import require_fetched

COMPRESSION = "snappy"

FETCH_AGAIN = "the data set is damaged or not complete: fetch or export it again"


@dataclass(frozen=True)
class ParquetLimits:
    """Limits on the data read at once.

    Args:
        max_rows: in a file.
        max_values: in all columns that are read together; one takes 8 bytes or more.
        max_bytes: of these columns, unpacked.
        batch_rows: in a batch.
    """

    max_rows: int = 100_000_000
    max_values: int = 2**27
    max_bytes: int = 2**31
    batch_rows: int = 16384


LIMITS = ParquetLimits()


@contextmanager
def _damage(path: Path) -> Iterator[None]:
    """Turn pyarrow's errors on a broken file, or one without a column, into :class:`DamagedFile`."""
    require_fetched(path)
    try:
        yield
    except (OSError, KeyError, pa.ArrowException) as error:
        raise DamagedFile(f"{path} cannot be read: {error}", hint=FETCH_AGAIN) from error


class ParquetSeries:
    """Writes tables of one schema, one row group each; begins a new file when one is full.

    Args:
        pattern: path with the fields ``chunk_index`` and ``file_index``.
        per_chunk: files in a folder.
        full_bytes: size from which a file is full.
        first: number of the first file, counted over all chunks.
    """

    def __init__(self, pattern: str, per_chunk: int, full_bytes: float, first: int = 0):
        self._pattern, self._per_chunk, self._full_bytes = pattern, per_chunk, full_bytes
        self._number = first
        self._writer: pq.ParquetWriter | None = None

    def place(self) -> dict[str, int]:
        """Return ``chunk_index`` and ``file_index`` of the file for the next table; a full one is closed."""
        if self._writer is not None and self._path.stat().st_size >= self._full_bytes:
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
    """Return the fields ``chunk_index`` and ``file_index`` of the file of that number."""
    return {"chunk_index": number // per_chunk, "file_index": number % per_chunk}


def column_names(path: Path) -> list[str]:
    """Return the columns of a table, without reading it.

    Raises:
        DamagedFile: it cannot be read.
    """
    with _damage(path):
        return pq.read_schema(path).names


def read_table(path: Path, columns: Sequence[str] | None = None, rows: pc.Expression | None = None) -> pa.Table:
    """Return a table, or some of its columns and rows.

    Args:
        path: of the file.
        columns: their names; None for all.
        rows: a filter; None for all.

    Raises:
        DamagedFile: it cannot be read, or lacks a column.
    """
    with _opened(path) as file:
        _require_modest(path, file.metadata, columns, range(file.num_row_groups), LIMITS)
    with _damage(path):
        table = pq.read_table(path, columns=columns, filters=rows)
    missing = set(columns or ()) - set(table.column_names)
    if missing:
        raise DamagedFile(f"{path} lacks the columns {sorted(missing)}", hint=FETCH_AGAIN)
    return table


def read_batches(paths: Iterable[Path], columns: Sequence[str]) -> Iterator[dict[str, NDArray[Any]]]:
    """Yield the rows of all files, at most :attr:`ParquetLimits.batch_rows` at once: name → (n, D) numbers.

    Raises:
        DamagedFile: a file cannot be read.
    """
    for path in paths:
        with _damage(path), _opened(path) as file:
            for batch in file.iter_batches(LIMITS.batch_rows, columns=list(columns)):
                yield {name: rows_of(batch.column(name)) for name in columns}


def rows_of(column: pa.Array) -> NDArray[Any]:
    """Return a column of numbers, or of lists of D, as (n, D)."""
    values = column.flatten() if pa.types.is_nested(column.type) else column
    return values.to_numpy(zero_copy_only=False).reshape(len(column), -1)


# --- a file written again, row group by row group, so memory is that of one ----------------------------

Change = Callable[[pa.Table], pa.Table]


def rewrite(source: Path, target: Path, *, without: Collection[str] = (), change: Change = lambda table: table) -> None:
    """Copy a table; row groups, and the values and types of unchanged columns, stay as they are.

    Args:
        source: a Parquet file.
        target: the file to write, in an existing folder.
        without: columns to leave out unread.
        change: makes the new rows; also called with an empty table, for the types of its columns.

    Raises:
        DamagedFile: ``source`` cannot be read.
    """
    with _opened(source) as file:
        names = [name for name in file.schema_arrow.names if name not in without]
        changed = change(file.schema_arrow.empty_table().select(names)).schema
        schema = changed.with_metadata(_described(changed.metadata, changed.names))
        with pq.ParquetWriter(target, schema, compression=COMPRESSION) as writer:
            for table in _row_groups(file, names, source):
                rows = change(table).replace_schema_metadata(schema.metadata)
                writer.write_table(rows, row_group_size=max(1, rows.num_rows))


def texts_of(source: Path, column: str, field: str) -> set[str]:
    """Return the different texts in one field of a column of structures; empty where it has no such field.

    Args:
        source: a Parquet file.
        column: of structures.
        field: of these.

    Raises:
        DamagedFile: the file cannot be read.
    """
    found: set[str] = set()
    with _opened(source) as file:
        schema = file.schema_arrow
        kind = schema.field(column).type if column in schema.names else pa.null()
        if not pa.types.is_struct(kind) or kind.get_field_index(field) < 0:
            return found
        for table in _row_groups(file, [column], source, [f"{column}.{field}"]):
            found.update(row[field] for row in table[column].to_pylist() if row and row[field])
    return found


def _opened(source: Path) -> pq.ParquetFile:
    with _damage(source):
        file = pq.ParquetFile(source)
    if file.metadata.num_rows > LIMITS.max_rows:
        raise _oversized(source, f"it declares {file.metadata.num_rows:,} rows; at most {LIMITS.max_rows:,} are read")
    return file


def _require_modest(
    path: Path, described: pq.FileMetaData, columns: Sequence[str] | None, groups: Iterable[int], limits: ParquetLimits
) -> None:
    """Raise OversizedFile where columns of some row groups declare more than is read at once; None for all columns."""
    wanted = None if columns is None else set(columns)
    values = size = 0
    for group in map(described.row_group, groups):
        for column in map(group.column, range(group.num_columns)):
            name = column.path_in_schema
            if wanted is None or name in wanted or name.partition(".")[0] in wanted:
                values += column.num_values
                size += column.total_uncompressed_size
    if values > limits.max_values or size > limits.max_bytes:
        raise _oversized(
            path,
            f"it declares {values:,} values in {size:,} bytes to be read at once; at most {limits.max_values:,} in "
            f"{limits.max_bytes:,} bytes are",
        )


def _oversized(path: Path, why: str) -> OversizedFile:
    return OversizedFile(f"{path} is too large: {why}", hint="write it in smaller files or row groups, or leave it out")


def _row_groups(
    file: pq.ParquetFile, names: list[str], source: Path, leaves: list[str] | None = None
) -> Iterator[pa.Table]:
    """Yield the columns ``names`` of each row group, or only the named ``leaves`` of them."""
    for number in range(file.num_row_groups):
        _require_modest(source, file.metadata, leaves or names, [number], LIMITS)
        with _damage(source):
            # a name also stands for its sub-columns, after a dot
            yield file.read_row_group(number, columns=leaves or names).select(names)


def _described(metadata: dict[bytes, bytes] | None, names: Collection[str]) -> dict[bytes, bytes] | None:
    """Return the notes of ``datasets`` and pandas on a table's columns, without removed columns.

    https://huggingface.co/docs/datasets/about_dataset_features, https://pandas.pydata.org/docs/development/developer.html
    """
    notes = dict(metadata or {})
    for key, forget in ((b"huggingface", _without_features), (b"pandas", _without_columns)):
        if key in notes:
            notes[key] = json.dumps(forget(json.loads(notes[key]), names)).encode()
    return notes or None


def _without_features(noted: dict[str, Any], names: Collection[str]) -> dict[str, Any]:
    features = noted.get("info", {}).get("features")
    if features is None:
        return noted
    left = {name: feature for name, feature in features.items() if name in names}
    return {**noted, "info": {**noted["info"], "features": left}}


def _without_columns(noted: dict[str, Any], names: Collection[str]) -> dict[str, Any]:
    # an index without a name has a column named after its place
    left = [column for column in noted.get("columns", []) if (column.get("field_name") or column["name"]) in names]
    return {**noted, "columns": left}
