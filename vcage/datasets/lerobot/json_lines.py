"""Files of JSON objects, one a line, in which LeRobot v2.1 keeps what it says of a data set."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from vcage.base.errors import DamagedFile
from vcage.datasets.parquet_files import MEND


def read_lines(path: Path) -> Iterator[dict[str, Any]]:
    """The objects of a file; only a line feed ends a line, whatever else Unicode breaks lines at.

    Raises:
        DamagedFile: it cannot be read, or a line is no JSON object; names the line.
    """
    try:
        with open(path, encoding="utf-8") as handle:
            for number, line in enumerate(handle, start=1):
                if not line.strip():
                    continue
                row = json.loads(line)
                if not isinstance(row, dict):
                    raise DamagedFile(f"{path} line {number} is no JSON object", hint=MEND)
                yield row
    except (OSError, ValueError) as error:
        raise DamagedFile(f"{path} cannot be read: {error}", hint=MEND) from error
