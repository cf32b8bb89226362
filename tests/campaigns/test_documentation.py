"""The plan of docs/campaigns.md is whole and possible."""

from __future__ import annotations

import re
from pathlib import Path

from tests.run_folders import REPOSITORY
from vcage.campaigns.plan import Gates, Limits, Plan, Task

TEXT = (REPOSITORY / "docs" / "campaigns.md").read_text(encoding="utf-8")


def test_the_plan_of_the_page_is_possible_and_has_every_key(tmp_path: Path):
    (block,) = re.findall(r"^```yaml\n(.*?)^```", TEXT, re.DOTALL | re.MULTILINE)
    (tmp_path / "PLAN.yml").write_text(block)
    plan = Plan.load(tmp_path / "PLAN.yml")
    assert len(plan.cells) == 3 * 2 * 1 * 2 * 2
    assert len(plan.jobs()) == 20 * len(plan.cells)
    for kind in (Plan, Limits, Gates):
        for name in kind.model_fields.keys() - {"schema_id"}:
            assert re.search(rf"^ *{name}:", block, re.MULTILINE), name
    for name in Task.model_fields.keys() - {"starts"}:
        assert re.search(rf"\b{name}:", block), name
