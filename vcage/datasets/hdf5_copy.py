"""Copy an HDF5 file object by object, with something else in place of some of its datasets.

HDF5 does not free the space of deleted objects, so a smaller file must be rebuilt. Everything else is copied as it
is: data in its chunks and with its filters, attributes in their types, links of every kind, objects with several names.
HDF5 does not carry references from file to file; they are made again.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import h5py
import numpy as np
from h5py import h5a, h5o, h5p, h5r, h5t  # pyrefly: ignore[missing-module-attribute]  the stubs lack h5o

from vcage.datasets.hdf5_contents import address, encoded_name, require_numbers_fit

Replacement = Callable[[h5py.Dataset, h5py.Group, str], None]
"""Called with a dataset of the source, and the group and the name of its replacement."""

SCALE_ATTRIBUTES = ("DIMENSION_LIST", "REFERENCE_LIST")
"""Attributes by which HDF5 ties dimension scales to datasets; they are attached again instead."""


def copy_file(source: h5py.File, target: h5py.File, replacements: Mapping[str, Replacement]) -> None:
    """Copy all of ``source`` into the empty ``target``.

    Args:
        source: open for reading.
        target: open for writing.
        replacements: full name of a dataset → function that writes its replacement, under all names of the dataset.
            References to its elements become empty, and scales of its dimensions are not attached again.
    """
    copied = _Copier(source, target, replacements).run()
    for name in copied:
        _mend_references(source[name], target[name])
        if isinstance(source[name], h5py.Dataset):
            _attach_scales(source[name], target[name])


def copy_attributes(source: h5py.HLObject, target: h5py.HLObject, *, leave: str = "") -> None:
    """Copy attributes in their types, except those with names that begin with ``leave``, if given.

    Args:
        source: with the attributes.
        target: of the copy.
        leave: prefix of the names that are not copied.

    Raises:
        DamagedFile: a name is not UTF-8.
    """
    for name in source.attrs:
        encoded_name(source, name)
        if not (leave and name.startswith(leave)):
            _copy_attribute(source, target, name)


def _copy_attribute(source: h5py.HLObject, target: h5py.HLObject, name: str) -> None:
    old = h5a.open(source.id, name.encode())
    kind = old.get_type()
    new = h5a.create(target.id, name.encode(), kind.copy(), old.get_space())
    if old.shape is None or kind.detect_class(h5t.REFERENCE):
        return
    if old.dtype.hasobject:
        values = np.empty(old.shape, old.dtype)
        old.read(values)
        new.write(values)
    else:
        bits = np.empty(old.shape, f"V{kind.get_size()}")
        old.read(bits, mtype=kind)
        new.write(bits, mtype=kind)


class _Copier:
    """Copies groups, datasets and links; remembers objects by their address, as they may have several names."""

    def __init__(self, source: h5py.File, target: h5py.File, replacements: Mapping[str, Replacement]):
        self._source, self._target = source, target
        self._replacements = {address(source[name]): replacement for name, replacement in replacements.items()}
        self._names: dict[int, str] = {}
        self._replaced: set[str] = set()

    def run(self) -> list[str]:
        """Copy all objects and return a name of each that was not replaced."""
        self._names[address(self._source)] = "/"
        self._group(self._source, self._target)
        return [name for name in self._names.values() if name not in self._replaced]

    def _group(self, source: h5py.Group, target: h5py.Group) -> None:
        copy_attributes(source, target)
        for name in source:
            link = source.get(name, getlink=True)
            if isinstance(link, h5py.HardLink):
                self._object(source, target, name)
            elif isinstance(link, h5py.SoftLink):
                target[name] = h5py.SoftLink(link.path)
            else:
                target[name] = h5py.ExternalLink(link.filename, link.path)

    def _object(self, source: h5py.Group, target: h5py.Group, name: str) -> None:
        one = source[name]
        place = address(one)
        if place in self._names:
            target[name] = self._target[self._names[place]]
            return
        full = f"{source.name.rstrip('/')}/{name}"
        self._names[place] = full
        if place in self._replacements:
            self._replacements[place](one, target, name)
            self._replaced.add(full)
        elif isinstance(one, h5py.Group):
            new = h5py.h5g.create(target.id, name.encode(), gcpl=one.id.get_create_plist())
            self._group(one, h5py.Group(new))
        else:
            h5o.copy(source.id, name.encode(), target.id, name.encode(), h5p.create(h5p.OBJECT_COPY))


# --- references ----------------------------------------------------------------------------------------


def _mend_references(source: h5py.HLObject, target: h5py.HLObject) -> None:
    """Point the references in a copied object's data and attributes at the copies of their targets."""
    for name in source.attrs:
        old = h5a.open(source.id, name.encode())
        if name in SCALE_ATTRIBUTES:
            h5a.delete(target.id, name.encode())
        elif old.shape is not None and old.get_type().detect_class(h5t.REFERENCE):
            values = np.empty(old.shape, old.dtype)
            old.read(values)
            h5a.open(target.id, name.encode()).write(_translated(values, source.file, target.file))
    if not (isinstance(source, h5py.Dataset) and isinstance(target, h5py.Dataset)):
        return
    if source.shape and source.id.get_type().detect_class(h5t.REFERENCE):
        require_numbers_fit(source)
        target[...] = _translated(source[...], source.file, target.file)


def _translated(values: np.ndarray, source: h5py.File, target: h5py.File) -> np.ndarray:
    """Return an array of references, or of records or lists with some, for another file."""
    result = values.copy()
    if values.dtype.names:
        for field in values.dtype.names:
            result[field] = _translated(values[field], source, target)
    elif values.dtype.hasobject:
        for index in np.ndindex(values.shape):
            value = values[index]
            if isinstance(value, np.ndarray):
                result[index] = _translated(value, source, target)
            elif isinstance(value, h5py.Reference):
                result[index] = _reference(value, source, target)
    return result


def _reference(value: h5py.Reference, source: h5py.File, target: h5py.File) -> h5py.Reference:
    name = h5r.get_name(value, source.id) if value else None
    if name is None:
        return type(value)()
    if not isinstance(value, h5py.RegionReference):
        return target[name].ref
    if target[name].shape != source[name].shape:
        return h5py.RegionReference()
    return h5r.create(target.id, name, h5r.DATASET_REGION, h5r.get_region(value, source.id))


def _attach_scales(source: h5py.Dataset, target: h5py.Dataset) -> None:
    for old, new in zip(source.dims, target.dims, strict=True) if source.shape else ():
        for scale in old.values():
            new.attach_scale(target.file[scale.name])
