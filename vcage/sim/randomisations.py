"""Files of ranges by name, ``assets/randomisation/<name>.yml``, or by path."""

from __future__ import annotations

from pathlib import Path

from vcage.base.errors import InputFileError
from vcage.schema.randomisation import Randomisation
from vcage.sim.robots import available, load_document, read_yaml

FOLDER = "randomisation"
"""Of the assets, ours and the user's."""


def load_randomisation(name: str) -> Randomisation:
    """The ranges called ``name``, or those of a file where it is a path.

    Raises:
        UnknownName: there are none; lists those there are.
        InputFileError: there is no such file, or it is not what it should be.
    """
    if not _is_path(name):
        return load_document(Randomisation, "randomisation", FOLDER, name)
    if not Path(name).is_file():
        raise InputFileError(f"{name}: there is no such file", hint=f"or take one of {', '.join(available(FOLDER))}")
    return read_yaml(Randomisation, Path(name))


def named(text: str) -> str:
    """A name as it is, the path of a file from the root: what was said in one folder is read in any."""
    if not text.strip():
        raise ValueError("the ranges have no name")
    return str(Path(text).resolve()) if _is_path(text) else text


def _is_path(name: str) -> bool:
    return Path(name).suffix in (".yml", ".yaml") or "/" in name
