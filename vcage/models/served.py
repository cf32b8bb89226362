"""The models listed by an endpoint: ids change over time, so the error for a wrong one names the listed ones."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass, field
from datetime import date, timedelta
from typing import Any

from vcage.base.errors import ConfigurationError, ModelNotServed, VcageError
from vcage.models.transport import Transport

SOON = timedelta(days=60)
"""Models that end within this are reported."""

ALIAS = "~"
"""Beginning of ids that OpenRouter resolves itself, and does not list."""

LATEST = ":latest"
"""The tag that Ollama lists after a name, and takes where it is left out."""

MAX_NAMES = 12

_ENDS = ("shutdown_date", "expiration_date", "retires_at")
"""Fields of OpenAI, OpenRouter and Anthropic for the last day of a model; Gemini has none."""


@dataclass(frozen=True)
class Served:
    """The models of an endpoint.

    Args:
        models: id → its last day; None if it has none.
        modalities: id → its inputs, ``text`` and ``image``, if they are listed.
    """

    models: dict[str, date | None]
    modalities: dict[str, list[str]] = field(default_factory=dict)

    @classmethod
    def at(cls, transport: Transport, paths: Iterable[str]) -> Served:
        """The models that an endpoint lists at some paths.

        Raises:
            VcageError: it does not answer, or not with a list.
        """
        found: dict[str, date | None] = {}
        modalities: dict[str, list[str]] = {}
        for path in paths:
            data = transport.get_json(path)
            items = data.get("data", data.get("models"))
            if items is None and "data" in data:
                items = []  # Ollama's, where it has none
            if not isinstance(items, list):
                raise ConfigurationError(f"{transport.base_url}/{path} lists no models", hint="check the base URL")
            served = [item for item in items if isinstance(item, dict) and _is_served(item)]
            found |= dict(map(_entry, served))
            modalities |= {_entry(item)[0]: taken for item in served if (taken := _input_types(item)) is not None}
        return cls(found, modalities)

    def has(self, model: str) -> bool:
        """Check if a model is served, or an alias that only the endpoint knows."""
        return model.startswith(ALIAS) or model in self.models or model + LATEST in self.models

    def ends(self, model: str, today: date) -> date | None:
        """The last day of a model, if that is soon."""
        day = self.models.get(model)
        return day if day is not None and day - today <= SOON else None

    def nearest(self, model: str) -> list[str]:
        """Served ids, those with similar spelling first."""
        alike = difflib.get_close_matches(model, self.models, n=MAX_NAMES, cutoff=0.3)
        return [*alike, *sorted(self.models.keys() - set(alike))][:MAX_NAMES]


def not_served(provider: str, model: str, transport: Transport, paths: Iterable[str]) -> ModelNotServed | None:
    """The error about a model that an endpoint does not list; None if it does, or lists none."""
    try:
        served = Served.at(transport, paths)
    except VcageError:
        return None
    if served.has(model):
        return None
    names = served.nearest(model)
    name = provider.partition(":")[0]
    variable = f"VCAGE_{name.upper()}_TEXT_MODEL"
    return ModelNotServed(
        f"{name} does not serve {model}; it serves {', '.join(names) or 'none'}"
        + (f", … ({len(served.models)} in all)" if len(served.models) > len(names) else ""),
        hint=f"name one of them in {variable}, or …_IMAGE_MODEL for pictures, or let rules answer where the model is "
        "not there with --fallback offline",
        details={"model": model, "served": sorted(served.models)},
    )


def _is_served(item: dict[str, Any]) -> bool:
    return isinstance(item.get("id", item.get("name")), str) and item.get("lifecycle") != "retired"


def _entry(item: dict[str, Any]) -> tuple[str, date | None]:
    name = str(item.get("id", item.get("name"))).removeprefix("models/")
    stated = next((item[key] for key in _ENDS if isinstance(item.get(key), str)), "")
    try:
        return name, date.fromisoformat(stated[:10])
    except ValueError:
        return name, None


def _input_types(item: dict[str, Any]) -> list[str] | None:
    """Inputs of a model, as llama.cpp and OpenRouter list them."""
    stated = item.get("architecture")
    taken = stated.get("input_modalities") if isinstance(stated, dict) else None
    return taken if isinstance(taken, list) else None
