"""Files of ranges that a plan names: a campaign keeps copies, which every machine sees and no later edit changes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from vcage.base.errors import InputFileError
from vcage.base.files import write_bytes
from vcage.campaigns.plan import Plan

FOLDER = "looks"


def with_own_looks(plan: Plan, root: Path) -> Plan:
    """Return a plan that names the copies in the folder of its campaign in place of files elsewhere.

    Args:
        plan: as it was read.
        root: the folder.

    Raises:
        InputFileError: a file is not what it was when the campaign began.
    """
    own = {look: root / FOLDER / Path(look).name for look in plan.looks if Path(look).is_absolute()}
    for look, copy in own.items():
        if copy.exists() and Path(look).read_bytes() != copy.read_bytes():
            raise InputFileError(
                f"{look} is not what it was when the campaign in {root} began: {copy} differs",
                hint="restore it, give the file another name to add it, or give another --out",
            )
    keys = plan.model_dump(by_alias=True) | {"looks": tuple(str(own.get(look, look)) for look in plan.looks)}
    return Plan.model_validate(keys) if own else plan


def keys_of(plan: Plan, root: Path) -> dict[str, Any]:
    """Return the keys of a plan as the folder of its campaign holds it: files in it by their paths from there."""
    keys = plan.model_dump(mode="json", by_alias=True, exclude_defaults=True)
    near = {"looks": [look.removeprefix(f"{root}/") for look in plan.looks]}
    return keys | near if "looks" in keys else keys


def keep_looks(plan: Plan, root: Path) -> None:
    """Copy the files that a plan names into the folder of its campaign, where they are missing.

    Raises:
        OutputFolderError, DiskFull: it cannot be written.
    """
    for look in plan.looks:
        if Path(look).is_absolute() and not (copy := root / FOLDER / Path(look).name).exists():
            write_bytes(copy, Path(look).read_bytes())
