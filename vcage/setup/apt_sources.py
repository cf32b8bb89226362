"""The machine's own package sources, read for apt-get calls that touch nothing outside one folder.

Formats: the manual page sources.list(5) of apt.
"""

from __future__ import annotations

import platform
import re
from dataclasses import dataclass, field
from pathlib import Path

from vcage.base.errors import ConfigurationError

APT = Path("/etc/apt")
_OPTION_FIELDS = {"arch": "Architectures", "lang": "Languages", "target": "Targets"}
_ONE_LINE = re.compile(r"^deb\s+(?:\[(?P<options>[^\]]*)\]\s+)?(?P<uri>\S+)\s+(?P<suite>\S+)\s+(?P<components>.+)$")
_KEPT_FIELDS = ("signed-by", "trusted", "architectures")


@dataclass(frozen=True)
class PackageSource:
    """One package source: addresses, suites (``bookworm``), components (``main``), and how it is trusted."""

    uris: tuple[str, ...]
    suites: tuple[str, ...]
    components: tuple[str, ...]
    options: dict[str, str] = field(default_factory=dict)

    def stanza(self) -> str:
        """This source in apt's deb822 format, package lists only."""
        lines = [
            "Types: deb",
            f"URIs: {' '.join(self.uris)}",
            f"Suites: {' '.join(self.suites)}",
            f"Components: {' '.join(self.components)}",
            "Targets: Packages",
            "Languages: none",
            *(f"{name}: {value}" for name, value in self.options.items()),
        ]
        return "\n".join(lines) + "\n"


def private_options(folder: Path, root: Path = APT) -> list[str]:
    """Options that make ``apt-get update`` and ``download`` work inside ``folder``, without root.

    Packages come from the machine's release and, preferred, its backports on the same mirror.

    Args:
        folder: an existing folder for lists and caches.
        root: where apt's configuration lies.

    Raises:
        ConfigurationError: no source of this machine's release is configured.
    """
    folder = folder.resolve()
    codename = platform.freedesktop_os_release().get("VERSION_CODENAME", "")
    sources = [with_backports(source, codename) for source in read(root) if codename in source.suites]
    if not sources:
        raise ConfigurationError(
            f"{root} names no package source for {codename or 'this system'}",
            hint="add your distribution's package source there",
        )
    for name in ("parts", "lists/partial", "cache/archives/partial"):
        (folder / name).mkdir(parents=True)
    (folder / "parts" / "vcage.sources").write_text("\n".join(source.stanza() for source in sources))
    (folder / "preferences").write_text(f"Package: *\nPin: release n={codename}-backports\nPin-Priority: 700\n")
    settings = {
        "Dir::Etc::SourceList": "/dev/null",
        "Dir::Etc::SourceParts": folder / "parts",
        "Dir::Etc::Preferences": folder / "preferences",
        "Dir::Etc::PreferencesParts": "/dev/null",
        "Dir::State::Lists": folder / "lists",
        "Dir::Cache": folder / "cache",
        "Dir::Cache::pkgcache": "pkgcache.bin",
        "Dir::Cache::srcpkgcache": "srcpkgcache.bin",
        # As root, apt would download as a user who may not enter this folder.
        "APT::Sandbox::User": "root",
        "Debug::NoLocking": "1",
        "Acquire::Retries": "3",
    }
    return [word for name, value in settings.items() for word in ("-o", f"{name}={value}")]


def with_backports(source: PackageSource, codename: str) -> PackageSource:
    """The release's suite, its updates and its backports, from the source's mirror; only the main component."""
    suites = (codename, f"{codename}-updates", f"{codename}-backports")
    return PackageSource(source.uris, suites, ("main",), source.options)


def read(root: Path = APT) -> list[PackageSource]:
    """Every enabled source of binary packages under ``root`` that has a main component."""
    found = []
    for path in [root / "sources.list", *sorted((root / "sources.list.d").glob("*"))]:
        if not path.is_file():
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        if path.suffix == ".sources":
            found += parse_deb822(text)
        elif path.suffix == ".list":
            found += parse_one_line(text)
    return [source for source in found if "main" in source.components and not source.uris[0].startswith("cdrom:")]


def parse_one_line(text: str) -> list[PackageSource]:
    """Sources in the format of ``sources.list``."""
    found = []
    for line in text.splitlines():
        match = _ONE_LINE.match(line.partition("#")[0].strip())
        if not match:
            continue
        pairs = dict(option.split("=", 1) for option in (match["options"] or "").split() if "=" in option)
        named = {_OPTION_FIELDS.get(name, name): value.replace(",", " ") for name, value in pairs.items()}
        found.append(_source(match["uri"], match["suite"], match["components"], named))
    return found


def parse_deb822(text: str) -> list[PackageSource]:
    """Sources in the format of ``*.sources``: stanzas of ``Field: value``, continued by indented lines."""
    found = []
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    for stanza in re.split(r"\n\s*\n", "\n".join(lines)):
        fields: dict[str, str] = {}
        name = ""
        for line in stanza.splitlines():
            if line[:1].isspace() and name:
                fields[name] += "\n" + line
            elif ":" in line:
                name, _, value = line.partition(":")
                name = name.strip().lower()
                fields[name] = value.strip()
        enabled = fields.get("enabled", "yes").lower() not in ("no", "false", "0")
        if enabled and "deb" in fields.get("types", "").split() and fields.get("uris"):
            found.append(_source(fields["uris"], fields.get("suites", ""), fields.get("components", ""), fields))
    return found


def _source(uris: str, suites: str, components: str, fields: dict[str, str]) -> PackageSource:
    kept = {name: value for name, value in fields.items() if name.lower() in _KEPT_FIELDS}
    return PackageSource(tuple(uris.split()), tuple(suites.split()), tuple(components.split()), kept)
