from __future__ import annotations

import logging
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import pytest

from tests.model_server import ModelServer, Special, raw_answer
from vcage.base.errors import ConfigurationError, EndpointFailed, VcageError
from vcage.models.llm_critic import Judgement
from vcage.models.providers import PROVIDERS
from vcage.models.structured import flat_schema
from vcage.models.transport import Transport, TransportLimits

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
    assert client(server).post(PATH, BODY)["choices"]


def test_a_rate_limit_is_waited_for_as_long_as_asked(server: ModelServer) -> None:
    waits: list[float] = []
    server.queue(Special(status=429, headers={"Retry-After": "7"}))
    assert client(server, waits).post(PATH, BODY)["choices"]
    assert waits == [7]


def test_a_rate_limit_longer_than_a_minute_is_reported_at_once(server: ModelServer) -> None:
    waits: list[float] = []
    server.queue(Special(status=429, headers={"Retry-After": "3600"}))
    with pytest.raises(EndpointFailed, match="429"):
        client(server, waits).post(PATH, BODY)
    assert waits == []


def test_server_errors_are_retried_with_growing_waits_and_then_reported(server: ModelServer) -> None:
    waits: list[float] = []
    server.queue(*[Special(status=503)] * 4)
    with pytest.raises(EndpointFailed, match="503"):
        client(server, waits).post(PATH, BODY)
    assert waits == [1, 2, 4]


def test_a_closed_port_is_an_endpoint_failure() -> None:
    with pytest.raises(EndpointFailed, match="does not answer"):
        Transport("http://127.0.0.1:9", {}, sleep=lambda _: None).post(PATH, BODY)


@pytest.mark.parametrize("status", [400, 401, 402, 403, 404])
def test_an_error_the_user_must_fix_is_a_configuration_error_and_not_retried(server: ModelServer, status: int) -> None:
    server.queue(raw_answer(b'{"error": {"message": "no"}}', status))
    with pytest.raises(ConfigurationError) as caught:
        client(server).post(PATH, BODY)
    assert caught.value.details["status"] == status
    assert len(server.requests) == 1


def test_an_answer_that_is_not_json_is_an_endpoint_failure(server: ModelServer) -> None:
    server.queue(raw_answer(b"<html>hello</html>"))
    with pytest.raises(EndpointFailed, match="without a JSON object"):
        client(server).post(PATH, BODY)


def test_a_key_that_the_server_echoes_never_shows(server: ModelServer, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.DEBUG)
    server.queue(raw_answer(b'{"error": {"message": "wrong key: Bearer very-secret-key-1"}}', 401))
    server.key = "very-secret-key-1"
    with pytest.raises(ConfigurationError) as caught:
        client(server).post(PATH, BODY)
    shown = f"{caught.value} {caught.value.as_record()} {caplog.text}"
    assert "very-secret-key-1" not in shown and "***" in shown


def test_a_base_url_without_a_scheme_is_refused() -> None:
    with pytest.raises(ConfigurationError, match="not a base URL"):
        Transport("api.example", {})


def test_an_answer_that_never_ends_is_given_up_in_time(server: ModelServer) -> None:
    server.queue(*[Special(manner="drip")] * 4)
    start = time.monotonic()
    patient = Transport(server.url, {"Authorization": f"Bearer {server.key}"}, limits=TransportLimits(1, 1, 0.4))
    with pytest.raises(EndpointFailed, match="no whole answer"):
        patient.post(PATH, BODY)
    assert time.monotonic() - start < 1


def test_a_wait_that_leaves_no_time_ends_it(server: ModelServer) -> None:
    server.queue(*[Special(manner="hang")] * 4)
    start = time.monotonic()
    hurried = Transport(server.url, {"Authorization": f"Bearer {server.key}"}, limits=TransportLimits(1, 0.2, 0.5))
    with pytest.raises(EndpointFailed, match="does not answer"):
        hurried.post(PATH, BODY)
    assert time.monotonic() - start < 1 and len(server.requests) == 1


def test_an_account_without_credit_is_not_asked_again(server: ModelServer) -> None:
    server.queue(raw_answer(b'{"error": {"message": "You exceeded your quota", "code": "insufficient_quota"}}', 429))
    with pytest.raises(ConfigurationError, match="no credit"):
        client(server).post(PATH, BODY)


def test_a_wrong_key_with_status_400_is_called_a_wrong_key(server: ModelServer) -> None:
    wrong = Transport(server.url, {"x-goog-api-key": "another-key"})
    with pytest.raises(ConfigurationError, match="does not accept the key"):
        wrong.get_json("v1beta/models")


