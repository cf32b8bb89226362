"""``vcage doctor``: each check covers one thing and knows the one command that fixes it."""

from __future__ import annotations

import dataclasses
import importlib.util
import os
import platform
import shutil
import sys
from collections.abc import Callable
from dataclasses import dataclass
from datetime import date
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING

from vcage.base import files
from vcage.base.commands import pip_command, vcage_command
from vcage.base.errors import ConfigurationError, EndpointFailed, VcageError
from vcage.base.options import Flag
from vcage.cli.arguments import Command
from vcage.cli.output import Result
from vcage.cli.setup import CVVDP, OPENCV, cvvdp_version, opencv_loads

if TYPE_CHECKING:
    from vcage.models.provider import Provider

MIN_FREE_GB = 2.0
"""With less free space a run of a few episodes may not fit."""


@dataclass(frozen=True)
class Finding:
    """The finding of a check.

    Args:
        name: of the thing.
        ok: True if it is there and fit.
        found: its state, in words.
        required: True if nothing works without it.
        mend: the one command that fixes it; empty if nothing needs fixing.
    """

    name: str
    ok: bool
    found: str
    required: bool = True
    mend: str = ""

    def unfit(self, why: str, mend: str) -> Finding:
        """Return the finding of a thing that is there, but not fit."""
        return Finding(self.name, False, f"{self.found}{why}", self.required, mend)


@dataclass(frozen=True, kw_only=True)
class Doctor(Command):
    """Check this machine for vcage, and name for each missing thing the one command that fixes it.

    Draws a real picture with the Vulkan driver, which takes some seconds. Keys are shown by name only; with
    a key, its endpoint is asked if it serves the chosen models, and for how long.

    examples:
      vcage doctor
      vcage doctor --json | tail -n 1
    """

    json: Flag = False
    """no table, only the JSON line"""

    def execute(self) -> Result:
        """Look at everything; the result is a failure when something required is missing."""
        found = [check() for check in CHECKS]
        text = "" if self.json else table(found)
        record = {"checks": [dataclasses.asdict(finding) for finding in found]}
        missing = [finding for finding in found if not finding.ok and finding.required]
        if not missing:
            return Result(summary=record, schema="vcage.doctor/1", text=text)
        error = ConfigurationError(
            f"missing or unfit: {', '.join(finding.name for finding in missing)}",
            command=missing[0].mend,
            details=record,
        )
        return Result(text=text, error=error)


def table(found: list[Finding]) -> str:
    """Return the findings, one a line, each followed by the command that fixes it."""
    width = max(len(finding.name) for finding in found)
    lines = []
    for finding in found:
        mark = "ok" if finding.ok else "MISSING" if finding.required else "-"
        lines.append(f"{mark:<8}{finding.name:<{width}}  {finding.found}")
        if finding.mend:
            lines.append(f"{'':<8}{'':<{width}}  → {finding.mend}")
    return "\n".join(lines)


# --- the checks ---------------------------------------------------------------------------------------------


def python() -> Finding:
    fit = (3, 11) <= sys.version_info[:2] < (3, 13)
    mend = "" if fit else "make the environment with Python 3.11 or 3.12"
    return Finding("Python", fit, f"{platform.python_version()} at {sys.executable}", mend=mend)


def numpy() -> Finding:
    wanted = "numpy>=1.26,<2"
    finding = _package("numpy", wanted)
    if finding.ok and not finding.found.startswith("1."):
        return finding.unfit(", under which mplib crashes", pip_command(wanted))
    return finding


def sapien() -> Finding:
    finding = _package("sapien", "sapien==3.0.3")
    if not finding.ok:
        return finding
    try:
        importlib.import_module("vcage.sim")
        importlib.import_module("sapien")
    except (ImportError, OSError) as error:
        return finding.unfit(f" does not load: {error}", vcage_command("setup", "vulkan", "--force"))
    return finding


def mani_skill() -> Finding:
    return _package("mani_skill", "mani_skill==3.0.1")


def torch() -> Finding:
    return _package("torch", "torch==2.13.0")


def gpu() -> Finding:
    from vcage.setup.vulkan import find_gpu

    return Finding("GPU", True, find_gpu() or "none (not needed; rendering is slower)", required=False)


def vulkan() -> Finding:
    from vcage.setup.vulkan import ICD_VARIABLE, ensure_driver, probe

    try:
        driver = ensure_driver()
    except VcageError as error:
        return Finding("Vulkan", False, error.message, mend=vcage_command("setup", "vulkan"))
    result = probe()
    source = f"{driver.kind} driver {driver.icd or 'found by the loader'}"
    if not result.ok:
        mend = f"unset {ICD_VARIABLE}" if driver.kind == "given" else vcage_command("setup", "vulkan", "--force")
        return Finding("Vulkan", False, f"{source} draws nothing: {result.message}", mend=mend)
    return Finding("Vulkan", True, f"{result.device}, {source}; drew a picture in {result.seconds:.1f} s")


def video() -> Finding:
    finding = _package("av", "av>=18", name="PyAV")
    if not finding.ok:
        return finding
    import av

    encoders = [name for name in ("libx265", "libsvtav1", "libx264") if name in av.codecs_available]
    version = ".".join(map(str, av.library_versions["libavcodec"]))
    finding = Finding("PyAV", True, f"{finding.found}, libavcodec {version}, encoders: {', '.join(encoders) or 'none'}")
    if "libx265" in encoders:
        return finding
    return finding.unfit("; libx265 is needed", pip_command("--force-reinstall", "--no-deps", "av"))


