"""The skills are valid for agents' clients, and mention nothing that does not exist."""

from __future__ import annotations

import ast
import os
import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from vcage.base import files
from vcage.base.version import __version__
from vcage.cli.main import COMMANDS

SKILLS = sorted(path.parent for path in files.resource("skills").glob("*/SKILL.md"))
LAUNCHER = files.resource("skills", "vcage_environment.py")
LAUNCHERS = sorted(files.resource("skills").glob("*/scripts/vcage_environment.py"))
SCRIPTS = sorted({*files.resource("skills").glob("*/scripts/*.py")} - {*LAUNCHERS})


def front_matter(folder: Path) -> tuple[str, dict[str, Any]]:
    """The head of a SKILL.md, as text and parsed."""
    text = (folder / "SKILL.md").read_text(encoding="utf-8")
    head = text.split("---\n")[1]
    return head, yaml.safe_load(head)


def names(paths: list[Path]) -> list[str]:
    return [path.name for path in paths]


def test_all_skills_are_there() -> None:
    assert names(SKILLS) == [
        "vcage",
        *(
            f"vcage-{part}"
            for part in ("collect", "compress", "export", "igsc", "objects", "subtask-search", "vlm-verify")
        ),
    ]


@pytest.mark.parametrize("folder", SKILLS, ids=lambda path: path.name)
def test_a_skill_has_the_name_of_its_folder(folder: Path) -> None:
    assert front_matter(folder)[1]["name"] == folder.name


@pytest.mark.parametrize("folder", [files.resource("skills").parent, *SKILLS], ids=lambda path: path.name)
def test_the_head_is_accepted_by_every_client(folder: Path) -> None:
    text, head = front_matter(folder)
    assert set(head) == {"name", "description", "license", "metadata"}
    assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", head["name"]) and len(head["name"]) <= 64
    assert len(head["description"]) <= 160 and not set("<>\n") & set(head["description"])
    assert {"version", "homepage"} <= set(head["metadata"]) and head["metadata"]["version"] == __version__
    assert "{" not in text, "metadata must be block YAML"


TOP = files.resource("skills").parent


def test_the_page_at_the_top_points_to_every_skill_and_has_a_name_of_its_own() -> None:
    """A client that searches the whole checkout finds this page and all skills: no two may have one name."""
    text = (TOP / "SKILL.md").read_text(encoding="utf-8")
    links = re.findall(r"^\| \[([\w-]+)\]\(([\w./-]+)\)", text, re.MULTILINE)
    assert sorted(name for name, _ in links) == names(SKILLS)
    assert all((TOP / path).parent.name == name and (TOP / path).is_file() for name, path in links)
    heads = [front_matter(folder)[1] for folder in (TOP, *SKILLS)]
    for key in ("name", "description"):
        assert len({head[key] for head in heads}) == len(heads)


def test_every_script_that_the_page_at_the_top_names_exists() -> None:
    scripts = re.findall(r"\{baseDir\}/([\w./-]+)", (TOP / "SKILL.md").read_text(encoding="utf-8"))
    assert scripts and all((TOP / path).is_file() for path in scripts)


@pytest.mark.parametrize("folder", SKILLS, ids=lambda path: path.name)
def test_no_key_is_required(folder: Path) -> None:
    _, head = front_matter(folder)
    assert "env" not in head["metadata"]["openclaw"]["requires"]


@pytest.mark.parametrize("folder", SKILLS, ids=lambda path: path.name)
def test_every_script_that_a_page_names_exists(folder: Path) -> None:
    text = (folder / "SKILL.md").read_text(encoding="utf-8")
    assert len(text.splitlines()) < 500
    assert "`{baseDir}` is the folder of this SKILL.md" in text
    for path in re.findall(r"(?:\{baseDir\}/|`)((?:scripts|references)/[\w./-]+)", text):
        assert (folder / path).is_file(), path
    for other in re.findall(r"`(vcage-[\w-]+)`", text):
        assert other in names(SKILLS), other
    for path in re.findall(r"\]\((?!http)([\w./-]+)\)", text):
        assert (folder / path).is_file(), path
    for options in re.findall(r"scripts/(\w+)\.py", text):
        assert options in {path.stem for path in SCRIPTS}


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.name)
def test_a_script_is_executable_and_only_names_its_command(script: Path) -> None:
    assert os.access(script, os.X_OK)
    text = script.read_text()
    (command,) = re.findall(r'main\("([\w -]+)"\)', text)
    assert command in COMMANDS and re.sub("[- ]", "_", command) == script.stem
    assert len(text.splitlines()) < 15


def test_the_nine_stages_decompression_four_actions_on_objects_and_three_of_the_whole_have_a_script_each() -> None:
    assert len(SCRIPTS) == 9 + 1 + 4 + 3


def test_every_skill_has_an_up_to_date_copy_of_the_launcher() -> None:
    assert [path.parents[1] for path in LAUNCHERS] == SKILLS
    assert {path.read_bytes() for path in LAUNCHERS} == {LAUNCHER.read_bytes()}, "run: make skills"


def test_code_for_any_python_has_syntax_of_3_6() -> None:
    for path in (LAUNCHER, *SCRIPTS):
        ast.parse(path.read_text(encoding="utf-8"), feature_version=(3, 6))
