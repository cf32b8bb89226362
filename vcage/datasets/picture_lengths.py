"""Lengths of encoded pictures that files state beside them, updated when the pictures change.

ACT++ pads all JPEGs of an episode to one length and stores their lengths: ``/compress_len``, a row for each camera.
Its readers cut a picture there. Files made after its example have such numbers under other names, transposed, as
attributes, or as offsets, so they are found by their values.
"""

from __future__ import annotations

import logging
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Annotated, Any, Literal

import h5py
import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, ConfigDict
from pydantic.dataclasses import dataclass

from vcage.base.errors import DamagedFile, OversizedFile
from vcage.datasets.hdf5_contents import datasets_in, require_numbers_fit
from vcage.datasets.stored_pictures import ARRAY, FIXED, PADDED, encoded_bytes, picture_kind

logger = logging.getLogger(__name__)

AGAIN = "compress the recording again"

SIZE_WORDS = {
    *("bytes", "largest", "len", "length", "lengths", "longest", "nbytes"),
    *("offset", "offsets", "padded", "padding", "size", "sizes"),
}
"""Words in names of sizes; a single number counts only under such a name."""

FORMS: dict[str, Callable[[NDArray[np.int64], int], NDArray[np.int64]]] = {
    "lengths": lambda lengths, _: lengths,
    "ends": lambda lengths, _: np.cumsum(lengths),
    "starts": lambda lengths, _: np.cumsum(lengths) - lengths,
    "bounds": lambda lengths, _: np.concatenate([[0], np.cumsum(lengths)]),
    "width": lambda _, width: np.array(width),
    "longest": lambda lengths, _: lengths.max(),
    "total": lambda lengths, _: lengths.sum(),
}
"""Forms of the lengths (T,) of pictures, and of the bytes of each with padding: offsets with and without the 0 before
them, and single numbers."""


def _known_form(form: str) -> str:
    if form not in FORMS:
        raise ValueError(f"{form!r} is no form of lengths")
    return form


STRICT = ConfigDict(strict=True)


@dataclass(frozen=True, config=STRICT)
class LengthsPlace:
    """A place in a file with the lengths in bytes of a dataset's encoded pictures.

    Args:
        key: of a dataset of numbers; of any object where ``attribute`` is given.
        axis: of the pictures.
        index: on the other axis; None where there is none.
        attribute: its name; None for the numbers of a dataset.
        form: one of :data:`FORMS`.

    Raises:
        ValueError: it cannot be one.
    """

    key: str
    axis: Literal[0, 1] = 0
    index: int | None = None
    attribute: str | None = None
    form: Annotated[str, AfterValidator(_known_form)] = "lengths"

    @property
    def label(self) -> str:
        """Name in messages."""
        return self.key if self.attribute is None else f"{self.key}@{self.attribute}"

    def part(self, values: NDArray) -> tuple[int | slice, ...]:
        """Return the index of the pictures' part in the values of the dataset or attribute."""
        if self.index is None:
            return (Ellipsis,)  # type: ignore[return-value]
        return (slice(None), self.index) if self.axis == 0 else (self.index, slice(None))


def picture_lengths(dataset: h5py.Dataset, count: int | None = None) -> NDArray[np.int64]:
    """Return (T,) bytes of each picture of a dataset, or of the first few, without padding; of arrays, all pixels."""
    count = len(dataset) if count is None else count
    if picture_kind(dataset) == ARRAY:
        return np.full(count, int(np.prod(dataset.shape[1:])) * dataset.dtype.itemsize)
    return np.array([len(encoded_bytes(dataset, index).rstrip(b"\0")) for index in range(count)])


def padded_width(dataset: h5py.Dataset) -> int:
    """Return the bytes of a dataset for each picture, padding included; of lists of bytes, of the longest."""
    kind = picture_kind(dataset)
    if kind == PADDED:
        return dataset.shape[1]
    return dataset.dtype.itemsize if kind == FIXED else int(picture_lengths(dataset).max())


