"""Mesa's software Vulkan driver (lavapipe), unpacked into a folder without root.

It is taken from the package mirrors that the machine itself is configured for: its own release, and the
backports of that release, where Debian 12 has the Mesa that SAPIEN needs. Nothing on the system is changed.
"""

from __future__ import annotations

import json
import logging
import re
import subprocess
from pathlib import Path

from vcage.base import files
from vcage.base.errors import ConfigurationError, FetchFailed, NoRenderer
from vcage.base.leftovers import scratch_folder
from vcage.setup import apt

logger = logging.getLogger(__name__)

ICD_NAME = "lvp_icd.json"
DRIVER_PACKAGE = "mesa-vulkan-drivers"
DRIVER_LIBRARY = "libvulkan_lvp.so"
SAPIEN_NEEDS = ("libx11-6",)
"""Packages whose libraries the wheel of SAPIEN links to and does not contain."""

NEVER_FETCHED = ("libc6", "libvulkan1")
"""The C library cannot be replaced, and SAPIEN has its own Vulkan loader."""

BY_HAND = (
    "check that the mirror answers, or install your distribution's Mesa Vulkan drivers (24.3 or newer, with "
    "lavapipe) and libX11; then set up the driver again"
)
_RELATION = re.compile(
    r"(?:^|\|)\s*(?P<name>[a-z0-9][a-z0-9.+-]+)(?::\w+)?\s*(?:\((?P<operator>[<>=]+)\s*(?P<version>[^)]+)\))?"
)


def install(folder: Path) -> Path:
    """Fetch and unpack the driver and every library it needs that the machine lacks.

    Args:
        folder: appears whole or not at all; an earlier one is replaced.

    Returns:
        The driver's manifest, for ``$VK_ICD_FILENAMES``.

    Raises:
        NoRenderer: the machine has no apt, or its mirrors do not answer or do not hold the driver.
    """
    try:
        with scratch_folder() as work, files.atomic_folder(folder) as part:
            for package in _download(work):
                apt.unpack_deb(package, part)
            _install_driver(part, folder)
    except NoRenderer:
        raise
    except (FetchFailed, ConfigurationError) as error:
        raise NoRenderer(f"cannot fetch a Vulkan driver: {error.message}", hint=BY_HAND) from error
    return folder / ICD_NAME


def _install_driver(part: Path, folder: Path) -> None:
    """Turn the packages unpacked into ``part`` into a driver that will lie in ``folder``."""
    drivers = sorted(part.glob(f"usr/lib/*/{DRIVER_LIBRARY}"))
    if not drivers:
        raise NoRenderer(f"{DRIVER_PACKAGE} of this machine's mirror holds no lavapipe", hint=BY_HAND)
    _drop_other_drivers(part)
    _write_manifest(part, folder / drivers[0].relative_to(part))


def libraries(folder: Path) -> list[Path]:
    """Return the shared libraries fetched with the driver, without the driver; empty where there is none."""
    found = [path for pattern in ("lib/*/*.so.*", "usr/lib/*/*.so.*") for path in sorted(folder.glob(pattern))]
    return [path for path in found if not path.is_symlink()]


def _drop_other_drivers(folder: Path) -> None:
    """Delete the drivers of GPUs, most of the package's bulk."""
    for library in folder.glob("usr/lib/*/libvulkan_*.so"):
        if library.name != DRIVER_LIBRARY:
            library.unlink()


def _write_manifest(folder: Path, library: Path) -> None:
    """Copy the package's manifest with an absolute path, as the Vulkan loader does not search our folder."""
    original = next(iter(sorted(folder.glob("usr/share/vulkan/icd.d/lvp_icd*.json"))))
    manifest = json.loads(original.read_text())
    manifest["ICD"]["library_path"] = str(library)
    files.write_json(folder / ICD_NAME, manifest)


# --- packages ------------------------------------------------------------------------------------------


def _download(work: Path) -> list[Path]:
    """Download the driver's package and, level by level, its dependencies that the machine lacks."""
    logger.info("fetching the software Vulkan driver from this machine's package mirror (about 40 MB)")
    mirror = apt.AptMirror(work)
    wanted = {DRIVER_PACKAGE} | {name for name in SAPIEN_NEEDS if not _satisfied(name, "", "")}
    packages: list[Path] = []
    asked: set[str] = set()
    while wanted:
        fetched = mirror.download(wanted)
        packages += fetched
        asked |= wanted
        wanted = {name for package in fetched for name in _lacking(package)} - asked
    return packages


def _lacking(package: Path) -> set[str]:
    """Return the libraries that a package depends on and the machine lacks, or has in too old a version."""
    depends = apt.field_of(package, "Depends")
    lacking = set()
    for group in filter(None, (part.strip() for part in depends.split(","))):
        relations = [match.groupdict(default="") for match in _RELATION.finditer(group)]
        if not relations or any(_satisfied(**relation) for relation in relations):
            continue
        name = relations[0]["name"]
        if name.startswith(("lib", "zlib")) and name not in NEVER_FETCHED:
            lacking.add(name)
    return lacking


def _satisfied(name: str, operator: str, version: str) -> bool:
    """True if a package is installed, in a version that fulfils ``operator version`` if given."""
    query = ["dpkg-query", "-W", "-f", "${db:Status-Status} ${Version}\\n", name]
    done = subprocess.run(query, capture_output=True, text=True)
    for line in done.stdout.splitlines():
        status, _, installed = line.partition(" ")
        if status != "installed":
            continue
        compare = ["dpkg", "--compare-versions", installed, operator, version]
        if not operator or subprocess.run(compare).returncode == 0:
            return True
    return False
