"""The stage that searches sub-tasks: scripts that parse, refusals with reasons, a chain for the instruction."""

from __future__ import annotations

import ast
import re

import numpy as np
import pytest

from tests.example_scenes import scene_of, thing
from tests.run_folders import OPTIONS, copied
from vcage.base.attempts import LIMITS
from vcage.base.errors import NoFeasibleTask, SchemaMismatch
from vcage.base.files import read_json, write_json
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtasks
from vcage.stages import search_subtasks
from vcage.tasks.search import judging
from vcage.tasks.synthesis import load_script


def test_every_kept_subtask_has_a_script_that_parses_and_loads(finished):
    record = Subtasks.read(finished.run.subtasks)
    assert record.kept
    for subtask in record.kept:
        path = finished.run.root / subtask.script
        ast.parse(path.read_text(encoding="utf-8"))
        assert load_script(path).values["TEXT"] == subtask.text


def test_the_chain_moves_every_content_once(finished):
    record, scene = Subtasks.read(finished.run.subtasks), Scene.read(finished.run.layout)
    by_id = {subtask.id: subtask for subtask in record.kept}
    contents = [o.id for o in scene.objects if o.role == "content"]
    assert sorted(by_id[i].object for i in record.chains[0].subtasks) == sorted(contents)
    assert {by_id[i].receptacle for i in record.chains[0].subtasks} == {
        o.id for o in scene.objects if o.role == "receptacle"
    }


def test_a_misfit_is_refused_with_its_measure(finished):
    record = Subtasks.read(finished.run.subtasks)
    assert any(re.search(r"\d cm", refusal.reason) for refusal in record.refused)
    assert record.candidates > len(record.kept)


def test_where_the_receptacle_is_out_of_reach_nothing_is_chained_and_nothing_written(finished, tmp_path):
    run = copied(finished.run, tmp_path / "run", before="search_subtasks")
    scene = read_json(run.layout)
    for record in scene["objects"]:
        record["pose"]["position"][1] += 5.0
    write_json(run.layout, scene)
    with pytest.raises(NoFeasibleTask, match="block"):
        search_subtasks.execute(run, OPTIONS, finished.context)
    assert not run.subtasks.parent.exists()


def test_a_layout_of_another_version_is_refused_by_name(finished, tmp_path):
    run = copied(finished.run, tmp_path / "run", before="search_subtasks")
    write_json(run.layout, {**read_json(run.layout), "schema": "vcage.scene/0"})
    with pytest.raises(SchemaMismatch, match=r"vcage\.scene/0.*expected 'vcage\.scene/1'"):
        search_subtasks.execute(run, OPTIONS, finished.context)


def test_the_judge_of_pairs_sees_the_instruction(finished, tmp_path, monkeypatch):
    run = copied(finished.run, tmp_path / "run", before="search_subtasks")
    reasoner, shown = finished.context.models.reasoner, []
    judge = reasoner.judge_pairs

    def noted(questions, instruction=None):
        shown.append(instruction)
        return judge(questions, instruction)

    monkeypatch.setattr(reasoner, "judge_pairs", noted, raising=False)
    search_subtasks.execute(run, OPTIONS, finished.context)
    assert shown == [OPTIONS.instruction]


@pytest.mark.parametrize(("reasons", "searches"), [("abcd", LIMITS.searches), ("aaaa", LIMITS.same_searches)])
def test_a_search_in_vain_is_repeated_until_it_fails_for_the_same_reason(
    reasons: str, searches: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    said = iter(reasons)

    def none(*_: object) -> None:
        raise NoFeasibleTask(f"no chain, because of {next(said)}")

    monkeypatch.setattr(search_subtasks, "find_subtasks", none)
    scene = scene_of([thing("block")])
    with pytest.raises(NoFeasibleTask, match=f"because of {reasons[searches - 1]}"):
        search_subtasks._search(scene, [thing("block")], judging(False), np.random.default_rng(0))
    assert "".join(said) == reasons[searches:]
