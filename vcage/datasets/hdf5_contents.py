"""Require that an HDF5 file of others holds its own data alone.

HDF5 can take data from elsewhere in several ways: external storage of a dataset, virtual datasets, external links, and
links of kinds that programs define. A file that uses one is refused, so that none brings the content of other files
into what is exported. Soft links are followed: they stay in the file.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field

import h5py
from h5py import h5d, h5l, h5o, h5r, h5t  # pyrefly: ignore[missing-module-attribute]  the stubs lack h5o

from vcage.base.errors import DamagedFile, OversizedFile
from vcage.base.folders import natural_key
from vcage.datasets.hdf5_limits import LIMITS, Hdf5Limits

OWN = "."
"""How a virtual dataset names the file that it lies in."""

COPY = "copy the data into the file itself (h5repack, or h5py), or leave it out"


def address(one: h5py.HLObject) -> int:
    """Return the identity of an object in a file, under any name."""
    return int(h5o.get_info(one.id).addr)


def encoded_name(owner: h5py.HLObject, name: str | bytes) -> bytes:
    """Return a name in a group, or of an attribute, encoded for HDF5.

    Raises:
        DamagedFile: it is not UTF-8, and so cannot be written into records.
    """
    try:
        if isinstance(name, str):  # bytes are what h5py cannot decode
            return name.encode()
    except UnicodeEncodeError:
        pass
    raise DamagedFile(
        f"{owner.file.filename}:{owner.name} holds the name {name!r}, which is not UTF-8",
        hint="rename it, or leave the file out",
    )


def require_utf8_text(owner: h5py.HLObject, name: str, value: object) -> None:
    """Raise DamagedFile where an attribute is text that is not UTF-8; other values pass."""
    try:
        if isinstance(value, str):
            value.encode()
    except UnicodeEncodeError as error:
        raise DamagedFile(
            f"{owner.file.filename}:{owner.name}: the attribute {name} is not UTF-8", hint="write it again as UTF-8"
        ) from error


# --- nothing from elsewhere ----------------------------------------------------------------------------


@dataclass
class _Survey:
    """A walk through all groups of a file. Soft links are followed last, after external links are ruled out."""

    file: h5py.File
    limits: Hdf5Limits
    links: int = 0
    soft: list[str] = field(default_factory=list)
    virtual: list[h5py.Dataset] = field(default_factory=list)
    scalars: list[h5py.Dataset] = field(default_factory=list)

    def run(self) -> None:
        seen = {address(self.file)}
        waiting: list[tuple[h5py.Group, int]] = [(self.file, 1)]
        while waiting:
            group, depth = waiting.pop()
            self._count(group, depth)
            for one in self._objects(group):
                if address(one) in seen:
                    continue
                seen.add(address(one))
                if isinstance(one, h5py.Group):
                    waiting.append((one, depth + 1))
                elif isinstance(one, h5py.Dataset):
                    self._look_at(one)
        for path in self.soft:
            self._require_target(path)
        for dataset in self.virtual:
            self._require_own_sources(dataset)

    def _count(self, group: h5py.Group, depth: int) -> None:
        self.links += len(group)
        if self.links > self.limits.max_links or depth > self.limits.max_depth:
            most = f"{self.limits.max_links:,} names, and {self.limits.max_depth} groups in one another"
            raise OversizedFile(
                f"{self.file.filename}:{group.name}: the file holds too many groups; at most {most}, are read",
                hint="split the file, or leave it out",
            )

    def _objects(self, group: h5py.Group) -> Iterator[h5py.HLObject]:
        """Yield the objects of a group that are no links."""
        for name in group:
            kind = group.id.links.get_info(encoded_name(group, name)).type
            path = f"{group.name.rstrip('/')}/{name}"
            if kind == h5l.TYPE_HARD:
                yield group[name]
            elif kind == h5l.TYPE_SOFT:
                self.soft.append(path)
            elif kind == h5l.TYPE_EXTERNAL:
                link = group.get(name, getlink=True)
                raise self._refused(path, f"is an external link to {link.path} of the file {link.filename}")
            else:
                raise self._refused(path, f"is a link of the user-defined kind {kind}")

    def _look_at(self, dataset: h5py.Dataset) -> None:
        properties = dataset.id.get_create_plist()
        if properties.get_external_count():
            name = properties.get_external(0)[0].decode(errors="backslashreplace")
            raise self._refused(dataset.name, f"has external storage: its data lie in the file {name}")
        if properties.get_layout() == h5d.VIRTUAL:
            self.virtual.append(dataset)
        if dataset.shape == ():
            self.scalars.append(dataset)
        kind = dataset.id.get_type()
        if kind.get_class() == h5t.REFERENCE and not (kind.equal(h5t.STD_REF_OBJ) or kind.equal(h5t.STD_REF_DSETREG)):
            raise self._refused(dataset.name, "holds references that may lead to other files")

    def _require_target(self, path: str) -> None:
        try:
            h5o.open(self.file.id, path.encode())
        except (KeyError, RuntimeError) as error:
            round_about = "too many links" in str(error)
            target = self.file.get(path, getlink=True).path
            why = "which leads back to itself" if round_about else "where the file has nothing"
            raise DamagedFile(
                f"{self.file.filename}:{path} is a soft link to {target}, {why}",
                hint="delete the link, or leave the file out",
            ) from error

    def _require_own_sources(self, dataset: h5py.Dataset) -> None:
        for source in dataset.virtual_sources():
            if source.file_name != OWN:
                raise self._refused(
                    dataset.name, f"is a virtual dataset: it takes {source.dset_name} from the file {source.file_name}"
                )
            found = self.file.get(source.dset_name)
            if not isinstance(found, h5py.Dataset) or found.is_virtual:
                raise self._refused(
                    dataset.name, f"is a virtual dataset of {source.dset_name}, which is no stored dataset of the file"
                )

    def _refused(self, path: str, why: str) -> DamagedFile:
        return DamagedFile(f"{self.file.filename}:{path} {why}", hint=COPY)


def require_own_contents(file: h5py.File, limits: Hdf5Limits = LIMITS) -> list[h5py.Dataset]:
    """Require that an open file holds all of its data itself.

    Returns:
        Its scalar datasets, each once; links to videos are among them.

    Raises:
        DamagedFile: a link or a dataset leads to another file, or a soft link to nothing; names it.
        OversizedFile: there are too many groups.
    """
    survey = _Survey(file, limits)
    survey.run()
    return survey.scalars


def require_not_virtual(file: h5py.File, keys: Collection[str]) -> None:
    """Require that no virtual dataset takes data from the datasets ``keys``, which are to be replaced.

    Raises:
        DamagedFile: one does; names both.
    """
    replaced = {address(file[key]) for key in keys}
    survey = _Survey(file, LIMITS)
    survey.run()
    for dataset in survey.virtual:
        for source in dataset.virtual_sources():
            if address(file[source.dset_name]) in replaced:
                raise DamagedFile(
                    f"{file.filename}:{dataset.name} is a virtual dataset of the pictures {source.dset_name}, which "
                    "are to be replaced by a video",
                    hint=COPY,
                )


# --- content of a file ---------------------------------------------------------------------------------


def walk(part: h5py.Group, limits: Hdf5Limits = LIMITS) -> Iterator[tuple[str, h5py.HLObject]]:
    """Yield all objects of a group, under every name, soft links followed, in natural order.

    Args:
        part: a group of a file that :func:`require_own_contents` checked.
        limits: on the number of names.

    Yields:
        Path from ``part`` on, and the object.

    Raises:
        OversizedFile: it has too many names.
    """
    waiting = [("", part, frozenset({address(part)}))]
    count = 0
    while waiting:
        prefix, group, around = waiting.pop()
        deeper = []
        for name in sorted(group, key=natural_key):
            count += 1
            if count > limits.max_links:
                raise OversizedFile(
                    f"{part.file.filename}:{part.name} has more than {limits.max_links:,} names, soft links followed",
                    hint="delete links, or leave the file out",
                )
            one = group[name]
            yield f"{prefix}{name}", one
            if isinstance(one, h5py.Group) and (place := address(one)) not in around:
                deeper.append((f"{prefix}{name}/", one, around | {place}))
        waiting += reversed(deeper)


def datasets_in(part: h5py.Group, pattern: str = ".*") -> dict[str, h5py.Dataset]:
    """Return the datasets below a group whose paths from there match, in natural order of the paths, each once.

    A dataset that has several such names is listed under one, of which no part is a soft link if there is one.

    Args:
        part: a group.
        pattern: of the whole path.
    """
    found: dict[int, tuple[bool, str, h5py.Dataset]] = {}
    for key, one in walk(part):
        if isinstance(one, h5py.Dataset) and re.fullmatch(pattern, key):
            place, soft = address(one), _by_soft_link(part, key)
            if place not in found or (found[place][0] and not soft):
                found[place] = soft, key, _by_hard_link(one) if soft else one
    return {key: one for _, key, one in sorted(found.values(), key=lambda entry: natural_key(entry[1]))}


def _by_soft_link(part: h5py.Group, key: str) -> bool:
    names = key.split("/")
    paths = ("/".join(names[: end + 1]) for end in range(len(names)))
    return any(isinstance(part.get(path, getlink=True), h5py.SoftLink) for path in paths)


def _by_hard_link(dataset: h5py.Dataset) -> h5py.Dataset:
    """Return a dataset under a name without soft links."""
    return dataset.file[h5r.get_name(dataset.ref, dataset.id)]
