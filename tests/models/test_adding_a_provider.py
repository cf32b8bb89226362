"""docs/adding-a-provider.md works as it is written."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from tests.model_server import ModelServer
from tests.models.catalogue import CATALOGUE, unchecked
from vcage.models import registry
from vcage.models.providers import PROVIDERS
from vcage.models.registry import Choice, build_models

PAGE = Path(__file__).parents[2] / "docs" / "adding-a-provider.md"
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.parametrize(
    ("number", "service", "model"), [(0, "openai", "gpt-6.1-terra"), (1, "anthropic", "claude-sonnet-5-5")]
)
def test_a_provider_of_the_page_chooses_objects(
    number: int, service: str, model: str, server: ModelServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    module: dict[str, object] = {}
    exec(EXAMPLES[number], module)
    monkeypatch.setitem(PROVIDERS, "acme", module["ACME"])
    monkeypatch.setattr(registry, "CHOICES", (*registry.CHOICES, "acme"))
    monkeypatch.setenv("VCAGE_ACME_BASE_URL", server.base_urls[service])
    monkeypatch.setenv("VCAGE_ACME_TEXT_MODEL", model)
    monkeypatch.setenv("ACME_API_KEY", server.key)
    models = build_models(Choice("acme"))
    chosen = models.reasoner.select_assets(
        "Put the blocks on the plate", CATALOGUE, np.random.default_rng(0), unchecked
    )
    assert models.reasoner.provider == f"acme:{model}"
    assert {"block", "plate"} <= {one.asset for one in chosen.objects}
