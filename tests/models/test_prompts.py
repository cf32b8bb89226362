from __future__ import annotations

from pathlib import Path

import pytest

from vcage.base.errors import ConfigurationError, UnknownName
from vcage.models import prompts


def test_every_model_call_has_a_prompt() -> None:
    assert prompts.names() == [
        "judge_pairs", "judge_subtask", "plan_layout", "read_goals", "rearrange", "select_assets",
    ]  # fmt: skip


def test_an_unknown_prompt_is_named() -> None:
    with pytest.raises(UnknownName, match="nonsense"):
        prompts.fill("nonsense")


@pytest.mark.parametrize("values", [{}, {"instruction": "x", "things": {}, "lying": {}, "more": 1}])
def test_placeholders_and_values_must_be_the_same(values: dict[str, object]) -> None:
    with pytest.raises(ConfigurationError, match="placeholders"):
        prompts.fill("read_goals", **values)


def test_a_broken_prompt_names_its_line(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "broken.md").write_text("fine\n{% if %}")
    monkeypatch.setattr(prompts, "resource", lambda *parts: tmp_path.joinpath(*parts[1:]))
    with pytest.raises(ConfigurationError, match="line 2"):
        prompts.fill("broken")
