"""Pages of HTML from Jinja templates, each a file beside the module that fills it."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import jinja2


def rendered(template: Path, values: Mapping[str, Any]) -> str:
    """Fill a template; a name missing from ``values`` raises."""
    return _compiled(template).render(values)


@cache
def _compiled(template: Path) -> jinja2.Template:
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["percent"] = _percent
    return environment.from_string(template.read_text(encoding="utf-8"))


def _percent(share: float) -> str:
    return f"{100 * share:.2f} %"
