"""Reading the machine's package sources."""

from __future__ import annotations

import platform
from pathlib import Path

import pytest

from vcage.base.errors import ConfigurationError
from vcage.setup import apt_sources

DEB822 = """\
# the main archive
Types: deb deb-src
URIs: http://mirror.example/debian
Suites: bookworm bookworm-updates
# a comment within
Components: main contrib
Signed-By:
 -----BEGIN PGP PUBLIC KEY BLOCK-----
 .
 abc
 -----END PGP PUBLIC KEY BLOCK-----

Types: deb
URIs: http://mirror.example/off
Suites: bookworm
Components: main
Enabled: no

Types: deb-src
URIs: http://mirror.example/sources
Suites: bookworm
Components: main
"""


def test_deb822_keeps_enabled_binary_sources_with_their_key() -> None:
    (source,) = apt_sources.parse_deb822(DEB822)
    assert source["uris"] == "http://mirror.example/debian"
    assert source["suites"] == "bookworm bookworm-updates"
    assert source["components"] == "main contrib"
    assert source["signed-by"].splitlines()[1] == " -----BEGIN PGP PUBLIC KEY BLOCK-----"


def test_one_line_sources_keep_their_options() -> None:
    wanted = "deb [arch=amd64,arm64 signed-by=/k.gpg] http://m/d bookworm main # yes"
    text = f"# no\ndeb-src http://m/x bookworm main\n{wanted}\n"
    (source,) = apt_sources.parse_one_line(text)
    assert source == {
        "uris": "http://m/d",
        "suites": "bookworm",
        "components": "main",
        "architectures": "amd64 arm64",
        "signed-by": "/k.gpg",
    }


def test_backports_come_from_the_same_mirror_with_the_same_key() -> None:
    (source,) = apt_sources.parse_deb822(DEB822)
    stanza = apt_sources.stanza(source, "bookworm")
    assert "uris: http://mirror.example/debian\n" in stanza
    assert "suites: bookworm bookworm-updates bookworm-backports\n" in stanza
    assert "components: main\n" in stanza
    (again,) = apt_sources.parse_deb822(stanza)
    assert again["signed-by"] == source["signed-by"]


def test_only_sources_with_a_main_component_are_read(tmp_path: Path) -> None:
    (tmp_path / "sources.list.d").mkdir()
    (tmp_path / "sources.list").write_text("deb cdrom:[disc]/ bookworm main\ndeb http://m/d bookworm main\n")
    (tmp_path / "sources.list.d" / "other.list").write_text("deb http://vendor bookworm stable\n")
    (tmp_path / "sources.list.d" / "ignored.list.save").write_text("deb http://old bookworm main\n")
    assert [source["uris"] for source in apt_sources.read(tmp_path)] == ["http://m/d"]


def test_private_options_write_only_inside_their_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(platform, "freedesktop_os_release", lambda: {"VERSION_CODENAME": "bookworm"})
    root, work = tmp_path / "apt", tmp_path / "work"
    root.mkdir()
    work.mkdir()
    (root / "sources.list").write_text("deb http://m/d bookworm main\ndeb http://m/d bookworm-security main\n")
    options = apt_sources.private_options(work, root)
    folders = {word.split("=")[1] for word in options if word.startswith(("Dir::State::Lists", "Dir::Cache="))}
    assert all(Path(folder).is_relative_to(work) for folder in folders) and len(folders) == 2
    assert (work / "parts" / "vcage.sources").read_text().count("uris:") == 1


def test_no_source_of_the_release_is_an_error_with_a_way_out(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="names no package source") as caught:
        apt_sources.private_options(tmp_path, tmp_path / "nothing")
    assert "package source" in caught.value.hint
