"""Labels of success and failure, as every layout writes them."""

from __future__ import annotations

from typing import Any

import h5py
import numpy as np

from vcage.base.errors import DamagedFile
from vcage.datasets.hdf5_contents import require_numbers_fit

SUCCESS, FAIL = "success", "fail"
"""Names of the labels, as attributes, datasets and fields of JSON."""

TRUE = ("true", "1", "1.0", "yes", "success", "succeeded")
FALSE = ("false", "0", "0.0", "-0.0", "no", "failure", "failed")
"""Spellings of a label, in lower case."""


class UnclearLabel(DamagedFile):
    """A label says neither true nor false; ``details["note"]`` says so without naming the file."""


def label_of(value: Any, where: str, name: str = SUCCESS) -> bool | None:
    """Read a label: true or false, 0 or 1, the same as text, or an array or list of them, whose last value counts.

    Args:
        value: from JSON, HDF5 or a table.
        where: its file and field, for the message.
        name: its field alone, for the note.

    Returns:
        None where it says nothing: null, or an empty list.

    Raises:
        UnclearLabel: it is anything else.
    """
    plain = value.tolist() if isinstance(value, np.ndarray | np.generic) else value
    while isinstance(plain, list | tuple) and plain:
        plain = plain[-1]
    if plain is None or isinstance(plain, list | tuple | h5py.Empty):
        return None
    if isinstance(plain, bytes):
        plain = plain.decode("utf-8", "replace")
    text = str(plain).strip().lower() if isinstance(plain, bool | int | float | str) else ""
    if text in TRUE or text in FALSE:
        return text in TRUE
    unclear = f"is {plain!r}, which says neither true nor false"
    raise UnclearLabel(
        f"{where} {unclear}",
        hint="write true or false there, or remove it if nobody recorded it",
        details={"note": f"{name} {unclear}"},
    )


def stored_label(part: h5py.Group, name: str) -> bool | None:
    """Read a label of a recording's part of an open file: an attribute, else a dataset, whose last value counts.

    Raises:
        UnclearLabel: it says neither true nor false.
    """
    where = f"{part.file.filename}:{part.name.rstrip('/')}/{name}"
    stated = label_of(part.attrs.get(name), where, name)
    labels = part.get(name)
    if stated is not None or not isinstance(labels, h5py.Dataset):
        return stated
    require_numbers_fit(labels)
    return label_of(labels[()], where, name)


def stated_failure(part: h5py.Group, labelled: bool = True) -> str | None:
    """Return why a recording says of itself that it failed; None where it says nothing of the kind.

    Args:
        part: of an open file.
        labelled: its label of success counts, too, not only that of failure.

    Raises:
        UnclearLabel: a label says neither true nor false.
    """
    if stored_label(part, FAIL):
        return f"its {FAIL} is true"
    return f"its {SUCCESS} is false" if labelled and stored_label(part, SUCCESS) is False else None
