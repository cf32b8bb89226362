"""The plan of a campaign: its cells and jobs, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.campaigns.stubbed import TASKS, plan
from vcage.base.errors import SchemaMismatch, UnknownName, UsageError, VcageError
from vcage.campaigns.options import ELSEWHERE, REFUSED, options_of_plan
from vcage.campaigns.plan import Plan
from vcage.stages.chain import ChainOptions


def test_every_combination_of_the_axes_is_a_cell(tmp_path: Path):
    found = plan(
        tmp_path,
        tasks=[*TASKS, {"scene": "office_desk", "all_subtasks": True}],
        robots=["dual_panda", "aloha_agilex"],
        looks=["none", "light"],
        seeds=[3, 7],
    )
    assert len(found.cells) == 2 * 2 * 2 * 2
    assert found.cells[0].id == "blocks_dual-panda_varied_none_3"
    assert found.cells[-1].id == "office-desk-subtasks_aloha-agilex_varied_light_7"


def test_jobs_share_the_episodes_of_a_cell_and_the_first_of_each_cell_comes_first(tmp_path: Path):
    found = plan(tmp_path, seeds=2, episodes=7, episodes_per_job=3)
    assert [(job.cell.seed, job.number, job.episodes) for job in found.jobs()] == [
        *[(0, 0, 3), (1, 0, 3)],
        *[(0, 1, 3), (1, 1, 3)],
        *[(0, 2, 1), (1, 2, 1)],
    ]
    assert [found.index_of(job) for job in found.jobs()] == list(range(6))


def test_no_seed_is_drawn_twice_in_a_hundred_thousand_jobs(tmp_path: Path):
    found = plan(tmp_path, seeds=100, episodes=1000, episodes_per_job=1)
    seeds = {job.seed for job in found.jobs()}
    assert len(seeds) == 100_000
    assert max(seeds) < 2**63


def test_seeds_depend_on_plan_cell_and_number_alone(tmp_path: Path):
    before = {job.id: job.seed for job in plan(tmp_path, seeds=2).jobs()}
    grown = plan(tmp_path, seeds=3, episodes=4, looks=["light", "none"])
    assert before.items() <= {job.id: job.seed for job in grown.jobs()}.items()
    other = {job.id: job.seed for job in plan(tmp_path, seeds=2, seed=1).jobs()}
    assert not set(other.values()) & set(before.values())


def test_the_options_of_a_job_are_those_of_its_cell_and_of_the_plan(tmp_path: Path):
    found = plan(tmp_path, layouts=["fixed"], looks=["none"], options={"fps": 5, "max-loss": 0.2, "keep_raw": True})
    job = found.jobs()[0]
    options = found.options_of(job)
    assert (options.instruction, options.layout, options.randomise) == (TASKS[0]["instruction"], "fixed", "none")
    assert (options.fps, options.compression.max_loss, options.keep_raw) == (5, 0.2, True)
    assert (options.seed, options.episodes, options.workers) == (job.seed, 1, 1)


def test_a_file_of_ranges_is_found_beside_the_plan(tmp_path: Path):
    light = Path("assets/randomisation/light.yml").read_text()
    (tmp_path / "mine.yml").write_text(light.replace("name: light", "name: mine"))
    assert plan(tmp_path, looks=["mine.yml"]).cells[0].look == str(tmp_path / "mine.yml")


def test_a_long_instruction_gives_a_short_folder_name(tmp_path: Path):
    long = "Put the red block on the plate and then the blue block into the bowl, please"
    name = plan(tmp_path, tasks=[{"instruction": long}]).cells[0].task.name
    assert name.startswith("put-the-red-block-on-the-plate")
    assert len(name) < 50


@pytest.mark.parametrize(
    ("keys", "kind", "said"),
    [
        ({"episode": 3}, SchemaMismatch, "field episode: Extra inputs"),
        ({"episodes": 0}, SchemaMismatch, "field episodes: .*greater than 0"),
        ({"layouts": ["random"]}, SchemaMismatch, "field layouts.0: .*'varied' or 'fixed'"),
        ({"gates": {"acceptance": 1.5, "after": 4}}, SchemaMismatch, "field gates.acceptance"),
        ({"limits": {"per_minute": {"gemin": 3}}}, SchemaMismatch, "per_minute names gemin; expected some of"),
        ({"seeds": -1}, SchemaMismatch, "field seeds"),
        ({"robots": ["three_arms"]}, UnknownName, "unknown robot 'three_arms'"),
        ({"looks": ["dark"]}, UnknownName, "unknown randomisation 'dark'"),
        ({"tasks": [{"scene": "moon", "all_subtasks": True}]}, UnknownName, "unknown scene 'moon'"),
        ({"tasks": [{"scene": "office_desk"}]}, UsageError, "there is no instruction"),
        ({"tasks": [{"goals": ["marker inside"]}]}, UsageError, "marker inside"),
        ({"tasks": TASKS + TASKS}, UsageError, "two cells are called blocks_dual-panda_varied_light_0"),
        ({"options": {"fsp": 10}}, UnknownName, "unknown field of options 'fsp'"),
        ({"options": {"fps": 7}}, UsageError, "field options.fps: .*7"),
        ({"options": {"crf": "small"}}, UsageError, "field options.crf: .*small"),
        ({"options": {"episodes": 7}}, UsageError, "field options.episodes: not here"),
        ({"options": {"crf_of": "runs/blocks"}}, UnknownName, "unknown field of options 'crf_of'"),
        ({"options": {"models": "agent"}}, UsageError, "agent cannot answer in a campaign"),
        ({"layouts": ["fixed"], "looks": ["full"]}, UsageError, "layouts that are drawn"),
    ],
)
def test_an_impossible_plan_is_refused_with_file_and_field(
    tmp_path: Path, keys: dict[str, Any], kind: type[VcageError], said: str
):
    with pytest.raises(kind, match=said) as refused:
        plan(tmp_path, **keys)
    assert "PLAN.yml" in refused.value.message


def test_a_plan_survives_being_written_and_read_again(tmp_path: Path):
    found = plan(tmp_path, seeds=[1], gates={"acceptance": 0.5, "after": 2}, options={"fps": 5})
    path = tmp_path / "again.yml"
    path.write_text(yaml.safe_dump(found.model_dump(mode="json", by_alias=True, exclude_defaults=True)))
    assert Plan.load(path) == found


def test_options_of_any_stage_are_taken_as_the_command_line_takes_them():
    options = options_of_plan({"weights": "collision=2", "pixel-format": "yuv420p", "review": False, "retries": 0})
    assert options.weights.collision == 2
    assert (options.compression.pixel_format, options.review, options.retries) == ("yuv420p", False, 0)


@pytest.mark.parametrize(
    "options", [{}, {"crf": 20}, {"crf": "lossless"}, {"crf": None}, {"scope": "episode"}, {"scope": "camera"}]
)
def test_a_plan_knows_without_the_stages_whether_jobs_share_crfs(tmp_path: Path, options: dict[str, Any]):
    found = plan(tmp_path, options=options)
    assert found.shares_crfs == found.chain_options.compression.agrees


def test_options_that_a_plan_says_elsewhere_are_options_of_the_chain():
    assert ELSEWHERE.keys() | set(REFUSED) <= set(ChainOptions.__dataclass_fields__)
