"""The real clients of agents, each in a home of its own, asking a model on this machine: where skills are put for them.

``make test-clients`` fetches them.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import yaml

from tests.skills.scripted_model import ScriptedModel
from vcage.base import files

SKILLS = files.resource("skills").resolve()
NAMES = {path.parent.name for path in SKILLS.glob("*/SKILL.md")}
CHECKOUT = SKILLS.parent
GUIDE = "vcage-guide"
"""The name of the page at the top of the checkout."""
CLIENTS = files.cache_path("clients")
LONGEST = 900
"""Seconds until a client is stopped."""


def is_here(client: str) -> bool:
    """Whether it was fetched."""
    return (CLIENTS / "node_modules" / ".bin" / client).exists()


@dataclass(frozen=True)
class Desk:
    """A client's own home and working folder, and the model that it asks."""

    home: Path
    work: Path
    server: ScriptedModel

    def call(self, client: str, *arguments: str | Path, **variables: str) -> None:
        """Run a client that must succeed."""
        path = os.pathsep.join([str(CLIENTS / "node" / "bin"), os.defpath])
        own = {"PATH": path, "HOME": str(self.home), "TERM": "dumb", "NO_PROXY": "*"}
        ours = {"VCAGE_PYTHON": sys.executable, "VCAGE_CACHE": str(files.cache_path())}
        environment = own | ours | {"IS_SANDBOX": "1"} | variables
        program = [str(CLIENTS / "node_modules" / ".bin" / client), *map(str, arguments)]
        quiet = {"stdin": subprocess.DEVNULL, "capture_output": True}
        done = subprocess.run(program, cwd=self.work, env=environment, text=True, timeout=LONGEST, **quiet)
        if self.server.fault is not None:
            raise self.server.fault
        assert done.returncode == 0, done.stdout + done.stderr

    def write(self, name: str, text: str) -> Path:
        return files.write_text(self.home / name, text)


def linked(folder: Path) -> None:
    folder.mkdir(parents=True)
    for name in NAMES:
        (folder / name).symlink_to(SKILLS / name)


def checkout_linked(folder: Path) -> None:
    folder.mkdir(parents=True)
    (folder / GUIDE).symlink_to(CHECKOUT)


def copied(folder: Path) -> None:
    shutil.copytree(SKILLS, folder)


def claude(desk: Desk) -> None:
    endpoint = {"ANTHROPIC_BASE_URL": desk.server.url, "ANTHROPIC_API_KEY": "x"}
    quiet = {"CLAUDE_CODE_DISABLE_NONESSENTIAL_TRAFFIC": "1", "DISABLE_AUTOUPDATER": "1"}
    desk.call("claude", "-p", "hello", "--model", "mock", "--dangerously-skip-permissions", **endpoint, **quiet)


def codex(desk: Desk) -> None:
    provider = f'name = "loop"\nbase_url = "{desk.server.url}/v1"\nwire_api = "responses"\nenv_key = "LOOP_KEY"\n'
    limit = "tool_output_token_limit = 20000\n"  # a model that it does not know is shown 10 kB
    desk.write(
        ".codex/config.toml", f'{limit}model = "mock"\nmodel_provider = "loop"\n[model_providers.loop]\n{provider}'
    )
    desk.call(
        "codex", "exec", "--dangerously-bypass-approvals-and-sandbox", "--skip-git-repo-check", "hello", LOOP_KEY="x"
    )


def pi(desk: Desk, *options: str | Path) -> None:
    model = {"id": "mock", "input": ["text", "image"]}
    loop = {"baseUrl": f"{desk.server.url}/v1", "api": "openai-completions", "apiKey": "x", "models": [model]}
    desk.write(".pi/agent/models.json", json.dumps({"providers": {"loop": loop}}))
    desk.call("pi", "-p", "hello", "--provider", "loop", "--model", "mock", *options)


def openclaw(desk: Desk, *, extra: Path | None = None, installed: bool = False) -> None:
    model = {"id": "mock", "name": "mock", "input": ["text", "image"], "contextWindow": 200000, "maxTokens": 8192}
    loop = {"baseUrl": f"{desk.server.url}/v1", "apiKey": "x", "api": "openai-completions", "models": [model]}
    configuration = {
        "agents": {"defaults": {"model": {"primary": "loop/mock"}, "workspace": str(desk.work)}},
        "models": {"mode": "merge", "providers": {"loop": loop}},
        "skills": {"load": {"extraDirs": [str(extra)] if extra else []}},
    }
    path = desk.write("openclaw.json", json.dumps(configuration))
    for name in NAMES if installed else ():
        desk.call("openclaw", "skills", "install", SKILLS / name, OPENCLAW_CONFIG_PATH=str(path))
    desk.call("openclaw", "agent", "exec", "hello", "--config", path, "--cwd", desk.work, "--json")


def put(how: Callable[[Path], None], where: str, folder: str, client: Callable[[Desk], None]) -> Callable[[Desk], None]:
    """The skills are put into a folder of the project or the user, and the client is called."""

    def way(desk: Desk) -> None:
        how(getattr(desk, where) / folder)
        client(desk)

    return way


WAYS: dict[str, Callable[[Desk], None]] = {
    "claude, linked into the project": put(linked, "work", ".claude/skills", claude),
    "claude, copied for the user": put(copied, "home", ".claude/skills", claude),
    "codex, linked into the project": put(linked, "work", ".agents/skills", codex),
    "codex, copied for the user": put(copied, "home", ".agents/skills", codex),
    "pi, named in the call": lambda desk: pi(desk, "--skill", SKILLS),
    "pi, linked into the project": put(linked, "work", ".agents/skills", pi),
    "pi, copied for the user": put(copied, "home", ".agents/skills", pi),
    "openclaw, named in extraDirs": lambda desk: openclaw(desk, extra=SKILLS),
    "openclaw, installed one by one": lambda desk: openclaw(desk, installed=True),
    "openclaw, copied into the workspace": put(copied, "work", "skills", openclaw),
}

WAYS_OF_THE_CHECKOUT: dict[str, Callable[[Desk], None]] = {
    "claude, linked into the project": put(checkout_linked, "work", ".claude/skills", claude),
    "codex, linked into the project": put(checkout_linked, "work", ".agents/skills", codex),
    "pi, named in the call": lambda desk: pi(desk, "--skill", CHECKOUT),
    "pi, linked into the project": put(checkout_linked, "work", ".agents/skills", pi),
    "openclaw, named in extraDirs": lambda desk: openclaw(desk, extra=CHECKOUT),
}
"""Ways to give a client the whole checkout."""


def descriptions() -> dict[str, str]:
    """Name → description of the page at the top and of every skill; what clients tell their model of it."""
    pages = [CHECKOUT / "SKILL.md", *SKILLS.glob("*/SKILL.md")]
    heads = [yaml.safe_load(page.read_text(encoding="utf-8").split("---\n")[1]) for page in pages]
    return {head["name"]: head["description"] for head in heads}
