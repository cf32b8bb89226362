"""The recipes of the containers, as far as a machine without Docker and Apptainer can try them.

Here the installation runs with stand-ins for apt-get and Python, which record how they are called. No image is pulled
or built. ``make test-containers`` runs the same steps for real in a Debian of their own, as root.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.release.recipes import APPTAINER, DOCKERFILE, Recipe, apptainer, dockerfile
from tests.run_folders import REPOSITORY

INSTALL = REPOSITORY / "containers" / "install.sh"
RECIPES = {"docker": dockerfile(), "apptainer": apptainer()}

ADDRESS = re.compile(r"\w+://\S+|(?<![/\w.-])[\w-]+(?:\.[\w-]+)+/\S*")
"""A URL, or a host with a path as images have it."""

STAND_IN = """#!/bin/sh
echo "$(basename "$0") $*" >> "$LOG"
case "$(basename "$0") $*" in "$FAILS") exit 9 ;; esac
case "$*" in "-m venv "*) mkdir -p "$3/bin" && cp "$0" "$3/bin/python" && cp "$0" "$3/bin/vcage" ;; esac
"""


@pytest.mark.parametrize("recipe", RECIPES.values(), ids=RECIPES)
def test_a_recipe_starts_from_the_public_image_of_debian_12(recipe: Recipe) -> None:
    assert recipe.base == "debian:bookworm-slim"


@pytest.mark.parametrize("recipe", RECIPES.values(), ids=RECIPES)
def test_all_files_that_a_recipe_copies_are_here(recipe: Recipe) -> None:
    assert recipe.files and [source for source, _ in recipe.files if not (REPOSITORY / source).exists()] == []


def test_both_recipes_copy_install_and_offer_the_same() -> None:
    docker, other = RECIPES["docker"], RECIPES["apptainer"]
    assert docker.files == other.files
    assert docker.arguments.keys() == other.arguments.keys()
    installs = "sh /install.sh /source /opt/vcage && rm -rf /source"
    assert all(sum(installs in step for step in recipe.steps) == 1 for recipe in (docker, other))
    assert docker.program == "vcage" and other.program == 'exec vcage "$@"'
    assert all(recipe.variables["PATH"].startswith("/opt/vcage/bin:") for recipe in (docker, other))


def test_every_file_that_the_wheel_is_built_from_is_copied(tmp_path: Path) -> None:
    """The checkout of the container makes a wheel: hatchling names what it lacks."""
    for source, target in RECIPES["docker"].files:
        (tmp_path / target.lstrip("/")).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / target.lstrip("/")).symlink_to(REPOSITORY / source)
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path / "wheel")]
    done = subprocess.run(command, cwd=tmp_path / "source", capture_output=True, text=True)
    assert done.returncode == 0 and list((tmp_path / "wheel").glob("*.whl")), done.stderr


@pytest.mark.parametrize("path", [DOCKERFILE, APPTAINER, INSTALL], ids=lambda path: path.name)
def test_no_recipe_names_an_address(path: Path) -> None:
    """Whoever builds takes the registry, the mirror and the index that the machine is configured for."""
    assert ADDRESS.findall(path.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("line", ["FROM registry.example.com/debian", "pip install -i https://example.com torch"])
def test_an_address_is_found(line: str) -> None:
    assert ADDRESS.search(line)


@pytest.mark.parametrize("recipe", RECIPES.values(), ids=RECIPES)
def test_the_commands_are_of_the_shells_grammar(recipe: Recipe) -> None:
    for command in [*recipe.steps, recipe.program, INSTALL.read_text(encoding="utf-8")]:
        done = subprocess.run(["sh", "-n"], input=command, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr


# --- the installation, with stand-ins ----------------------------------------------------------------------


def calls(folder: Path, fails: str = "", **variables: str) -> tuple[int, list[str]]:
    """Run the installation into a folder: its exit code, and how it called apt-get, Python and vcage."""
    programs, log = folder / "programs", folder / "log"
    programs.mkdir()
    for name in ("apt-get", "python3", "sed", "rm"):
        (programs / name).write_text(STAND_IN)
        (programs / name).chmod(0o755)
    environment = {"PATH": f"{programs}:{os.defpath}", "LOG": str(log), "FAILS": fails, **variables}
    command = ["sh", str(INSTALL), "/source", str(folder / "vcage")]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    return done.returncode, log.read_text().splitlines()


def test_the_installation_takes_the_newer_mesa_and_the_source(tmp_path: Path) -> None:
    code, found = calls(tmp_path)
    assert code == 0
    assert found[0].startswith("sed -i /^Suites: bookworm /s/$/ bookworm-backports/")
    assert (
        "apt-get install --yes --no-install-recommends --target-release bookworm-backports mesa-vulkan-drivers" in found
    )
    assert [line.partition("--no-cache-dir ")[2] for line in found if " pip " in line] == [
        "install torch==2.13.0",
        "install /source",
    ]
    assert [line for line in found if line.startswith("vcage")] == [
        f"vcage setup {part}" for part in ("opencv", "cvvdp", "efficientnet")
    ]


def test_a_builder_may_name_an_index_of_torch_and_extras(tmp_path: Path) -> None:
    _, found = calls(tmp_path, TORCH_INDEX="an-address", EXTRAS="view,ray")
    assert [line.partition("--no-cache-dir ")[2] for line in found if " pip " in line] == [
        "install --index-url an-address torch==2.13.0",
        "install /source[view,ray]",
    ]


def test_the_installation_stops_at_the_first_failure(tmp_path: Path) -> None:
    code, found = calls(tmp_path, fails="apt-get update")
    assert code == 9 and found[-1] == "apt-get update"


def test_the_suites_of_debians_image_get_their_backports(tmp_path: Path) -> None:
    sources = tmp_path / "debian.sources"
    sources.write_text("Types: deb\nSuites: bookworm bookworm-updates\n\nTypes: deb\nSuites: bookworm-security\n")
    (expression,) = re.findall(r"^sed -i '([^']+)'", INSTALL.read_text(encoding="utf-8"), re.MULTILINE)
    subprocess.run(["sed", "-i", expression, sources], check=True)
    suites = [line for line in sources.read_text().splitlines() if line.startswith("Suites")]
    assert suites == ["Suites: bookworm bookworm-updates bookworm-backports", "Suites: bookworm-security"]


def test_the_build_of_torch_is_that_of_the_makefile() -> None:
    (version,) = re.findall(r"^TORCH := (\S+)$", (REPOSITORY / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    assert f"torch=={version}\n" in INSTALL.read_text(encoding="utf-8")
