"""The Vulkan driver that SAPIEN draws with: found on the machine, or taken from the user's cache.

Not every driver that ``vulkaninfo`` lists suits SAPIEN (Mesa before 24.3 does not), so a driver counts only
when it has drawn a picture. Drawing one takes seconds, so the decision is stored in the cache and holds as long
as the machine's drivers stay the same.
"""

from __future__ import annotations

import ctypes
import json
import logging
import os
import shutil
import subprocess
import sys
import time
import warnings
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Literal

from vcage.base import files
from vcage.base.commands import vcage_command
from vcage.base.errors import DamagedFile, NoRenderer, OutputFolderError
from vcage.base.hold import one_at_a_time
from vcage.setup import mesa

logger = logging.getLogger(__name__)

ICD_VARIABLE = "VK_ICD_FILENAMES"
ICD_FOLDERS = ("/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/usr/share/vulkan/icd.d")
PROBE_TIMEOUT = 180.0
"""Seconds after which a driver that has not drawn is given up (the first picture takes 6 s of CPU)."""


@dataclass(frozen=True)
class Driver:
    """A Vulkan driver.

    Attributes:
        kind: ``given`` by the user in ``$VK_ICD_FILENAMES``, a ``gpu``'s, the ``system``'s, or from our ``cache``.
        icd: the manifest for ``$VK_ICD_FILENAMES``; None if the Vulkan loader finds it.
        name: the device as the driver calls itself, empty when unknown.
    """

    kind: Literal["given", "gpu", "system", "cache"]
    icd: Path | None
    name: str


@dataclass(frozen=True)
class RenderProbe:
    """Result of a test picture: success, wall time in seconds, the device, or the complaint."""

    ok: bool
    seconds: float
    device: str
    message: str


def ensure_driver() -> Driver:
    """Make this process, and its children, use a working driver; call it before the first render system.

    Cheap once a driver is known. A driver in the user's ``$VK_ICD_FILENAMES`` is used unchanged.

    Raises:
        NoRenderer: no driver draws; the hint names the command that sets one up.
    """
    given = os.environ.get(ICD_VARIABLE)
    if given:
        kind = "cache" if Path(given) == _cached_icd() else "given"
        return Driver(kind, Path(given), "")
    driver = _recall() or _choose()
    if driver.icd is not None:
        os.environ[ICD_VARIABLE] = str(driver.icd)
    return driver


def install_driver() -> Driver:
    """Fetch Mesa's software driver into the user's cache, without root, and choose again among all drivers.

    Raises:
        NoRenderer: it cannot be fetched, or does not draw either.
    """
    files.cache_dir("vulkan")  # the folder of the lock
    with one_at_a_time(_mesa_folder()):
        mesa.install(_mesa_folder())
    return _choose()


def probe(icd: Path | None = None) -> RenderProbe:
    """Draw a small picture in a process of its own.

    Args:
        icd: the manifest of the driver to try; None to follow the environment and the Vulkan loader.
    """
    environment = dict(os.environ)
    if icd is not None:
        environment[ICD_VARIABLE] = str(icd)
    command = [sys.executable, "-m", "vcage.setup.render_probe"]
    start = time.perf_counter()
    try:
        done = subprocess.run(
            command,
            env=environment,
            cwd=Path(__file__).parents[2],  # where this vcage is found
            capture_output=True,
            text=True,
            timeout=PROBE_TIMEOUT,
        )
    except subprocess.TimeoutExpired:
        return RenderProbe(False, PROBE_TIMEOUT, "", f"no picture within {PROBE_TIMEOUT:.0f} s")
    seconds = time.perf_counter() - start
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines() or [f"the process ended with {done.returncode}"]
        return RenderProbe(False, seconds, "", lines[-1])
    result = json.loads(done.stdout.strip().splitlines()[-1])
    complaint = "the picture is blank" if result["blank"] else ""
    return RenderProbe(not complaint, seconds, result["device"], complaint)


