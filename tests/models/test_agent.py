"""Questions to the agent that runs the commands lie in a folder, and so do its answers."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest

from vcage.base.drawing import CAPTION, EDGE
from vcage.base.errors import AnswerNeeded, InputFileError, ModelRefused
from vcage.base.pictures import read_picture
from vcage.models.agent import VIEW, Agent
from vcage.models.exchange import Message, Question
from vcage.models.prompts import Prompt
from vcage.models.structured import Answer, ask, one_of

PROMPT = Prompt("choose", "Which colour is it?")


class Colour(Answer):
    name: one_of(["red", "blue"])


def asked(agent: Agent) -> Colour:
    return ask(agent, "critic", PROMPT, Colour, pictures=[("before, camera top", np.zeros((4, 4, 3), np.uint8))])


def needed(agent: Agent) -> dict:
    """What is asked, as the error tells it."""
    with pytest.raises(AnswerNeeded) as caught:
        asked(agent)
    assert caught.value.exit_code == 8
    (question,) = caught.value.details["asked"]
    return question


@pytest.fixture
def agent(tmp_path: Path) -> Agent:
    return Agent(tmp_path / "ask")


def test_a_question_is_a_folder_with_prompt_schema_and_pictures(agent: Agent) -> None:
    question = needed(agent)
    folder = Path(question["folder"])
    assert folder.name.startswith("critic-")
    assert sorted(question["files"]) == ["picture-01-before-camera-top.png", "prompt.md", "schema.json"]
    assert all((folder / name).is_file() for name in question["files"])
    assert "Which colour is it?" in (folder / "prompt.md").read_text()
    assert json.loads((folder / "schema.json").read_text())["properties"]["name"]["enum"] == ["red", "blue"]
    assert (question["round"], question["complaint"]) == (1, "")


def test_an_answer_is_taken_and_stays(agent: Agent) -> None:
    Path(needed(agent)["answer"]).write_text('{"name": "red"}')
    assert asked(agent).name == asked(agent).name == "red"


def test_a_wrong_answer_comes_back_with_the_exact_complaint_and_can_be_mended(agent: Agent) -> None:
    Path(needed(agent)["answer"]).write_text('{"name": "green"}')
    again = needed(agent)
    assert again["round"] == 2 and "name: Input should be 'red' or 'blue'" in again["complaint"]
    prompt = (Path(again["folder"]) / "prompt.md").read_text()
    assert '{"name": "green"}' in prompt and "name: Input should be" in prompt
    Path(again["answer"]).write_text('{"name": "blue"}')
    assert asked(agent).name == "blue"


def test_the_third_wrong_answer_is_a_refusal_until_the_folder_is_removed(agent: Agent) -> None:
    for _ in range(3):
        question = needed(agent)
        Path(question["answer"]).write_text("no")
    for _ in range(2):
        with pytest.raises(ModelRefused, match="3 rounds"):
            asked(agent)
    for path in Path(question["folder"]).iterdir():
        path.unlink()
    assert needed(agent)["round"] == 1


def test_too_deep_nesting_is_reported(agent: Agent) -> None:
    Path(needed(agent)["answer"]).write_text("{" + '"a":[' * 100_000)
    assert "the answer is not JSON" in needed(agent)["complaint"]


@pytest.mark.parametrize("around", [b"%s", b"Here it is:\r\n```json\r\n%s\r\n```\r\n"], ids=["bare", "fenced"])
def test_an_answer_that_windows_saved_is_read(agent: Agent, around: bytes) -> None:
    Path(needed(agent)["answer"]).write_bytes(b"\xef\xbb\xbf" + around % b'{\r\n"name": "red"}')
    assert asked(agent).name == "red"


def test_an_answer_that_says_a_field_twice_is_complained_about(agent: Agent) -> None:
    Path(needed(agent)["answer"]).write_text('{"name": "red",\n"name": "blue"}')
    assert "line 2: the key 'name' stands twice" in needed(agent)["complaint"]


def test_a_missing_file_is_named(agent: Agent) -> None:
    os.mkfifo(needed(agent)["answer"])
    with pytest.raises(InputFileError, match=r"answer\.json is no file"):
        asked(agent)


@pytest.mark.parametrize("written", [b"\xff\xfe\x00", b" " * 2_000_000], ids=["no text", "too long"])
def test_an_invalid_answer_is_named(agent: Agent, written: bytes) -> None:
    path = Path(needed(agent)["answer"])
    path.write_bytes(written)
    with pytest.raises(InputFileError, match=r"answer\.json"):
        asked(agent)
    path.write_text('{"name": "red"}')
    assert asked(agent).name == "red"


def test_two_questions_lie_apart(agent: Agent) -> None:
    first = needed(agent)["folder"]
    with pytest.raises(AnswerNeeded) as caught:
        agent.answer(Question("critic", (Message("user", "Another?"),), {}, "choose"))
    assert caught.value.details["asked"][0]["folder"] != first


def test_several_pictures_lie_on_one_sheet_too(agent: Agent) -> None:
    shown = [(when, np.full((30, 40, 3), grey, np.uint8)) for when, grey in (("before", 60), ("after", 200))]
    with pytest.raises(AnswerNeeded) as caught:
        ask(agent, "critic", PROMPT, Colour, pictures=shown)
    (question,) = caught.value.details["asked"]
    assert question["files"][2] == "pictures.png"
    sheet = read_picture(Path(question["folder"]) / "pictures.png")
    assert max(sheet.shape) <= 2000, "clients shrink what is larger"
    middle = EDGE + CAPTION + VIEW * 3 // 8
    assert [int(sheet[middle, u, 0]) for u in (EDGE + VIEW // 2, 2 * EDGE + VIEW * 3 // 2)] == [60, 200]
    assert "pictures.png shows them all" in (Path(question["folder"]) / "prompt.md").read_text()