def find_lengths(file: h5py.File, keys: Collection[str]) -> dict[str, list[LengthsPlace]]:
    """Return key of a dataset of encoded pictures → places of their lengths in the file, where there are any.

    Args:
        file: open.
        keys: of datasets of pictures.
    """
    pictures = {key: file[key] for key in sorted(keys) if picture_kind(file[key]) != ARRAY}
    candidates = _candidates(file, {len(dataset) for dataset in pictures.values()}) if pictures else []
    found: dict[str, list[LengthsPlace]] = {}
    taken: set[LengthsPlace] = set()  # identical pictures have identical rows
    for key, dataset in pictures.items():
        first = picture_lengths(dataset, 1)[0]
        noted = _attributes(file, key, len(dataset))
        likely = [(place, values) for place, values in [*candidates, *noted] if not values.ndim or first in values]
        lengths = picture_lengths(dataset) if likely else np.zeros(0, int)  # all pictures are read for it
        for place, values in likely:
            places = _places(place, values, lengths, padded_width(dataset))
            free = next((one for one in places if one not in taken or values.ndim == 0), None)
            if free is not None:
                taken.add(free)
                found.setdefault(key, []).append(free)
    return found


def unknown_sizes(file: h5py.File, keys: Collection[str]) -> list[str]:
    """Return names of values like sizes of encoded pictures, in no known form, so that they stay unchanged.

    Args:
        file: open.
        keys: of datasets of pictures.
    """
    known = {place.label for places in find_lengths(file, keys).values() for place in places}
    encoded = [key for key in keys if picture_kind(file[key]) != ARRAY]
    return sorted(
        label
        for key in encoded
        for label, value in _named_like_sizes(file, key)
        if _may_tell(value, len(file[key])) and label not in {*known, key}
    )


def _named_like_sizes(file: h5py.File, key: str) -> Iterator[tuple[str, Any]]:
    """Yield label and value of attributes of pictures and of the groups around them, and of datasets beside them."""
    for name in around(key):
        for attribute, value in file[name].attrs.items():
            if words_of(attribute) & SIZE_WORDS:
                yield f"{name}@{attribute}", value
    for place in {"", key.rpartition("/")[0]}:
        near = file[place or "/"]
        for name in near:
            if words_of(name) & SIZE_WORDS:
                yield f"{place}/{name}".lstrip("/"), near[name]


def _may_tell(value: Any, count: int) -> bool:
    """True for numbers in the shape of sizes of ``count`` pictures, other than their number itself."""
    if not isinstance(value, (h5py.Dataset, np.ndarray, np.generic)) or not _is_number(value):
        return False
    if value.shape == ():
        return abs(float(np.asarray(value)) - count) > 1
    return value.shape in ((count,), (count + 1,))


def words_of(name: str) -> set[str]:
    """Return the words of a name, in lower case."""
    return set(re.findall(r"[a-z]+[0-9]*", name.lower()))


def _is_number(values: h5py.Dataset | np.ndarray | np.generic) -> bool:
    return values.dtype.kind in "iuf" and values.dtype != np.uint8


def _candidates(file: h5py.File, counts: set[int]) -> list[tuple[LengthsPlace, NDArray]]:
    """Return datasets with a number for each picture of one camera or of several, and single numbers named after sizes.

    Too large ones are left out.
    """
    found = []
    for key, dataset in datasets_in(file).items():
        if not _is_number(dataset) or dataset.shape is None or dataset.ndim > 2:
            continue
        fits = bool(counts & set(dataset.shape)) or (dataset.ndim == 1 and len(dataset) - 1 in counts)
        if fits or (dataset.shape == () and words_of(key.rpartition("/")[2]) & SIZE_WORDS):
            with suppress(OversizedFile):
                require_numbers_fit(dataset)
                found.append((LengthsPlace(dataset.name.lstrip("/")), np.asarray(dataset[()])))
    return found


