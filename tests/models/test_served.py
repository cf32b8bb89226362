"""What endpoints say that they serve, in the shapes of the four services."""

from __future__ import annotations

from datetime import date

import pytest

from vcage.base.errors import ConfigurationError, EndpointFailed
from vcage.models.served import Served, not_served


class Lists:
    """A transport whose GET answers with the given objects, by path."""

    base_url = "http://here"

    def __init__(self, **lists: object):
        self.lists = lists

    def get_json(self, path: str) -> object:
        if path not in self.lists:
            raise EndpointFailed("gone")
        return self.lists[path]


GEMINI = {"models": [{"name": "models/gemini-pro-latest"}, {"name": "models/gemini-nano-banana-2.1"}]}
OPENAI = {"data": [{"id": "gpt-6.1-terra"}, {"id": "gpt-image-2", "shutdown_date": "2027-01-10"}]}
OPENROUTER = {"data": [{"id": "google/gemini-nano-banana-2.1", "expiration_date": None}]}
ANTHROPIC = {
    "data": [
        {"id": "claude-sonnet-5-5", "lifecycle": "active", "retires_at": None},
        {"id": "claude-opus-4-5", "lifecycle": "deprecated", "retires_at": "2026-12-01T00:00:00Z"},
        {"id": "claude-opus-4", "lifecycle": "retired", "retires_at": "2026-05-01T00:00:00Z"},
    ]
}


@pytest.mark.parametrize(
    ("listed", "there", "gone"),
    [
        (GEMINI, "gemini-pro-latest", "gemini-3-pro-preview"),
        (OPENAI, "gpt-image-2", "gpt-image-1"),
        (OPENROUTER, "~google/gemini-pro-latest", "google/gemini-2.5-flash-image"),
        (ANTHROPIC, "claude-opus-4-5", "claude-opus-4"),
    ],
)
def test_the_listed_models_of_an_endpoint_are_served(listed: object, there: str, gone: str):
    served = Served.at(Lists(models=listed), ["models"])
    assert served.has(there) and not served.has(gone)


def test_a_model_that_ends_within_sixty_days_is_reported():
    served = Served.at(Lists(models=OPENAI, more=ANTHROPIC), ["models", "more"])
    assert served.ends("gpt-image-2", date(2026, 11, 24)) == date(2027, 1, 10)
    assert served.ends("gpt-image-2", date(2026, 11, 1)) is None
    assert served.ends("claude-opus-4-5", date(2026, 11, 24)) == date(2026, 12, 1)
    assert served.ends("gpt-6.1-terra", date(2026, 11, 24)) is None


def test_an_unserved_model_is_reported_with_the_nearest_served_ones_first():
    error = not_served("openai:gpt-image-1", "gpt-image-1", Lists(models=OPENAI), ["models"])
    assert error is not None
    assert "openai does not serve gpt-image-1; it serves gpt-image-2, gpt-6.1-terra" in error.message
    assert "VCAGE_OPENAI_TEXT_MODEL" in error.hint


def test_a_model_is_not_reported_where_the_endpoint_lists_none():
    assert not_served("openai:x", "x", Lists(), ["models"]) is None
    with pytest.raises(ConfigurationError, match="lists no models"):
        Served.at(Lists(models={"object": "list"}), ["models"])
