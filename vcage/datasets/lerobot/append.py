"""A finished LeRobot data set that is added to: what it says of itself, and its files beside the new ones."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Collection
from pathlib import Path
from typing import Any

from vcage.base.errors import DamagedFile, UsageError
from vcage.datasets.lerobot.features import other_columns
from vcage.datasets.lerobot.info import INFO, data_set_info
from vcage.datasets.parquet_files import MEND

NEW_SET = "write a new data set, or convert this one with lerobot's own tools first"


def read_info(root: Path, expected: dict[str, Any]) -> dict[str, Any]:
    """``meta/info.json`` of a data set that can be added to.

    Args:
        root: folder of the data set.
        expected: entries of ``info.json``, such as ``codebase_version``, that may only be missing or the same.

    Raises:
        DamagedFile: it lacks what any data set has.
        UsageError: it is laid out in another way than new episodes would be; names the difference.
    """
    info = data_set_info(root)
    for name in ("total_episodes", "total_frames"):
        if not (isinstance(info.get(name), int) and info[name] >= 0):
            raise DamagedFile(f"{root / INFO} does not count its {name.removeprefix('total_')}", hint=MEND)
    if info["total_episodes"] == 0:
        raise UsageError(f"{root} holds no episode yet", hint="write a new data set in its place")
    if strange := other_columns(info["features"]):
        raise UsageError(
            f"{root} cannot be added to: its frames have {', '.join(strange)}, which new episodes do not tell",
            hint=NEW_SET,
        )
    for name, value in {**expected, "splits": {"train": f"0:{info['total_episodes']}"}}.items():
        if info.get(name) not in (None, value):
            raise UsageError(
                f"{root} cannot be added to: its {name} is {json.dumps(info.get(name))}, not {json.dumps(value)}",
                hint=NEW_SET,
                details={"what": name, "found": info.get(name), "expected": value},
            )
    return info


def link_files(source: Path, target: Path, but: Collection[Path]) -> None:
    """Give all files of a folder a second place in another one, without copying them where the disk allows it.

    Args:
        source: the folder; it is left as it is.
        target: the other folder.
        but: what is left out, relative to ``source``. Whatever is written to later belongs here, as a linked file
            would change in both places.
    """
    for file in sorted(source.rglob("*")):
        inside = file.relative_to(source)
        if inside in but or not file.is_file():
            continue
        (target / inside).parent.mkdir(parents=True, exist_ok=True)
        try:
            os.link(file.resolve(), target / inside)
        except OSError:  # another disk, or one that knows no links
            shutil.copy2(file, target / inside)
