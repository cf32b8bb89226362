"""What readers of a LeRobot data set take from its ``meta/info.json``."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from vcage.base.errors import DamagedFile
from vcage.datasets.parquet_files import MEND

INFO = Path("meta/info.json")

VERSIONS = ("v2.1", "v3.0")

NEEDED = ("chunks_size", "fps", "data_path", "features")


def data_set_info(root: Path) -> dict[str, Any]:
    """``meta/info.json`` of a data set of one of the :data:`VERSIONS`, with all that its episodes are read by.

    Raises:
        DamagedFile: it cannot be read, does not say all, or is of another version.
    """
    path = root / INFO
    try:
        info = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise DamagedFile(f"{path} cannot be read: {error}", hint=MEND) from error
    version = info.get("codebase_version") if isinstance(info, dict) else None
    if version is None:
        raise DamagedFile(f"{path} does not say codebase_version", hint=MEND)
    if version not in VERSIONS:
        raise DamagedFile(
            f"{root} is a LeRobot data set of version {version}; {' and '.join(VERSIONS)} are known",
            hint="convert it with lerobot's own converter first",
        )
    _require_described(path, info)
    return info


def _require_described(path: Path, info: Mapping[str, Any]) -> None:
    missing = sorted(name for name in NEEDED if info.get(name) is None)
    if missing:
        raise DamagedFile(f"{path} does not say {', '.join(missing)}", hint=MEND)
    if not (_is_positive(info["fps"]) and _is_positive(info["chunks_size"])):
        raise DamagedFile(f"{path}: fps and chunks_size are not positive numbers", hint=MEND)
    if not isinstance(info["features"], dict):
        raise DamagedFile(f"{path} does not name its features", hint=MEND)
    for name, feature in info["features"].items():
        if not (isinstance(feature, dict) and isinstance(feature.get("dtype"), str) and _is_shape(feature)):
            raise DamagedFile(f"{path} does not say what {name} is", hint=MEND)
        if feature["dtype"] == "video" and not info.get("video_path"):
            raise DamagedFile(f"{path} does not say video_path", hint=MEND)


def _is_positive(number: Any) -> bool:
    return isinstance(number, int | float) and number > 0


def _is_shape(feature: Mapping[str, Any]) -> bool:
    """Whether it has a shape: of pictures two or three numbers, of all others any."""
    shape = feature.get("shape")
    if not (isinstance(shape, list) and all(isinstance(length, int) for length in shape)):
        return False
    return feature["dtype"] not in ("video", "image") or len(shape) in (2, 3)
