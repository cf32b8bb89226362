"""One file of a Python package, downloaded with pip as the machine configured it, and never installed.

The SHA-256 of the file is pinned (pip's hash-checking mode), so every index gives the same file. pip runs the
``setup.py`` of a source archive to learn its name, but only after it has checked the hash.
"""

from __future__ import annotations

import importlib.util
import shlex
import sys
from pathlib import Path

from vcage.base.errors import FetchFailed, MissingDependency
from vcage.setup.commands import run


def download(requirement: str, sha256: str, folder: Path) -> Path:
    """Download the wheel or the source archive of a version into an existing, empty folder.

    Args:
        requirement: name and version, such as ``robosuite==1.5.2``.
        sha256: hash of the file.
        folder: for the file.

    Returns:
        The file.

    Raises:
        FetchFailed: the index does not answer, does not hold the version, or holds another file.
        MissingDependency: this environment has no pip.
    """
    if importlib.util.find_spec("pip") is None:
        command = shlex.join(["uv", "pip", "install", "--python", sys.executable, "pip"])
        raise MissingDependency(f"this environment has no pip to download {requirement} with", command=command)
    pinned, packages = folder / "requirements.txt", folder / "packages"
    pinned.write_text(f"{requirement} --hash=sha256:{sha256}\n")
    options = ["--no-deps", "--no-cache-dir", "--disable-pip-version-check", "--quiet", "--dest", str(packages)]
    run(
        [sys.executable, "-m", "pip", "download", *options, "--require-hashes", "--requirement", str(pinned)],
        tool="pip",
        hint="check the package index that pip uses, then run the same command again",
    )
    found = list(packages.iterdir())
    if len(found) != 1:
        raise FetchFailed(f"pip downloaded {len(found)} files for {requirement}; expected one")
    return found[0]
