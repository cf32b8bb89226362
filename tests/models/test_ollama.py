"""Ollama, played by the stand-in server: provider choice, answering model, and questions not asked without vision."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.model_server import ModelServer, raw_answer, text_answer
from tests.models.catalogue import CATALOGUE, unchecked
from tests.models.tabletop import BOX, MARKERS, critic_question
from vcage.base.errors import ConfigurationError, EndpointFailed, ModelNotServed, UsageError
from vcage.cli.doctor import ollama as doctor_ollama
from vcage.models.exchanges import Exchanges
from vcage.models.ollama import OLLAMA
from vcage.models.protocols import CriticQuestion, Models
from vcage.models.registry import Choice, build_models
from vcage.models.spending import Cap
from vcage.schema.goals import Goal
from vcage.schema.plan import Selection

ROLES = ("reasoner", "editor", "critic")


@pytest.fixture(autouse=True)
def here(server: ModelServer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VCAGE_OLLAMA_URL", server.base_urls["ollama"])


def question() -> CriticQuestion:
    goal = Goal(subject="black-marker", relation="inside", reference="box")
    after = [BOX, MARKERS[0].moved(at=BOX.at, base=0.005), *MARKERS[1:]]
    return critic_question([BOX, *MARKERS], after, goal, "Put the black marker into the box.")


def select(models: Models) -> Selection:
    return models.reasoner.select_assets("Put the blocks on the plate", CATALOGUE, np.random.default_rng(0), unchecked)


def without_eyes(server: ModelServer) -> None:
    del server.ollama.capabilities["qwen3-vl:8b"]


def test_the_first_model_that_answers_questions_is_asked_and_named_without_a_key() -> None:
    models = build_models(Choice("ollama"))
    assert models.providers(*ROLES) == {
        "reasoner": "ollama:qwen3-vl:8b", "editor": "offline", "critic": "ollama:qwen3-vl:8b"
    }  # fmt: skip
    assert select(models).objects and models.critic.judge(question()).accepted


def test_a_named_model_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VCAGE_OLLAMA_TEXT_MODEL", "llama3.2:3b")
    assert build_models(Choice("ollama")).reasoner.provider == "ollama:llama3.2:3b"


def test_a_name_without_a_tag_is_served_as_the_latest(server: ModelServer, monkeypatch: pytest.MonkeyPatch) -> None:
    server.ollama.capabilities["gemma4:latest"] = ["completion", "vision"]
    monkeypatch.setenv("VCAGE_OLLAMA_TEXT_MODEL", "gemma4")
    assert build_models(Choice("ollama", fallback="offline")).critic.provider == "ollama:gemma4"


def test_an_unfetched_model_is_reported_with_the_fetched_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VCAGE_OLLAMA_TEXT_MODEL", "gone:1b")
    with pytest.raises(ModelNotServed, match=r"ollama does not serve gone:1b; it serves .*qwen3-vl:8b"):
        select(build_models(Choice("ollama")))


def test_auto_takes_it_where_no_provider_has_a_key_and_says_so(
    server: ModelServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = Choice("auto").announcement(ROLES)
    assert "ollama for reasoner, critic, rules (offline) for editor, since no provider has a key" in told
    assert f"answers at {server.url}/ollama/v1 with qwen3-vl:8b" in told
    monkeypatch.setenv("OPENAI_API_KEY", "key-1")
    assert Choice("auto").of("reasoner") == "openai"


def test_auto_takes_rules_where_it_does_not_answer_or_has_no_model(
    server: ModelServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    server.ollama.capabilities = {"nomic-embed-text:latest": ["embedding"]}
    assert Choice("auto").of("reasoner") == "offline"
    monkeypatch.setenv("VCAGE_OLLAMA_URL", "http://127.0.0.1:9")
    assert Choice("auto").of("reasoner") == "offline"
    assert "and no Ollama at http://127.0.0.1:9" in Choice("auto").announcement(ROLES)


def test_it_is_looked_for_once_in_a_process(server: ModelServer) -> None:
    assert Choice("auto").of("reasoner") == "ollama"
    server.ollama.capabilities.clear()
    assert Choice("auto").of("critic") == "ollama"


def test_where_it_is_chosen_and_does_not_answer_the_error_says_how_to_start_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VCAGE_OLLAMA_URL", "http://127.0.0.1:9")
    with pytest.raises(EndpointFailed, match=r"127\.0\.0\.1:9") as caught:
        build_models(Choice("ollama"))
    assert "ollama serve" in caught.value.hint and "VCAGE_OLLAMA_URL" in caught.value.hint


def test_where_it_has_no_model_the_error_says_how_to_fetch_one(server: ModelServer) -> None:
    server.ollama.capabilities.clear()
    with pytest.raises(ConfigurationError, match="has no model") as caught:
        build_models(Choice("ollama"))
    assert "ollama pull" in caught.value.hint


# --- models without eyes ----------------------------------------------------------------------------------


def test_rules_are_the_critic_for_a_model_without_vision_and_that_is_reported(server: ModelServer) -> None:
    without_eyes(server)
    assert build_models(Choice("ollama")).providers("reasoner", "critic") == {
        "reasoner": "ollama:llama3.2:3b", "critic": "offline"
    }  # fmt: skip
    blind = "rules (offline) are the critic, since ollama:llama3.2:3b sees no pictures"
    assert blind in Choice("ollama").announcement(("critic",))
    assert Choice("ollama").announcement(("reasoner",)) == ""
    assert "ollama for reasoner, rules (offline) for editor, critic" in Choice("auto").announcement(ROLES)


def test_a_model_without_vision_is_refused_as_critic_before_anything_is_sent(server: ModelServer) -> None:
    without_eyes(server)
    with pytest.raises(ConfigurationError, match=r"ollama:llama3\.2:3b sees no pictures") as caught:
        build_models(Choice("offline", critic="ollama"))
    assert "VCAGE_OLLAMA_TEXT_MODEL" in caught.value.hint and not server.requests
    assert Choice("offline", critic="ollama", fallback="offline").of("critic") == "offline"


def test_a_list_of_model_inputs_is_believed(server: ModelServer, monkeypatch: pytest.MonkeyPatch) -> None:
    listed = {"data": [{"id": "smollm2", "architecture": {"input_modalities": ["text"]}}]}
    monkeypatch.setattr(type(server.ollama), "answer", lambda *_: listed)
    assert "smollm2 sees no pictures" in OLLAMA.blind()


def test_it_does_not_draw() -> None:
    with pytest.raises(UsageError, match="ollama does not draw"):
        Choice(editor="ollama").of("editor")


# --- in a run ---------------------------------------------------------------------------------------------


def test_a_run_with_a_cost_cap_asks_the_model_and_records_name_it(tmp_path: Path) -> None:
    select(build_models(Choice("ollama", run=tmp_path, cap=Cap(calls=1, usd=0.01))))
    (kept,) = Exchanges(tmp_path / "exchanges").all()
    assert (kept.provider, kept.model) == ("ollama:qwen3-vl:8b", "qwen3-vl:8b")


def test_a_wrong_answer_goes_back_with_the_complaint(server: ModelServer) -> None:
    server.queue(text_answer("{}"))
    assert select(build_models(Choice("ollama"))).objects
    assert "Field required" in json.dumps(server.requests[1])


def test_a_question_longer_than_the_context_is_an_error_that_names_it(server: ModelServer, tmp_path: Path) -> None:
    server.ollama.context = 256
    with pytest.raises(
        ConfigurationError, match=r"context of 256 tokens, and select_assets has [\d,]+ characters"
    ) as e:
        select(build_models(Choice("ollama", run=tmp_path)))
    assert "OLLAMA_CONTEXT_LENGTH=" in e.value.hint and not Exchanges(tmp_path / "exchanges").all()


def test_a_server_that_says_that_a_question_is_too_long_is_quoted(server: ModelServer) -> None:
    said = {"code": 400, "message": "request (9031 tokens) exceeds the available context size (8192 tokens)"}
    server.queue(raw_answer(json.dumps({"error": said | {"type": "exceed_context_size_error"}}).encode(), 400))
    with pytest.raises(ConfigurationError, match=r"too long for the model: .*\(8192 tokens\)"):
        select(build_models(Choice("ollama")))


def test_no_proxy_is_asked_for_the_loopback_interface(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("http_proxy", "HTTP_PROXY", "all_proxy"):
        monkeypatch.setenv(name, "http://127.0.0.1:9")
    for name in ("no_proxy", "NO_PROXY"):
        monkeypatch.delenv(name, raising=False)
    assert select(build_models(Choice("ollama"))).objects


# --- doctor -----------------------------------------------------------------------------------------------


def test_doctor_lists_its_models_and_the_one_that_answers(server: ModelServer) -> None:
    finding = doctor_ollama()
    assert finding.ok and not finding.required
    assert "nomic-embed-text:latest, qwen3-vl:8b, llama3.2:3b at http://" in finding.found
    assert finding.found.endswith("; qwen3-vl:8b answers")


def test_doctor_says_how_to_fetch_a_missing_model(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VCAGE_OLLAMA_TEXT_MODEL", "gone:1b")
    finding = doctor_ollama()
    assert not finding.ok and finding.mend == "ollama pull gone:1b"


def test_doctor_finds_nothing_wrong_without_a_server_at_the_default_address(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("VCAGE_OLLAMA_URL", "http://127.0.0.1:9")
    assert "does not answer" in doctor_ollama().found and "ollama serve" in doctor_ollama().mend
    monkeypatch.delenv("VCAGE_OLLAMA_URL")
    monkeypatch.setattr(type(OLLAMA), "found", _nobody)
    assert doctor_ollama().ok


def _nobody(_: object) -> None:
    raise EndpointFailed("http://127.0.0.1:11434/v1/models does not answer")