def opencv() -> Finding:
    finding = _package("cv2", OPENCV, name="OpenCV", distribution=OPENCV)
    if finding.ok and not opencv_loads():
        return finding.unfit(" does not load", vcage_command("setup", "opencv"))
    return finding


def cvvdp() -> Finding:
    version = cvvdp_version()
    if version == CVVDP:
        return Finding("cvvdp", True, version)
    found = f"{version} (checked: {CVVDP})" if version else "not installed; compress needs it"
    return Finding("cvvdp", False, found, mend=vcage_command("setup", "cvvdp"))


def keys() -> Finding:
    from vcage.models.keys import closing_command, key_file, open_to_others
    from vcage.models.providers import found_keys

    try:
        names = [f"{provider} in {source}" for provider, source in found_keys().items()]
    except VcageError as error:
        return Finding("keys", False, error.message, required=False, mend=error.hint)
    finding = Finding("keys", True, ", ".join(names) or "none (the offline stand-ins are used)", required=False)
    if open_to_others(key_file()):
        return finding.unfit(f"; other users may read {key_file()}", closing_command(key_file()))
    return finding


def models() -> Finding:
    """Check that the endpoints with a key serve the chosen models, and for how long."""
    from vcage.models.keys import require_key
    from vcage.models.providers import PROVIDERS, found_keys

    try:
        found = [_served(PROVIDERS[name], require_key(PROVIDERS[name])) for name in found_keys()]
    except VcageError as error:
        return Finding("models", False, error.message, required=False, mend=error.hint)
    states, mend = "; ".join(words for words, _ in found), [way for _, ways in found for way in ways]
    return Finding("models", not mend, states or "offline rules", required=False, mend="; ".join(mend))


def ollama() -> Finding:
    """Check the models of the user's own server, and which of them answers."""
    from vcage.models.ollama import OLLAMA

    try:
        found, url = OLLAMA.found(), OLLAMA.url
    except VcageError as error:
        asked_for = not isinstance(error, EndpointFailed) or OLLAMA.url_variable in os.environ
        return Finding("ollama", not asked_for, error.message, required=False, mend=error.hint if asked_for else "")
    listed = f"{', '.join(found.served.models) or 'no model'} at {url}"
    if not found.served.has(found.model):
        state = f"{found.model} is not served; {listed}"
        return Finding("ollama", False, state, required=False, mend=f"ollama pull {found.model}")
    state = f"{listed}; {found.model} answers{'' if found.sees else ', and sees no pictures'}"
    return Finding("ollama", True, state, required=False)


def _served(provider: Provider, key: str) -> tuple[str, list[str]]:
    """Return the state of a provider's models, in words, and the ways to fix it."""
    try:
        served = provider.served(key)
    except VcageError as error:
        return f"{provider.name}: {error.message}", []
    states, mend = [], []
    for what, model in zip(("TEXT_MODEL", "IMAGE_MODEL"), provider.models):
        ends = served.ends(model, date.today())
        states.append(f"{model} ends on {ends}" if ends else f"{model}{'' if served.has(model) else ' is not served'}")
        if ends or not served.has(model):
            names = [name for name in served.nearest(model) if name != model]
            mend.append(f"set VCAGE_{provider.name.upper()}_{what} to one that is served: {', '.join(names)}")
    return f"{provider.name}: {', '.join(states)}", mend


def disk() -> Finding:
    places = {"here": Path.cwd(), "cache": _existing(files.cache_path())}
    free = {name: shutil.disk_usage(path).free / 1e9 for name, path in places.items()}
    found = ", ".join(
        f"{size:.1f} GB free {'here' if name == 'here' else 'in the cache'}" for name, size in free.items()
    )
    fit = min(free.values()) >= MIN_FREE_GB
    mend = "" if fit else f"free space, or move the cache: export VCAGE_CACHE=/a/larger/disk (now {files.cache_path()})"
    return Finding("disk", fit, found, required=False, mend=mend)


def assets() -> Finding:
    from vcage.objects.library import Library

    library = Library.load()
    total = sum(len(library.annotation(name).variants) for name in library.names)
    unbuilt = len(library.unbuilt())
    found = f"{total - unbuilt} of {total} models built in {files.cache_path('assets')}"
    mend = vcage_command("setup", "assets") if unbuilt else ""
    return Finding("assets", not unbuilt, found, required=False, mend=mend)


CHECKS: tuple[Callable[[], Finding], ...] = (
    python, numpy, sapien, mani_skill, torch, opencv, gpu, vulkan, video, cvvdp, keys, models, ollama, disk, assets,
)  # fmt: skip
"""In the order of the table."""


def _package(module: str, requirement: str, *, name: str = "", distribution: str = "") -> Finding:
    """Check that a Python package is installed, without importing it."""
    try:
        version = metadata.version(distribution or module)
    except metadata.PackageNotFoundError:
        version = ""
    if not version or importlib.util.find_spec(module) is None:
        return Finding(name or module, False, "not installed", mend=pip_command(requirement))
    return Finding(name or module, True, version)


def _existing(path: Path) -> Path:
    return path if path.exists() else _existing(path.parent)
