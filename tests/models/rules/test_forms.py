"""Every form of docs/instructions.md is read in a scene that is selected for it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from benchmarks._sentences.sources import REPOSITORY, of_libero, of_pages
from tests.models.rules.scenes import read
from vcage.models.rules.grammar import FORMS

PAGE = (REPOSITORY / "docs/instructions.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"^> (.+)$", PAGE, re.MULTILINE)
DEMO = re.findall(r"^DEMO := (.+)$", Path(REPOSITORY / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)


def test_the_page_has_examples_and_the_makefile_a_demonstration() -> None:
    assert len(EXAMPLES) > 40 and len(DEMO) == 1


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("sentence", [*EXAMPLES, *DEMO])
def test_every_example_of_the_page_is_read_in_its_selected_scene(sentence: str, seed: int) -> None:
    chosen, reading = read(sentence, seed)
    spoken = {name for asked in reading.goals for name in (asked.goal.subject, asked.goal.reference)}
    assert len(spoken) > 0 and len(chosen.objects) >= 1


@pytest.mark.parametrize("sentence", FORMS)
def test_every_form_that_an_error_offers_is_read(sentence: str) -> None:
    assert read(sentence)[1].goals


@pytest.mark.parametrize("sentence", sorted({one.text for one in [*of_pages(REPOSITORY), *of_libero()]}))
def test_every_sentence_of_the_pages_and_of_the_whole_runs_is_read(sentence: str) -> None:
    assert read(sentence)[1].goals
