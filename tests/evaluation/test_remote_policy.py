"""Asking a policy server: answers, and everything that may go wrong with one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from benchmarks._policy.serve import Drop
from tests.evaluation.policy_server import policy_server
from vcage.base.errors import EndpointFailed, UsageError
from vcage.evaluation import remote_policy
from vcage.evaluation.policy import PolicyFailed, checked_actions
from vcage.evaluation.remote_policy import RemotePolicy, RemoteSettings

QUICK = RemoteSettings(connect_s=0.2, answer_s=5.0, pause_s=0.05)
OBSERVATION = {"state": np.arange(14, dtype=np.float32), "prompt": "Put the block on the plate."}


def doubled(observation: Mapping[str, Any]) -> Mapping[str, Any]:
    return {"actions": np.stack([observation["state"]] * 2) * 2}


def test_an_answer_arrives_with_its_arrays() -> None:
    with policy_server(doubled) as address:
        policy = RemotePolicy(address, QUICK)
        np.testing.assert_array_equal(policy.infer(OBSERVATION)["actions"][1], 2 * OBSERVATION["state"])
        assert policy.metadata == {"name": "test"}


def test_a_slow_first_answer_is_waited_for() -> None:
    with policy_server(doubled, first_answer_s=1.0) as address:
        assert len(RemotePolicy(address, QUICK).infer(OBSERVATION)["actions"]) == 2


def test_a_dropped_connection_is_opened_again() -> None:
    calls = []

    def flaky(observation: Mapping[str, Any]) -> Mapping[str, Any]:
        calls.append(1)
        if len(calls) == 2:
            raise Drop
        return doubled(observation)

    with policy_server(flaky) as address:
        policy = RemotePolicy(address, QUICK)
        assert [len(policy.infer(OBSERVATION)["actions"]) for _ in range(3)] == [2, 2, 2]
    assert len(calls) == 4


def test_a_server_that_always_drops_is_given_up() -> None:
    def dropping(_observation: Mapping[str, Any]) -> Mapping[str, Any]:
        raise Drop

    with policy_server(dropping) as address, pytest.raises(EndpointFailed, match="dropped the connection 3 times"):
        RemotePolicy(address, QUICK).infer(OBSERVATION)


def test_proxies_of_the_environment_are_not_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("http_proxy", "https_proxy", "all_proxy", "HTTP_PROXY", "ALL_PROXY"):
        monkeypatch.setenv(name, "http://127.0.0.1:9")
    monkeypatch.delenv("no_proxy", raising=False)
    monkeypatch.delenv("NO_PROXY", raising=False)
    with policy_server(doubled) as address:
        assert len(RemotePolicy(address, QUICK).infer(OBSERVATION)["actions"]) == 2


def test_no_ping_waits_for_a_server_that_compiles(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: dict[str, Any] = {}
    real = remote_policy.connect
    monkeypatch.setattr(remote_policy, "connect", lambda *a, **k: asked.update(k) or real(*a, **k))
    with policy_server(doubled) as address:
        RemotePolicy(address, QUICK).infer(OBSERVATION)
    assert asked["ping_interval"] is None


def test_a_traceback_becomes_an_error_with_its_last_line() -> None:
    def broken(_observation: Mapping[str, Any]) -> Mapping[str, Any]:
        raise KeyError("images")

    with policy_server(broken) as address:
        with pytest.raises(PolicyFailed, match="reports an error: KeyError: 'images'") as caught:
            RemotePolicy(address, QUICK).infer(OBSERVATION)
        assert "Traceback" in caught.value.details["traceback"]


def test_a_late_answer_is_an_error() -> None:
    late = RemoteSettings(connect_s=0.2, answer_s=0.2)
    with policy_server(doubled, first_answer_s=2.0) as address, pytest.raises(EndpointFailed, match=r"within 0\.2 s"):
        RemotePolicy(address, late).infer(OBSERVATION)


def test_a_server_that_is_not_there_is_waited_for_and_named(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    with pytest.raises(EndpointFailed, match=r"ws://127\.0\.0\.1:9 cannot be reached within 0\.2 s"):
        RemotePolicy("ws://127.0.0.1:9", QUICK).infer(OBSERVATION)
    assert [one.getMessage().startswith("waiting for ws://127.0.0.1:9") for one in caplog.records] == [True]


@pytest.mark.parametrize("address", ["http://127.0.0.1:8000", "ws://", "127.0.0.1:8000"])
def test_an_address_that_is_none_is_refused(address: str) -> None:
    with pytest.raises(UsageError, match="is no address of a server"):
        RemotePolicy(address)


@pytest.mark.parametrize(
    ("answer", "complaint"),
    [
        ({"action": np.zeros((2, 14))}, "answers without 'actions', but with"),
        ([1, 2], "answers without 'actions', but with list"),
        ({"actions": np.zeros((2, 7))}, r"shape \(2, 7\); expected \(horizon, 14\)"),
        ({"actions": np.zeros((0, 14))}, r"shape \(0, 14\)"),
        ({"actions": np.full((2, 14), np.nan)}, "NaN or infinity"),
        ({"actions": [["left"]]}, "actions that are no numbers"),
        ({"actions": [1j] * 14}, "actions that are no numbers"),
    ],
)
def test_a_wrong_answer_is_refused_by_name(answer: object, complaint: str) -> None:
    with pytest.raises(PolicyFailed, match=complaint):
        checked_actions(answer, 14, "ws://policy")


def test_a_single_action_is_a_chunk_of_one() -> None:
    assert checked_actions({"actions": [0.0] * 14}, 14, "policy").shape == (1, 14)
