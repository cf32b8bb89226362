"""Numbers in HDF5 files: a row for each point in time, from one dataset or from several side by side."""

from __future__ import annotations

from collections.abc import Sequence

import h5py
import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import DamagedFile
from vcage.datasets.recordings.recording import Columns


def table(part: h5py.Group, key: str, names: tuple[str, ...] = ()) -> Columns | None:
    """The numbers of a dataset, or of all in a group; None where there is none.

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
            hint="leave the episode out, or mend it",
        )
    return Columns(_rows(found), names)


def columns(group: h5py.Group | None, wanted: Sequence[str] | None = None) -> Columns | None:
    """The numbers of several datasets of a group side by side, named after them; None where there is none.

    Args:
        group: the group, if it is there.
        wanted: names of the datasets; None takes all below the group, by name.

    Raises:
        DamagedFile: they are not of one length.
    """
    if group is None:
        return None
    keys: list[str] = []
    group.visititems(lambda key, item: keys.append(key) if isinstance(item, h5py.Dataset) else None)
    parts: list[NDArray[np.float64]] = []
    names: list[str] = []
    for key in sorted(keys) if wanted is None else [key for key in wanted if key in keys]:
        if not _are_numbers(group[key]):
            continue
        values = _rows(group[key])
        if parts and len(values) != len(parts[0]):
            raise DamagedFile(
                f"{group.file.filename}:{group.name}/{key} has {len(values)} rows, those before it {len(parts[0])}",
                hint="frames are missing; leave the episode out",
            )
        parts.append(values)
        width = values.shape[1]
        names += [key.replace("/", "_")] if width == 1 else [f"{key.replace('/', '_')}_{i}" for i in range(width)]
    return Columns(np.concatenate(parts, axis=1), tuple(names)) if parts else None


def _are_numbers(dataset: h5py.Dataset) -> bool:
    """Whether it holds a number or a row of numbers for each point in time."""
    return dataset.dtype.kind in "fiu" and dataset.ndim in (1, 2)


def _rows(dataset: h5py.Dataset) -> NDArray[np.float64]:
    """(T, D) numbers, D = 1 where there is one for each point in time.

    Raises:
        DamagedFile: T is 0.
    """
    if len(dataset) == 0:
        raise DamagedFile(f"{dataset.file.filename}:{dataset.name} holds no frame", hint="leave the episode out")
    return dataset[()].reshape(len(dataset), -1).astype(np.float64)