# --- no credentials but ours ---------------------------------------------------------------------------


class Seen:
    """Requests that reached a server: the first line, and the headers."""

    def __init__(self, url: str):
        self.url = url
        self.requests: list[tuple[str, Mapping[str, str]]] = []


@contextmanager
def listening(status: int = 200, headers: Mapping[str, str] | None = None) -> Iterator[Seen]:
    """A server, or a proxy, on the loopback interface that answers everything alike."""

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            self.rfile.read(int(self.headers.get("Content-Length", 0)))
            seen.requests.append((self.requestline, self.headers))
            self.send_response(status)
            for name, value in {"Content-Length": "12", **(headers or {})}.items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(b'{"ok": true}')

        def log_message(self, *_: object) -> None:
            """Quiet."""

    listener = HTTPServer(("127.0.0.1", 0), Handler)
    seen = Seen(f"http://127.0.0.1:{listener.server_port}")
    thread = threading.Thread(target=listener.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)
    thread.start()
    try:
        yield seen
    finally:
        listener.shutdown()
        listener.server_close()
        thread.join()


def sent_by(seen: Seen, transport: Transport) -> Mapping[str, str]:
    """The headers of one request."""
    assert transport.post("v1/x", {}) == {"ok": True}
    return seen.requests[-1][1]


@pytest.mark.parametrize("place", [".netrc", "_netrc", "NETRC"])
@pytest.mark.parametrize("provider", PROVIDERS.values(), ids=lambda provider: provider.name)
def test_a_netrc_file_neither_replaces_the_key_nor_joins_it(provider, place, tmp_path, monkeypatch):
    path = tmp_path / place
    path.write_text("machine 127.0.0.1 login someone password of-another-service\ndefault login x password y\n")
    path.chmod(0o600)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("NETRC", raising=False)
    if place == "NETRC":
        monkeypatch.setenv("NETRC", str(path))
    ours = provider.headers("our-own-key")
    with listening() as seen:
        headers = sent_by(seen, Transport(seen.url, ours))
        assert {name: headers[name] for name in ours} == ours
        assert headers["Authorization"] == ours.get("Authorization")


def test_a_cookie_that_an_endpoint_sets_is_not_sent_back() -> None:
    with listening(headers={"Set-Cookie": "session=1"}) as seen:
        transport = Transport(seen.url, {})
        sent_by(seen, transport)
        assert "Cookie" not in sent_by(seen, transport)


def test_a_redirect_carries_no_key_to_another_host() -> None:
    with listening() as elsewhere, listening(307, {"Location": f"{elsewhere.url}/v1/x"}) as seen:
        with pytest.raises(ConfigurationError, match="redirects"):
            Transport(seen.url, {"Authorization": "Bearer our-own-key"}).post("v1/x", {})
        assert len(seen.requests) == 1 and not elsewhere.requests


def test_a_proxy_of_the_environment_is_used_with_its_credentials(monkeypatch):
    for name in ("HTTP_PROXY", "no_proxy", "NO_PROXY", "all_proxy", "ALL_PROXY"):
        monkeypatch.delenv(name, raising=False)
    with listening() as proxy, listening() as direct:
        monkeypatch.setenv("http_proxy", proxy.url.replace("//", "//user:word@"))
        headers = sent_by(proxy, Transport("http://models.example", {"Authorization": "Bearer our-own-key"}))
        assert proxy.requests[0][0] == "POST http://models.example/v1/x HTTP/1.1"
        assert headers["Proxy-Authorization"] == "Basic dXNlcjp3b3Jk"
        assert headers["Authorization"] == "Bearer our-own-key"
        monkeypatch.setenv("no_proxy", "127.0.0.1")
        assert "Proxy-Authorization" not in sent_by(direct, Transport(direct.url, {}))


def test_the_password_of_a_proxy_never_shows(monkeypatch):
    monkeypatch.setenv("http_proxy", "http://user:pass-word@proxy:no-port")
    with pytest.raises(VcageError) as caught:
        Transport("http://models.example", {}, sleep=lambda _: None).post("v1/x", {})
    assert "pass-word" not in str(caught.value) and "proxy" in caught.value.hint


def test_the_bundle_of_certificates_of_the_environment_is_used(tmp_path: Path, monkeypatch):
    monkeypatch.setenv("REQUESTS_CA_BUNDLE", str(tmp_path / "missing.pem"))
    with pytest.raises(ConfigurationError, match=r"missing\.pem"):
        Transport("https://127.0.0.1:9", {}).post("v1/x", {})