def find_gpu() -> str:
    """Return the NVIDIA GPUs as ``nvidia-smi`` lists them, or an empty text."""
    tool = shutil.which("nvidia-smi")
    if tool is None:
        return ""
    done = subprocess.run([tool, "-L"], capture_output=True, text=True)
    return done.stdout.strip() if done.returncode == 0 else ""


def prepare_import() -> None:
    """Make ``import sapien`` work and be quiet; ``vcage.sim`` calls this before anything imports SAPIEN.

    The cache holds libraries that the machine lacks (SAPIEN links to libX11, for one), which the dynamic linker only
    finds when they are loaded by path. They may need each other: load until nothing more loads.
    """
    # SAPIEN warns that it falls back to the Vulkan loader of its own wheel, as intended.
    warnings.filterwarnings("ignore", message="Failed to find system libvulkan")
    waiting = mesa.libraries(_mesa_folder())
    while waiting:
        refused = [library for library in waiting if not _load(library)]
        if len(refused) == len(waiting):
            logger.debug("not loaded: %s", ", ".join(path.name for path in refused))
            return
        waiting = refused


def _load(library: Path) -> bool:
    try:
        ctypes.CDLL(str(library))
    except OSError:
        return False
    return True


# --- the decision, and its record ------------------------------------------------------------------


def _choose() -> Driver:
    """Try every driver in order of preference; choose and remember the first that draws."""
    complaints = []
    for kind, icd in _candidates():
        logger.info("Vulkan: trying the driver of the %s (takes some seconds)", kind)
        result = probe(icd)
        if result.ok:
            driver = Driver(kind, icd, result.device)
            _remember(driver)
            return driver
        complaints.append(f"{kind}: {result.message}")
    raise NoRenderer(
        f"no Vulkan driver draws a picture with SAPIEN ({'; '.join(complaints) or 'none is installed'})",
        command=vcage_command("setup", "vulkan"),
        details={"tried": complaints},
    )


def _candidates() -> list[tuple[Literal["gpu", "system", "cache"], Path | None]]:
    found: list[tuple[Literal["gpu", "system", "cache"], Path | None]] = []
    if find_gpu():
        found.append(("gpu", None))
    elif _system_icds():
        found.append(("system", None))
    if _cached_icd().is_file():
        found.append(("cache", _cached_icd()))
    return found


def _system_icds() -> list[str]:
    return [str(icd) for folder in ICD_FOLDERS for icd in sorted(Path(folder).glob("*.json"))]


def _mesa_folder() -> Path:
    return files.cache_path("vulkan", "mesa")


def _cached_icd() -> Path:
    return _mesa_folder() / mesa.ICD_NAME


def _machine() -> dict[str, object]:
    """Facts that the choice depends on; when they change, the driver is chosen again."""
    return {
        "sapien": metadata.version("sapien"),
        "gpu": Path("/dev/nvidiactl").exists(),
        "system": _system_icds(),
    }


def _decision_file() -> Path:
    return files.cache_path("vulkan", "driver.json")


def _remember(driver: Driver) -> None:
    record = {
        "kind": driver.kind,
        "icd": str(driver.icd) if driver.icd else None,
        "name": driver.name,
        "machine": _machine(),
    }
    try:
        files.write_json(_decision_file(), record)
    except OutputFolderError as error:
        logger.warning("the choice of a Vulkan driver is not stored for next time: %s", error)


def _recall() -> Driver | None:
    """Return the remembered driver, unless the machine has changed since."""
    if not _decision_file().is_file():
        return None
    try:
        record = files.read_json(_decision_file())
        if record["machine"] != _machine():
            return None
        icd = Path(record["icd"]) if record["icd"] else None
        driver = Driver(record["kind"], icd, record["name"])
    except (DamagedFile, KeyError, TypeError) as error:
        logger.warning("choosing a Vulkan driver again: %s names none (%s)", _decision_file(), error)
        return None
    return driver if icd is None or icd.is_file() else None
