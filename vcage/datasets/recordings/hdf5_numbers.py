"""Numbers of HDF5 recordings: a row for each point in time, from one dataset or from several side by side."""

from __future__ import annotations

from collections.abc import Sequence

import h5py
import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import DamagedFile
from vcage.datasets.hdf5_contents import datasets_in
from vcage.datasets.hdf5_limits import require_numbers_fit
from vcage.datasets.recordings.columns import Columns


def numbers_of(part: h5py.Group, key: str, names: tuple[str, ...] = ()) -> Columns | None:
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
    return Columns(_rows(found), names, sources=(found.name.lstrip("/"),))


def columns(group: h5py.Group | None, wanted: Sequence[str] | None = None) -> Columns | None:
    """The numbers of several datasets of a group side by side, named after them; None where there is none.

    Args:
        group: the group, if it is there.
        wanted: names of the datasets; None takes all below the group, in natural order of their names.

    Raises:
        DamagedFile: they are not of one length.
    """
    if group is None:
        return None
    found = _wanted_in(group, wanted)
    parts: list[NDArray[np.float64]] = []
    names: list[str] = []
    sources: list[str] = []
    for key, dataset in found.items():
        if not _are_numbers(dataset):
            continue
        values = _rows(dataset)
        if parts and len(values) != len(parts[0]):
            raise DamagedFile(
                f"{group.file.filename}:{group.name}/{key} has {len(values)} rows, those before it {len(parts[0])}",
                hint="frames are missing; leave the episode out",
            )
        parts.append(values)
        sources.append(dataset.name.lstrip("/"))
        width = values.shape[1]
        names += [key.replace("/", "_")] if width == 1 else [f"{key.replace('/', '_')}_{i}" for i in range(width)]
    return Columns(np.concatenate(parts, axis=1), tuple(names), sources=tuple(sources)) if parts else None


def _wanted_in(group: h5py.Group, wanted: Sequence[str] | None) -> dict[str, h5py.Dataset]:
    if wanted is None:
        return datasets_in(group)
    return {name: one for name in wanted if isinstance(one := group.get(name), h5py.Dataset)}


def _are_numbers(dataset: h5py.Dataset) -> bool:
    """Check for a number, or a row of numbers, for each point in time."""
    return dataset.dtype.kind in "fiu" and dataset.ndim in (1, 2)


def _rows(dataset: h5py.Dataset) -> NDArray[np.float64]:
    """(T, D) numbers, D = 1 where there is one for each point in time.

    Raises:
        DamagedFile: T is 0.
    """
    if len(dataset) == 0:
        raise DamagedFile(f"{dataset.file.filename}:{dataset.name} holds no frame", hint="leave the episode out")
    require_numbers_fit(dataset)
    return dataset[()].reshape(len(dataset), -1).astype(np.float64)
