"""Outcomes are made until there is enough of every template."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace

import pytest

from benchmarks._critic.outcome import OutcomeRecord
from benchmarks._critic.quotas import Quotas, filled, lacking
from benchmarks._critic.scenes import Draw
from vcage.tasks.templates import TEMPLATES

DRAWS = [Draw("blocks", 0, "dual_panda", 3), Draw("kitchen", 4, "dual_panda", 3)]
GIVES = {"blocks": ("stack",), "kitchen": tuple(name for name in TEMPLATES if name != "stack")}
"""The outcomes that each scene gives."""


def outcome(template: str, success: bool, setting: str) -> OutcomeRecord:
    return OutcomeRecord(
        id="1", name="x", scene="s.json",
        setting=setting, part="tuning", template=template, text="Put it there.", goals=[],
        asset="cup", success=success, reason="because", kind="success", pictures={}, empty="e.png",
    )  # fmt: skip


class Maker:
    """Makes a success of each template of a scene, and a failure every second time."""

    def __init__(self) -> None:
        self.rounds: list[list[Draw]] = []

    def __call__(self, draws: Sequence[Draw], before: Sequence[OutcomeRecord]) -> list[OutcomeRecord]:
        self.rounds.append(list(draws))
        kinds = (True, False) if len(self.rounds) % 2 == 0 else (True,)
        return [
            outcome(template, success, draw.scene)
            for draw in draws
            for template in GIVES[draw.scene]
            if template in (draw.templates or TEMPLATES)
            for success in kinds
        ]


def test_scenes_are_drawn_again_until_there_is_enough() -> None:
    maker = Maker()
    records = filled(DRAWS, maker, Quotas(each=2, rounds=9))
    assert len(maker.rounds) == 4
    assert lacking(records, Quotas(each=2)) == {}
    assert [draw.seed for draw in maker.rounds[-1]] == [7, 7], "seeds that no draw had"


def test_only_scenes_with_missing_failures_are_redrawn() -> None:
    maker = Maker()

    def make(draws: Sequence[Draw], before: Sequence[OutcomeRecord]) -> list[OutcomeRecord]:
        full = [outcome(name, success, "kitchen") for name in GIVES["kitchen"] for success in (True, False)]
        return maker(draws, before) + ([] if before else full * 2)

    filled(DRAWS, make, Quotas(each=2, rounds=9))
    assert all(
        draws == [Draw("blocks", draws[0].seed, "dual_panda", 3, "all", ("stack",))] for draws in maker.rounds[1:]
    )


def test_failures_missing_after_the_last_round_are_reported(caplog: pytest.LogCaptureFixture) -> None:
    maker = Maker()
    with caplog.at_level(logging.WARNING):
        filled(DRAWS, maker, Quotas(each=20, rounds=1))
    assert len(maker.rounds) == 2
    assert "stack: 2 successes and 1 failures, of 20 each" in caplog.messages


def test_a_template_that_no_scene_gives_ends_nothing(caplog: pytest.LogCaptureFixture) -> None:
    maker = Maker()
    with caplog.at_level(logging.WARNING):
        filled(DRAWS[1:], maker, Quotas(each=1, rounds=9))
    assert len(maker.rounds) == 2
    assert "stack: 0 successes and 0 failures, of 1 each" in caplog.messages


def test_only_the_wanted_templates_are_drawn_again() -> None:
    maker = Maker()
    draws = [replace(draw, templates=("stack",)) for draw in DRAWS]
    records = filled(draws, maker, Quotas(each=2, rounds=9, templates=("stack",)))
    assert {draw.scene for later in maker.rounds[1:] for draw in later} == {"blocks"}
    assert {record.template for record in records} == {"stack"}
