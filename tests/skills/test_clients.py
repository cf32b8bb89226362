"""The real clients of agents find all skills in each way of docs/agents.md; in them an agent runs the chain."""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Generator, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.run_folders import FPS, QUICK_VIDEOS
from tests.scripted_agent import Act, Read, Run, ScriptedAgent
from tests.skills.clients import (
    CLIENTS,
    GUIDE,
    NAMES,
    SKILLS,
    WAYS,
    WAYS_OF_THE_CHECKOUT,
    Desk,
    descriptions,
    is_here,
)
from tests.skills.scripted_model import Call, Script, scripted_model
from tests.skills.tools import TOOLS, Tools

TASK = "Put the red block and the green block into the box"

pytestmark = pytest.mark.slow


@pytest.fixture
def desk(tmp_path: Path) -> Iterator[Desk]:
    (tmp_path / "home").mkdir()
    (tmp_path / "work").mkdir()
    with scripted_model() as server:
        yield Desk(tmp_path / "home", tmp_path / "work", server)


def client_of(way: str) -> str:
    """The client of a way; the test is skipped where it is not asked for: all of them take about eight minutes."""
    client = way.partition(",")[0]
    if not os.environ.get("VCAGE_TEST_CLIENTS"):
        pytest.skip("make test-clients asks for this")
    if not is_here(client):
        pytest.skip(f"there is no {client} in {CLIENTS}: make test-clients")
    return client


def run_once(tools: Tools, command: str) -> Script:
    """Run a command, and wait for it where the client puts it into the background."""

    def acts() -> Generator[Act, Any, None]:
        yield Run(command)

    return tools.carry_out(acts())


@pytest.mark.parametrize("way", WAYS)
def test_a_client_tells_its_model_of_every_skill_and_runs_a_script_of_one(way: str, desk: Desk) -> None:
    tools = TOOLS[client_of(way)]
    script = "$(ls -d {}/*/skills/vcage-objects {}/*/.*/skills/vcage-objects {}/vcage-objects 2>/dev/null | head -1)"
    find = script.format(desk.home.parent, desk.home.parent, SKILLS)  # where this way has put it
    desk.server.play(run_once(tools, f"python3 {find}/scripts/assets_list.py --json"))
    WAYS[way](desk)
    assert found_by(desk) == dict.fromkeys(NAMES, 1)
    assert "left_out" in desk.server.asked[-1], "what the script said last"


@pytest.mark.parametrize("way", WAYS_OF_THE_CHECKOUT)
def test_a_client_given_the_checkout_finds_the_page_at_its_top_and_nothing_twice(way: str, desk: Desk) -> None:
    desk.server.play(run_once(TOOLS[client_of(way)], "echo hello"))
    WAYS_OF_THE_CHECKOUT[way](desk)
    found = found_by(desk)
    assert found[GUIDE] == 1
    assert set(found.values()) == {1}


def found_by(desk: Desk) -> dict[str, int]:
    """Skills of ours that a client tells its model of → how often one request describes it."""
    counts = {name: max(asked.count(text) for asked in desk.server.asked) for name, text in descriptions().items()}
    return {name: count for name, count in counts.items() if count}


CHAINS = {
    "claude, linked into the project": ".claude/skills",
    "codex, linked into the project": ".agents/skills",
    "pi, linked into the project": ".agents/skills",
    "openclaw, copied into the workspace": "skills",
}
"""Way → where it puts the skills, of the working folder."""

POLLING = {"codex": "write_stdin", "openclaw": "process"}
"""Client → its tool that waits for what it put into the background."""

OWN = {"collect": ["--episodes", "1", "--workers", "1", "--fps", str(FPS)], "compress": QUICK_VIDEOS}
"""Options that the agent adds to the command of a stage."""


def chain(agent: ScriptedAgent, skill: Path, run: Path) -> Generator[Act, Any, None]:
    """From what the skill says to the report, command by command."""
    said = re.search(r'^(python3 \S+/select_place\.py) ".+" --out \S+$', (yield Read(skill / "SKILL.md")), re.MULTILINE)
    assert said is not None
    begin = said[1].replace("{baseDir}", shlex.quote(str(skill)))
    record = yield from agent.run(f"{begin} {shlex.quote(TASK)} --out {shlex.quote(str(run))} --models agent")
    while record["ok"] and record["next"]:
        stage = shlex.split(record["next"])[1]
        record = yield from agent.run(" ".join([record["next"], *OWN.get(stage, [])]))
    assert record["ok"], record


@pytest.mark.parametrize("way", CHAINS)
def test_an_agent_in_a_client_runs_the_chain_as_its_model_errs_in_each_role_mends_it_and_finishes(
    way: str, desk: Desk
) -> None:
    client = client_of(way)
    agent, run = ScriptedAgent(), desk.work / "runs" / "two blocks"
    desk.server.play(TOOLS[client].carry_out(chain(agent, desk.work / CHAINS[way] / "vcage-igsc", run)))
    WAYS[way](desk)
    agent.assert_it_mended_everything(run)
    assert (run / "export" / "lerobot-v3.0").is_dir() and (run / "report.html").exists()
    called = {call.tool for call in desk.server.transcript if isinstance(call, Call)}
    assert POLLING.get(client) in {None, *called}, "what goes to the background is waited for"
