from __future__ import annotations

import logging
import time

import pytest

from tests.model_server import ModelServer, Special, raw_answer
from vcage.base.errors import ConfigurationError, EndpointFailed
from vcage.models.llm_critic import Judgement
from vcage.models.structured import flat_schema
from vcage.models.transport import Transport

PATH = "v1/chat/completions"
BODY = {
    "model": "gpt-6.1-terra",
    "messages": [{"role": "user", "content": "hi"}],
    "response_format": {
        "type": "json_schema",
        "json_schema": {"name": "answer", "strict": True, "schema": flat_schema(Judgement)},
    },
}


def client(server: ModelServer, waits: list[float] | None = None) -> Transport:
    waits = [] if waits is None else waits
    return Transport(server.url, {"Authorization": f"Bearer {server.key}"}, sleep=waits.append)


def test_an_answer_comes_back_as_an_object(server: ModelServer) -> None:
    assert client(server).post_json(PATH, BODY)["choices"]


def test_a_rate_limit_is_waited_for_as_long_as_asked(server: ModelServer) -> None:
    waits: list[float] = []
    server.queue(Special(status=429, headers={"Retry-After": "7"}))
    assert client(server, waits).post_json(PATH, BODY)["choices"]
    assert waits == [7]


def test_a_rate_limit_longer_than_a_minute_is_reported_at_once(server: ModelServer) -> None:
    waits: list[float] = []
    server.queue(Special(status=429, headers={"Retry-After": "3600"}))
    with pytest.raises(EndpointFailed, match="429"):
        client(server, waits).post_json(PATH, BODY)
    assert waits == []


def test_server_errors_are_retried_with_growing_waits_and_then_reported(server: ModelServer) -> None:
    waits: list[float] = []
    server.queue(*[Special(status=503)] * 4)
    with pytest.raises(EndpointFailed, match="503"):
        client(server, waits).post_json(PATH, BODY)
    assert waits == [1, 2, 4]


def test_a_closed_port_is_an_endpoint_failure() -> None:
    with pytest.raises(EndpointFailed, match="does not answer"):
        Transport("http://127.0.0.1:9", {}, sleep=lambda _: None).post_json(PATH, BODY)


@pytest.mark.parametrize("status", [400, 401, 402, 403, 404])
def test_what_the_user_must_mend_is_a_configuration_error_and_not_retried(server: ModelServer, status: int) -> None:
    server.queue(raw_answer(b'{"error": {"message": "no"}}', status))
    with pytest.raises(ConfigurationError) as caught:
        client(server).post_json(PATH, BODY)
    assert caught.value.details["status"] == status
    assert len(server.requests) == 1


def test_an_answer_that_is_not_json_is_an_endpoint_failure(server: ModelServer) -> None:
    server.queue(raw_answer(b"<html>hello</html>"))
    with pytest.raises(EndpointFailed, match="without a JSON object"):
        client(server).post_json(PATH, BODY)


def test_a_key_that_the_server_echoes_never_shows(server: ModelServer, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.DEBUG)
    server.queue(raw_answer(b'{"error": {"message": "wrong key: Bearer very-secret-key-1"}}', 401))
    server.key = "very-secret-key-1"
    with pytest.raises(ConfigurationError) as caught:
        client(server).post_json(PATH, BODY)
    shown = f"{caught.value} {caught.value.as_record()} {caplog.text}"
    assert "very-secret-key-1" not in shown and "***" in shown


def test_a_base_url_without_a_scheme_is_refused() -> None:
    with pytest.raises(ConfigurationError, match="not a base URL"):
        Transport("api.example", {})


def test_an_answer_that_never_ends_is_given_up_in_time(server: ModelServer) -> None:
    server.queue(*[Special(manner="drip")] * 4)
    start = time.monotonic()
    patient = Transport(server.url, {"Authorization": f"Bearer {server.key}"}, timeout=(1, 1), most_seconds=0.4)
    with pytest.raises(EndpointFailed, match="no whole answer"):
        patient.post_json(PATH, BODY)
    assert time.monotonic() - start < 1


def test_a_wait_that_leaves_no_time_ends_it(server: ModelServer) -> None:
    server.queue(*[Special(manner="hang")] * 4)
    start = time.monotonic()
    hurried = Transport(server.url, {"Authorization": f"Bearer {server.key}"}, timeout=(1, 0.2), most_seconds=0.5)
    with pytest.raises(EndpointFailed, match="does not answer"):
        hurried.post_json(PATH, BODY)
    assert time.monotonic() - start < 1 and len(server.requests) == 1


def test_an_account_without_credit_is_not_asked_again(server: ModelServer) -> None:
    server.queue(raw_answer(b'{"error": {"message": "You exceeded your quota", "code": "insufficient_quota"}}', 429))
    with pytest.raises(ConfigurationError, match="no credit"):
        client(server).post_json(PATH, BODY)


def test_a_key_that_is_wrong_with_status_400_is_called_a_wrong_key(server: ModelServer) -> None:
    wrong = Transport(server.url, {"x-goog-api-key": "another-key"})
    with pytest.raises(ConfigurationError, match="does not accept the key"):
        wrong.get_json("v1beta/models")
