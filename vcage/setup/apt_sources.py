"""The machine's own package sources, read for apt-get calls that touch nothing outside one folder.

Formats: the manual page sources.list(5) of apt.
"""

from __future__ import annotations

import platform
import re
from collections.abc import Iterator
from email.parser import HeaderParser
from pathlib import Path

from vcage.base.errors import ConfigurationError

APT = Path("/etc/apt")

Source = dict[str, str]
"""Fields of a source of binary packages in apt's deb822 format, by their names in small letters."""

_TRUST_FIELDS = ("uris", "signed-by", "trusted", "architectures")
"""Fields that are taken over as the machine has them."""

_OPTION_FIELDS = {"arch": "architectures"}
_ONE_LINE = re.compile(r"^deb\s+(?:\[(?P<options>[^\]]*)\]\s+)?(?P<uris>\S+)\s+(?P<suites>\S+)\s+(?P<components>.+)$")


def private_options(folder: Path, root: Path = APT) -> list[str]:
    """Options that make ``apt-get update`` and ``download`` work inside ``folder``, without root.

    Packages come from the machine's release and, preferred, its backports on the same mirror.

    Args:
        folder: an existing folder for lists and caches.
        root: folder of apt's configuration.

    Raises:
        ConfigurationError: no source of this machine's release is configured.
    """
    folder = folder.resolve()
    codename = platform.freedesktop_os_release().get("VERSION_CODENAME", "")
    sources = [stanza(source, codename) for source in read(root) if codename in source["suites"].split()]
    if not sources:
        raise ConfigurationError(
            f"{root} names no package source for {codename or 'this system'}",
            hint="add your distribution's package source there",
        )
    for name in ("parts", "lists/partial", "cache/archives/partial"):
        (folder / name).mkdir(parents=True)
    (folder / "parts" / "vcage.sources").write_text("\n".join(sources))
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


def stanza(source: Source, codename: str) -> str:
    """A release's packages, updates and backports from a source's mirror, in apt's deb822 format.

    Only the main component and the package lists are asked for.
    """
    fields = {name: source[name] for name in _TRUST_FIELDS if name in source} | {
        "types": "deb",
        "suites": f"{codename} {codename}-updates {codename}-backports",
        "components": "main",
        "targets": "Packages",
        "languages": "none",
    }
    return "".join(f"{name}: {value}\n" for name, value in fields.items())


def read(root: Path = APT) -> list[Source]:
    """Every enabled source of binary packages under ``root`` that has a main component."""
    found: list[Source] = []
    for path in [root / "sources.list", *sorted((root / "sources.list.d").glob("*"))]:
        if path.is_file() and path.suffix in (".sources", ".list"):
            text = path.read_text(encoding="utf-8", errors="replace")
            found += parse_deb822(text) if path.suffix == ".sources" else parse_one_line(text)
    return [
        source for source in found if "main" in source["components"].split() and not source["uris"].startswith("cdrom:")
    ]


def parse_one_line(text: str) -> Iterator[Source]:
    """Sources in the format of ``sources.list``."""
    for line in text.splitlines():
        if match := _ONE_LINE.match(line.partition("#")[0].strip()):
            options = dict(word.split("=", 1) for word in (match["options"] or "").split() if "=" in word)
            named = {_OPTION_FIELDS.get(name, name): value.replace(",", " ") for name, value in options.items()}
            yield named | {name: match[name] for name in ("uris", "suites", "components")}


def parse_deb822(text: str) -> Iterator[Source]:
    """Sources in the format of ``*.sources``: stanzas of ``Field: value``, continued by indented lines."""
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    for stanza in re.split(r"\n\s*\n", "\n".join(lines)):
        headers = HeaderParser().parsestr(stanza.lstrip("\n"))
        fields = {"enabled": "yes", "types": "", "uris": "", "suites": "", "components": ""}
        fields |= {name.lower(): value for name, value in headers.items()}
        if (
            fields["uris"]
            and "deb" in fields["types"].split()
            and fields["enabled"].lower() not in ("no", "false", "0")
        ):
            yield fields
