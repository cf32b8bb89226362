"""A Parquet file written again with other columns: row group by row group, so memory is that of one."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterator
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from vcage.base.errors import DamagedFile
from vcage.datasets.parquet_files import COMPRESSION, MEND

Change = Callable[[pa.Table], pa.Table]


def rewrite(source: Path, target: Path, *, without: Collection[str] = (), change: Change = lambda table: table) -> None:
    """Copy a table; row groups, and the values and types of columns that nobody changes, stay as they are.

    Args:
        source: a Parquet file.
        target: the file to write, in a folder that is there.
        without: columns that are left out, and not even read.
        change: what becomes of the rows; also called with an empty table, which tells the types of its columns.

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
    """The different texts in one field of a column of structures; none where it has no such field.

    Raises:
        DamagedFile: the file cannot be read.
    """
    found: set[str] = set()
    with _opened(source) as file:
        if not _has_field(file.schema_arrow, column, field):
            return found
        for table in _row_groups(file, [column], source, [f"{column}.{field}"]):
            texts = pc.unique(pc.struct_field(table[column], field))
            found.update(text for text in texts.to_pylist() if text)
    return found


def _opened(source: Path) -> pq.ParquetFile:
    try:
        return pq.ParquetFile(source)
    except (OSError, pa.ArrowException) as error:
        raise DamagedFile(f"{source} cannot be read: {error}", hint=MEND) from error


def _row_groups(
    file: pq.ParquetFile, names: list[str], source: Path, leaves: list[str] | None = None
) -> Iterator[pa.Table]:
    """The columns ``names`` of each row group, or only those ``leaves`` of them that are named."""
    for number in range(file.num_row_groups):
        try:
            # a name also stands for columns that begin with it and a dot
            yield file.read_row_group(number, columns=leaves or names).select(names)
        except (OSError, pa.ArrowException) as error:
            raise DamagedFile(f"{source} cannot be read: {error}", hint=MEND) from error


def _has_field(schema: pa.Schema, column: str, field: str) -> bool:
    if column not in schema.names:
        return False
    kind = schema.field(column).type
    return pa.types.is_struct(kind) and kind.get_field_index(field) >= 0


def _described(metadata: dict[bytes, bytes] | None, names: Collection[str]) -> dict[bytes, bytes] | None:
    """What ``datasets`` and pandas noted of a table's columns, without those that are gone.

    https://huggingface.co/docs/datasets/about_dataset_features, https://pandas.pydata.org/docs/development/developer.html
    """
    kept = dict(metadata or {})
    for key, forget in ((b"huggingface", _forget_features), (b"pandas", _forget_columns)):
        if key in kept:
            kept[key] = json.dumps(forget(json.loads(kept[key]), names)).encode()
    return kept or None


def _forget_features(noted: dict[str, Any], names: Collection[str]) -> dict[str, Any]:
    features = noted.get("info", {}).get("features")
    if features is None:
        return noted
    kept = {name: feature for name, feature in features.items() if name in names}
    return {**noted, "info": {**noted["info"], "features": kept}}


def _forget_columns(noted: dict[str, Any], names: Collection[str]) -> dict[str, Any]:
    # an index without a name has a column named after its place
    kept = [column for column in noted.get("columns", []) if (column.get("field_name") or column["name"]) in names]
    return {**noted, "columns": kept}