def _attributes(file: h5py.File, key: str, count: int) -> list[tuple[LengthsPlace, NDArray]]:
    """Return the same of the attributes of pictures, and of the groups around them."""
    found = []
    for name in around(key):
        for attribute, value in file[name].attrs.items():
            if not isinstance(value, (np.ndarray, np.generic)) or not _is_number(value):
                continue
            single = value.shape == () and words_of(attribute) & SIZE_WORDS
            if single or value.shape in ((count,), (count + 1,)):
                found.append((LengthsPlace(name, attribute=attribute), np.asarray(value)))
    return found


def _places(place: LengthsPlace, values: NDArray, lengths: NDArray[np.int64], width: int) -> list[LengthsPlace]:
    """Return the places, with form and index, at which values are the lengths."""
    if values.ndim < 2:
        forms = [form for form, of in FORMS.items() if np.array_equal(of(lengths, width), values)]
        return [replace(place, form=form) for form in forms[:1]]
    return [
        replace(place, axis=axis, index=index)
        for axis in (1, 0)
        if values.shape[axis] == len(lengths)
        for index in range(values.shape[1 - axis])
        if np.array_equal(np.take(values, index, 1 - axis), lengths)
    ]


def update_lengths(file: h5py.File, places: Mapping[str, Iterable[LengthsPlace]]) -> None:
    """Write the lengths of a file's present pictures to their places.

    Args:
        file: open for writing.
        places: key of a dataset of pictures → places of its lengths. A single number for several datasets becomes the
            largest of theirs.

    Raises:
        DamagedFile: a place is not there, or holds no lengths.
    """
    values: dict[LengthsPlace, NDArray] = {}
    for key, own in places.items():
        for place in own:
            lengths, dataset = picture_lengths(file[key]), file[key]
            width = int(lengths[0]) if picture_kind(dataset) == ARRAY else padded_width(dataset)
            new = np.asarray(FORMS[place.form](lengths, width))
            values[place] = np.maximum(values[place], new) if place in values and not new.ndim else new
            logger.info("%s holds the lengths of the new pictures of %s", place.label, key)
    for place, new in values.items():
        _write_values(file, place, new)


def _write_values(file: h5py.File, place: LengthsPlace, new: NDArray) -> None:
    """Write values in the old type, or in a wider one where they do not fit: PNG is longer than JPEG."""
    owner = file.get(place.key)
    old = owner if place.attribute is None or owner is None else owner.attrs.get(place.attribute)
    values = np.asarray(old[()] if isinstance(old, h5py.Dataset) else old)
    if values.dtype.kind not in "iuf" or not _holds_lengths(values, place, new):
        raise DamagedFile(f"{file.filename}:{place.label} does not hold lengths of pictures", hint=AGAIN)
    part = place.part(values)
    wide = values.astype(np.int64 if values.dtype.kind in "iu" else np.float64)
    wide[part] = new
    with np.errstate(all="ignore"):
        same = wide.astype(values.dtype)
    result = same if np.array_equal(same, wide) else wide
    if place.attribute is not None:
        owner.attrs.create(place.attribute, result, dtype=result.dtype)
    elif result.dtype == values.dtype:
        owner[...] = result
    else:
        attributes = dict(owner.attrs)
        del file[place.key]
        file.create_dataset(place.key, data=result, track_times=False).attrs.update(attributes)


def _holds_lengths(values: NDArray, place: LengthsPlace, new: NDArray) -> bool:
    """True if a place holds as many whole numbers, none below 0, as its link says."""
    if values.ndim != new.ndim + (place.index is not None):
        return False
    if place.index is not None and not 0 <= place.index < values.shape[1 - place.axis]:
        return False
    found = values[place.part(values)]
    return found.shape == new.shape and bool((np.isfinite(found) & (found >= 0) & (found == np.rint(found))).all())


def around(key: str) -> list[str]:
    """Return names of a dataset and of the groups around it, from the root on."""
    parts = key.split("/")
    return ["/", *("/".join(parts[: end + 1]) for end in range(len(parts)))]
