"""Debian packages from the mirrors that the machine is configured for, downloaded and unpacked without root."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterable
from pathlib import Path

from vcage.base.errors import MissingDependency
from vcage.setup import apt_sources
from vcage.setup.commands import run

TOOLS = ("apt-get", "dpkg-deb")


class AptMirror:
    """The machine's mirrors, with separate package lists in a scratch folder.

    Args:
        work: an existing, empty folder; packages are downloaded into its sub-folder ``packages``.
        root: where apt's configuration lies.

    Raises:
        MissingDependency: the machine has no apt.
        ConfigurationError: no source of this machine's release is configured.
    """

    def __init__(self, work: Path, root: Path = apt_sources.APT):
        missing = [tool for tool in TOOLS if shutil.which(tool) is None]
        if missing:
            raise MissingDependency(
                f"no {', '.join(missing)} here", hint="this needs Debian, Ubuntu, or another system with apt"
            )
        self._options = apt_sources.private_options(work, root)
        self._packages = work / "packages"
        self._packages.mkdir()
        # A missing suite (a release without backports) matters only where a package is not found.
        command = ["apt-get", *self._options, "update", "-q"]
        self._complaint = subprocess.run(command, capture_output=True, text=True).stderr

    def download(self, names: Iterable[str]) -> list[Path]:
        """Download packages; returns their .deb files in the order of the names.

        Raises:
            FetchFailed: the mirrors do not answer or do not hold one of them.
        """
        before = set(self._packages.glob("*.deb"))
        command = ["apt-get", *self._options, "download", "-q", *sorted(names)]
        run(command, cwd=self._packages, context=self._complaint)
        return sorted(set(self._packages.glob("*.deb")) - before)


def unpack_deb(package: Path, folder: Path) -> None:
    """Unpack a .deb file's content into a folder.

    Raises:
        FetchFailed: the file is damaged.
    """
    run(["dpkg-deb", "-x", str(package), str(folder)])


def field_of(package: Path, name: str) -> str:
    """Return a field of a .deb file's description, such as ``Version``; empty where it has none.

    Raises:
        FetchFailed: the file is damaged.
    """
    return run(["dpkg-deb", "-f", str(package), name]).strip()
