"""One file of a Python package, downloaded with pip as the machine configured it, and never installed or run.

pip builds the metadata of a source archive to learn its name, which would run the package's ``setup.py``. It is told
not to isolate that build, and finds in place of setuptools a module that copies the ``PKG-INFO`` every source archive
holds. See PEP 517 (build backends) and PEP 314 (``PKG-INFO``).
"""

from __future__ import annotations

import importlib.util
import shlex
import sys
from pathlib import Path
from typing import Literal

from vcage.base.errors import FetchFailed, MissingDependency
from vcage.base.leftovers import scratch_folder
from vcage.setup.commands import run

Kind = Literal["wheel", "sdist"]

_BACKEND = '''\
"""Stands in for setuptools: metadata is copied from PKG-INFO, and nothing is run."""

from email.parser import BytesParser
from pathlib import Path
from types import SimpleNamespace


def _no_requirements(config_settings=None):
    return []


def _metadata(metadata_directory, config_settings=None):
    text = Path("PKG-INFO").read_bytes()
    fields = BytesParser().parsebytes(text, headersonly=True)
    folder = Path(metadata_directory) / f"{fields['Name'].replace('-', '_')}-{fields['Version']}.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_bytes(text)
    return folder.name


__legacy__ = SimpleNamespace(
    get_requires_for_build_wheel=_no_requirements, prepare_metadata_for_build_wheel=_metadata
)
get_requires_for_build_wheel = _no_requirements
prepare_metadata_for_build_wheel = _metadata
'''


def download(name: str, version: str, kind: Kind, folder: Path) -> Path:
    """Download the wheel or the source archive of a version into an existing folder.

    Args:
        name: of a package that is pure Python; its source archive is built by setuptools.

    Returns:
        The file.

    Raises:
        FetchFailed: the index does not answer or does not hold it.
        MissingDependency: this environment has no pip.
    """
    wanted = f"{name}=={version}"
    if importlib.util.find_spec("pip") is None:
        command = shlex.join(["uv", "pip", "install", "--python", sys.executable, "pip"])
        raise MissingDependency(f"this environment has no pip to download {name} with", command=command)
    form = {"wheel": ["--only-binary=:all:"], "sdist": ["--no-binary=:all:", "--no-build-isolation", "--use-pep517"]}
    options = ["--no-deps", "--no-cache-dir", "--disable-pip-version-check", "--quiet", "--dest", str(folder)]
    with scratch_folder() as work:
        backend = work / "setuptools"
        backend.mkdir()
        (backend / "__init__.py").touch()
        (backend / "build_meta.py").write_text(_BACKEND)
        run(
            [sys.executable, "-m", "pip", "download", *options, *form[kind], wanted],
            tool="pip",
            environment={"PYTHONPATH": str(work)} if kind == "sdist" else None,
            hint="check the package index that pip uses, then run the same command again",
        )
    suffixes = {"wheel": (".whl",), "sdist": (".tar.gz", ".zip")}[kind]
    found = [path for path in sorted(folder.iterdir()) if path.name.endswith(suffixes)]
    if len(found) != 1:
        raise FetchFailed(f"pip downloaded {len(found)} files for the {kind} of {wanted}; expected one")
    return found[0]
