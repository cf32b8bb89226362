"""The wheel and the source archive: what they hold, and that an installed wheel needs no checkout.

``make test-wheel`` does the same in an empty environment, with every package and an empty cache.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.run_folders import QUICK_VIDEOS, REPOSITORY
from vcage.base.files import cache_dir, cache_path
from vcage.base.version import __version__

DATA = ("assets", "prompts", "skills")
PAGES = ("docs/assets.md", "docs/instructions.md")
METADATA = ("METADATA", "RECORD", "WHEEL", "entry_points.txt", "licenses/LICENSE", "licenses/NOTICE")
SOURCES = ("vcage", *DATA, "tests", "benchmarks", "examples", "docs", "containers")


def built(checkout: Path, target: str, folder: Path) -> Path:
    """Build the wheel or the sdist of a checkout into a folder."""
    command = [sys.executable, "-m", "hatchling", "build", "-t", target, "-d", str(folder)]
    done = subprocess.run(command, cwd=checkout, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    (file,) = folder.glob("*.whl" if target == "wheel" else "*.tar.gz")
    return file


def contents(wheel: Path) -> Mapping[str, str]:
    """Name → SHA-256 of each file of a wheel."""
    with zipfile.ZipFile(wheel) as archive:
        return {name: hashlib.sha256(archive.read(name)).hexdigest() for name in archive.namelist()}


def sources(folder: str) -> list[str]:
    """Files under a folder of the repository, without caches."""
    paths = (REPOSITORY / folder).rglob("*")
    found = [path.relative_to(REPOSITORY) for path in paths if path.is_file()]
    return [path.as_posix() for path in found if "__pycache__" not in path.parts]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return built(REPOSITORY, "wheel", tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def sdist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return built(REPOSITORY, "sdist", tmp_path_factory.mktemp("sdist"))


def test_the_wheel_holds_the_library_with_its_data_and_nothing_else(wheel: Path) -> None:
    data = [*PAGES, *(name for folder in DATA for name in sources(folder))]
    metadata = [f"vcage-{__version__}.dist-info/{name}" for name in METADATA]
    assert sorted(contents(wheel)) == sorted([*sources("vcage"), *(f"vcage/_data/{name}" for name in data), *metadata])


def test_every_page_that_a_message_names_is_in_the_wheel() -> None:
    code = "".join(path.read_text(encoding="utf-8") for path in (REPOSITORY / "vcage").rglob("*.py"))
    assert {f"docs/{name}" for name in re.findall(r"resource\(['\"]docs['\"], ['\"]([\w.-]+)['\"]\)", code)} == {*PAGES}


def test_the_source_archive_holds_the_checkout_without_caches(sdist: Path) -> None:
    with tarfile.open(sdist) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert not [name for name in names if "__pycache__" in name or name.startswith((".venv", ".git/", "runs/"))]
    missing = [name for folder in SOURCES for name in sources(folder) if name not in names]
    assert not missing and {"LICENSE", "NOTICE", "CHANGELOG.md", "README.md", "Makefile", "mkdocs.yml"} <= names


@pytest.mark.slow
def test_the_source_archive_makes_the_same_wheel(sdist: Path, wheel: Path, tmp_path: Path) -> None:
    with tarfile.open(sdist) as archive:
        archive.extractall(tmp_path, filter="data")
    (checkout,) = tmp_path.iterdir()
    assert contents(built(checkout, "wheel", tmp_path / "again")) == contents(wheel)


# --- installed ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Installed:
    """The wheel in an environment of its own, which sees the other packages of this one, and a folder to work in."""

    environment: Path
    elsewhere: Path

    def run(self, program: Path | str, *arguments: str, cache: Path) -> subprocess.CompletedProcess[str]:
        """Run a program in the folder, with no variables but where its files go."""
        variables = {
            "PATH": os.defpath,
            "HOME": str(self.elsewhere),
            "VCAGE_CACHE": str(cache),
            "OMP_NUM_THREADS": "1",
        }
        command = [str(program), *arguments]
        return subprocess.run(command, env=variables, cwd=self.elsewhere, capture_output=True, text=True)

    def vcage(self, *arguments: str, cache: Path) -> dict[str, object]:
        """Run the installed command to its end; returns the record of its last line."""
        done = self.run(self.environment / "bin" / "vcage", *arguments, cache=cache)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout.splitlines()[-1])

    @property
    def package(self) -> Path:
        """The folder of the installed package."""
        (found,) = self.environment.glob("lib/python3*/site-packages/vcage")
        return found


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Installed:
    environment, elsewhere = tmp_path_factory.mktemp("environment"), tmp_path_factory.mktemp("elsewhere")
    subprocess.run([sys._base_executable, "-m", "venv", "--without-pip", environment], check=True)
    pip = [sys.executable, "-m", "pip", "--python", environment / "bin" / "python", "--disable-pip-version-check"]
    subprocess.run([*pip, "install", "--quiet", "--no-deps", "--no-index", wheel], check=True)
    (packages,) = environment.glob("lib/python3*/site-packages")
    # Plain lines: the .pth files of those folders, which lead to the checkout, are not read.
    others = [path for path in sys.path if Path(path).name == "site-packages"]
    (packages / "others.pth").write_text("\n".join(others) + "\n")
    return Installed(environment, elsewhere)


def test_an_installed_wheel_reads_nothing_from_the_checkout(installed: Installed, tmp_path: Path) -> None:
    code = (
        "import sys; from pathlib import Path; import vcage.cli.main; from vcage.base.files import resource\n"
        "print([str(p) for p in map(Path, sys.path) if (p / 'vcage' / '__init__.py').exists()], resource('assets'))"
    )
    done = installed.run(installed.environment / "bin" / "python", "-c", code, cache=tmp_path)
    assert done.stdout == f"['{installed.package.parent}'] {installed.package / '_data' / 'assets'}\n", done.stderr


@pytest.mark.slow
def test_an_installed_skill_finds_its_environment_by_itself(installed: Installed, tmp_path: Path) -> None:
    script = installed.package / "_data" / "skills" / "vcage" / "scripts" / "run.py"
    done = installed.run(Path(sys._base_executable), str(script), "--help", cache=tmp_path)
    assert done.returncode == 0 and done.stdout.startswith("usage: run.py "), done.stderr


def test_setup_finds_everything_from_an_installed_wheel(installed: Installed) -> None:
    summary = installed.vcage("setup", "all", "--no-packages", cache=cache_path())["summary"]
    assert isinstance(summary, dict) and summary["assets"]["objects"] > 100 and summary["assets"]["failed"] == []


@pytest.mark.slow
def test_an_installed_wheel_goes_from_the_sentence_to_the_data_set(installed: Installed, tmp_path: Path) -> None:
    (tmp_path / "vulkan").symlink_to(cache_dir("vulkan"))  # the driver, which comes from the network
    options = ["--episodes", "1", "--models", "offline", "--fps", "5", "--out", "run", *QUICK_VIDEOS]
    record = installed.vcage("run", "Put the apple into the bowl", *options, cache=tmp_path)
    run = installed.elsewhere / "run"
    assert isinstance(record["summary"], dict) and record["summary"]["accepted"] == 1
    assert record["output"] == str(run / "report.html") and (run / "report.html").stat().st_size > 10_000
    assert json.loads((run / "export" / "lerobot-v3.0" / "meta" / "info.json").read_text())["total_episodes"] == 1
