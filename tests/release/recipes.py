"""The recipes of the containers, read as far as ours go: what they start from, copy, run and set."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass, field
from pathlib import Path

from tests.run_folders import REPOSITORY

DOCKERFILE = REPOSITORY / "containers" / "Dockerfile"
APPTAINER = REPOSITORY / "containers" / "apptainer.def"


@dataclass
class Recipe:
    """The content of a recipe.

    Args:
        base: the image that it starts from.
        arguments: values that the builder may give, with their defaults.
        files: (path in the checkout, path in the container).
        steps: commands of a shell that build it, in order.
        variables: of the environment of its programs.
        program: the command that the container runs.
    """

    base: str = ""
    arguments: dict[str, str] = field(default_factory=dict)
    files: list[tuple[str, str]] = field(default_factory=list)
    steps: list[str] = field(default_factory=list)
    variables: dict[str, str] = field(default_factory=dict)
    program: str = ""


def dockerfile(path: Path = DOCKERFILE) -> Recipe:
    """Read a Dockerfile.

    Raises:
        ValueError: it has an instruction that is not known here.
    """
    recipe = Recipe()
    for line in _lines(path):
        word, _, rest = line.partition(" ")
        if word == "FROM":
            recipe.base = rest
        elif word == "ARG":
            recipe.arguments |= _assigned(rest)
        elif word == "COPY":
            *sources, target = rest.split()
            recipe.files += [(one, _copied(one, target)) for one in sources]
        elif word == "RUN":
            recipe.steps.append(rest)
        elif word == "ENV":
            recipe.variables |= _assigned(rest)
        elif word == "ENTRYPOINT":
            recipe.program = " ".join(re.findall(r'"([^"]*)"', rest))
        elif word not in ("WORKDIR", "CMD"):
            raise ValueError(f"{path}: {line}")
    return recipe


def apptainer(path: Path = APPTAINER) -> Recipe:
    """Read an Apptainer definition.

    Raises:
        ValueError: it does not bootstrap from a registry of images.
    """
    head, *rest = re.split(r"^%(\w+)\n", "\n".join(_lines(path)), flags=re.MULTILINE)
    header = dict(line.split(": ", 1) for line in head.strip().splitlines())
    if header["Bootstrap"] != "docker":
        raise ValueError(f"{path}: Bootstrap: {header['Bootstrap']}")
    parts = {name: [line.strip() for line in text.strip().splitlines()] for name, text in zip(rest[::2], rest[1::2])}
    exports = [line.removeprefix("export ") for line in parts["environment"]]
    return Recipe(
        base=header["From"],
        arguments=dict(line.split("=", 1) for line in parts["arguments"]),
        files=[(source, target) for source, target in map(str.split, parts["files"])],
        steps=["\n".join(parts["post"])],
        variables={name: value for line in exports for name, value in _assigned(line).items()},
        program="\n".join(parts["runscript"]),
    )


def _lines(path: Path) -> list[str]:
    """Lines without comments, those that end in a backslash joined with the next."""
    text = "\n".join(line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#"))
    return [line for line in re.sub(r"\\\n\s*", "", text).splitlines() if line.strip()]


def _assigned(words: str) -> dict[str, str]:
    return dict(word.split("=", 1) for word in shlex.split(words))


def _copied(source: str, target: str) -> str:
    return f"{target}{Path(source).name}" if target.endswith("/") else target
