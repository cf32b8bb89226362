from __future__ import annotations

import json
import logging
import os
import shlex

import pytest

from vcage.base.errors import ConfigurationError, MissingKey
from vcage.models.gemini import GEMINI
from vcage.models.keys import find_key, key_file, require_key
from vcage.models.openai import OPENAI
from vcage.models.providers import found_keys


def test_the_projects_own_variable_comes_before_the_providers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GEMINI_API_KEY", "theirs")
    monkeypatch.setenv("VCAGE_GEMINI_API_KEY", "ours")
    assert find_key(GEMINI) == ("ours", "VCAGE_GEMINI_API_KEY")


def test_googles_other_variable_is_read_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GOOGLE_API_KEY", "key")
    assert find_key(GEMINI) == ("key", "GOOGLE_API_KEY")


def test_the_key_file_is_read_last() -> None:
    key_file().write_text(json.dumps({"openai": "from-file"}))
    assert find_key(OPENAI) == ("from-file", str(key_file()))


def test_a_key_file_that_windows_saved_is_read() -> None:
    key_file().write_bytes(b'\xef\xbb\xbf{\r\n"openai": "from-file"\r\n}\r\n')
    assert find_key(OPENAI) == ("from-file", str(key_file()))


@pytest.mark.parametrize("mode", [0o640, 0o604, 0o620, 0o666])
def test_a_key_file_readable_by_others_is_reported_once_with_the_command(mode: int, caplog) -> None:
    key_file().write_text(json.dumps({"openai": "very-secret"}))
    key_file().chmod(mode)
    with caplog.at_level(logging.WARNING):
        assert find_key(OPENAI) and find_key(GEMINI) is None
    (told,) = (record.getMessage() for record in caplog.records)
    assert shlex.join(["chmod", "600", str(key_file())]) in told and "very-secret" not in told


def test_a_private_key_file_is_not_reported(caplog) -> None:
    key_file().write_text(json.dumps({"openai": "from-file"}))
    key_file().chmod(0o600)
    with caplog.at_level(logging.WARNING):
        assert find_key(OPENAI)
    assert not caplog.records


def test_a_damaged_key_file_names_the_line_and_no_key() -> None:
    key_file().write_text('{"openai": "very-secret",\n "very-secret": 1, "very-secret": 2}')
    with pytest.raises(ConfigurationError, match="line 2") as caught:
        find_key(OPENAI)
    assert "very-secret" not in str(caught.value.as_record())


def test_a_pipe_is_no_key_file() -> None:
    os.mkfifo(key_file())
    with pytest.raises(ConfigurationError, match="does not hold keys"):
        find_key(OPENAI)


def test_found_keys_names_places_and_never_a_key(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENROUTER_API_KEY", "secret")
    assert found_keys() == {"openrouter": "OPENROUTER_API_KEY"}


def test_a_missing_key_says_where_to_put_it() -> None:
    with pytest.raises(MissingKey) as caught:
        require_key(OPENAI)
    assert "VCAGE_OPENAI_API_KEY" in caught.value.hint and str(key_file()) in caught.value.hint


@pytest.mark.parametrize("text", ["{", "[]", '{"openai": 3}', "[" * 200_000])
def test_a_damaged_key_file_is_named(text: str) -> None:
    key_file().write_text(text)
    with pytest.raises(ConfigurationError, match=str(key_file())):
        find_key(OPENAI)


@pytest.mark.parametrize("key", ["SEKR\u00c9T-\u2192", "two\nlines", "two words"])
def test_an_invalid_key_is_refused_by_the_name_of_its_place(key: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VCAGE_OPENAI_API_KEY", key)
    with pytest.raises(ConfigurationError, match="the key for openai in VCAGE_OPENAI_API_KEY") as caught:
        require_key(OPENAI)
    assert not any(part in str(caught.value.as_record()) for part in key.split())


def test_a_base_url_with_a_password_is_refused_without_showing_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VCAGE_OPENAI_BASE_URL", "http://user:pass-word@127.0.0.1:9/v1")
    with pytest.raises(ConfigurationError, match="VCAGE_OPENAI_BASE_URL holds a user or password") as caught:
        OPENAI.connect("key")
    assert "pass-word" not in str(caught.value.as_record())


def test_a_base_url_with_a_key_in_its_query_is_refused_without_showing_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VCAGE_OPENAI_BASE_URL", "http://127.0.0.1:9/v1?key=very-secret")
    with pytest.raises(ConfigurationError, match="VCAGE_OPENAI_BASE_URL holds a query") as caught:
        OPENAI.connect("key")
    assert "very-secret" not in str(caught.value.as_record())
