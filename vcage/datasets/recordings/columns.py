"""Numbers of a recording over time: commands to the robot, and its state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import h5py
import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import DamagedFile
from vcage.datasets.hdf5_contents import datasets_in, require_numbers_fit

ACT_ARM = 7
"""Numbers of an arm in ACT's commands: six joints, then the gripper."""


@dataclass(frozen=True)
class Columns:
    """Numbers over time.

    Args:
        values: (T, D).
        names: of the D numbers; empty if unknown.
        notes: for the user, on how the numbers were understood.
        sources: keys of the datasets that they were read from, from the root of their file.
    """

    values: NDArray[np.float64]
    names: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    sources: tuple[str, ...] = ()

    def numbered(self, prefix: str) -> tuple[str, ...]:
        """Return ``prefix_0``… for the D numbers."""
        return tuple(f"{prefix}_{column}" for column in range(self.values.shape[1]))

    def all_names(self) -> list[str]:
        """Return names of the D numbers; ``joint_0``… if unknown."""
        return list(self.names if len(self.names) == self.values.shape[1] else self.numbered("joint"))

    @property
    def grippers(self) -> tuple[int, ...]:
        """Columns that open and close a gripper, by their names or by ACT's order."""
        named = tuple(column for column, name in enumerate(self.names) if "gripper" in name)
        return named or act_grippers(self.values.shape[1])


def act_grippers(numbers: int) -> tuple[int, ...]:
    """Return the columns of grippers in commands of arms with six joints and a gripper each; none for other sizes."""
    return tuple(range(ACT_ARM - 1, numbers, ACT_ARM)) if numbers % ACT_ARM == 0 else ()


def numbers_of(part: h5py.Group, key: str, names: tuple[str, ...] = ()) -> Columns | None:
    """Return the numbers of a dataset, or of all in a group; None where there is none.

    Args:
        part: of a file.
        key: of the dataset or the group in it.
        names: of the columns of the dataset.

    Raises:
        DamagedFile: it holds no row of numbers for each point in time.
    """
    found = part.get(key)
    if not isinstance(found, h5py.Dataset):
        return columns(found)
    if not _are_numbers(found):
        raise DamagedFile(
            f"{found.file.filename}:{found.name} is {found.shape} {found.dtype}, no row of numbers for each picture",
            hint="leave the episode out, or fix it",
        )
    return Columns(_rows(found), names, sources=(found.name.lstrip("/"),))


def columns(group: h5py.Group | None, wanted: Sequence[str] | None = None) -> Columns | None:
    """Return the numbers of several datasets of a group side by side, named after them; None where there is none.

    Args:
        group: the group, if it is there.
        wanted: names of the datasets; None takes all below the group, in natural order of their names.

    Raises:
        DamagedFile: they are not of one length.
    """
    if group is None:
        return None
    every = datasets_in(group) if wanted is None else {name: group.get(name) for name in wanted}
    found = {key: one for key, one in every.items() if _are_numbers(one)}
    parts = {key: _rows(dataset) for key, dataset in found.items()}
    names: list[str] = []
    for key, values in parts.items():
        if len(values) != (first := len(next(iter(parts.values())))):
            raise DamagedFile(
                f"{group.file.filename}:{group.name}/{key} has {len(values)} rows, those before it {first}",
                hint="frames are missing; leave the episode out",
            )
        name, width = key.replace("/", "_"), values.shape[1]
        names += [name] if width == 1 else [f"{name}_{column}" for column in range(width)]
    sources = tuple(dataset.name.lstrip("/") for dataset in found.values())
    return Columns(np.concatenate([*parts.values()], axis=1), tuple(names), sources=sources) if parts else None


def _are_numbers(one: object) -> bool:
    """True for a dataset with a number, or a row of numbers, for each point in time."""
    return isinstance(one, h5py.Dataset) and one.dtype.kind in "fiu" and one.ndim in (1, 2)


def _rows(dataset: h5py.Dataset) -> NDArray[np.float64]:
    """Return (T, D) numbers, D = 1 where there is one for each point in time.

    Raises:
        DamagedFile: T is 0.
    """
    if len(dataset) == 0:
        raise DamagedFile(f"{dataset.file.filename}:{dataset.name} holds no frame", hint="leave the episode out")
    require_numbers_fit(dataset)
    return dataset[()].reshape(len(dataset), -1).astype(np.float64)
