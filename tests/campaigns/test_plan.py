"""The plan of a campaign: its cells and jobs, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.campaigns.stubbed import TASKS, plan
from vcage.base.errors import InputFileError, SchemaMismatch
from vcage.campaigns.impossible import require_readable
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
    ("keys", "said"),
    [
        ({"episode": 3}, "field episode: unknown; did you mean episodes"),
        ({"episodes": 0}, "field episodes: got 0; expected more than 0"),
        ({"episodes": True}, "field episodes: got True; expected a whole number"),
        ({"episodes": 10**8}, "field episodes: 100,000,000 jobs in all; expected at most"),
        ({"layouts": ["random"]}, "field layouts.0: got 'random'; expected 'varied' or 'fixed'"),
        ({"looks": [False]}, "field looks.0: got False; expected text, in quotes"),
        ({"robots": "dual_panda"}, "field robots: got 'dual_panda'; expected a list"),
        ({"gates": {"acceptance": 1.5, "after": 4}}, "field gates.acceptance: got 1.5; expected at most 1"),
        ({"gates": {"acceptence": 0.5, "after": 4}}, "gates.acceptence: unknown; did you mean acceptance"),
        ({"limits": {"per_minute": {"gemin": 3}}}, "field limits.per_minute: got .*gemin.*; expected some of gemini"),
        ({"limits": None}, "field limits: got nothing; expected keys with values"),
        ({"seeds": -1}, "field seeds: got -1; expected more than 0, or a list"),
        ({"seeds": [1, -2]}, "field seeds.1: got -2; expected 0 or more"),
        ({"seeds": [1, 2, 1]}, "field seeds.2: 1 is the name of seeds.0, too"),
        ({"robots": ["three_arms"]}, "field robots.0: unknown robot 'three_arms'"),
        ({"looks": ["dark"]}, "field looks.0: unknown randomisation 'dark'"),
        ({"looks": ["mine.yml"]}, "field looks.0: .*mine.yml does not exist"),
        ({"tasks": ["Put two blocks on the plate"]}, "field tasks.0: got .*; expected keys with values"),
        ({"tasks": [{"scene": "moon", "all_subtasks": True}]}, "field tasks.0.scene: unknown scene 'moon'"),
        ({"tasks": [{"scene": "office_desk"}]}, "field tasks.0: nothing to do; expected one of instruction, goals"),
        ({"tasks": [TASKS[0] | {"all_subtasks": True}]}, "field tasks.0: all_subtasks runs every sub-task"),
        ({"tasks": [{"instruction": " "}]}, "field tasks.0: the instruction is empty"),
        ({"tasks": [{"goals": ["marker inside"]}]}, "field tasks.0: .*marker inside"),
        ({"tasks": [TASKS[0] | {"objects": "block"}]}, "field tasks.0: objects needs goals"),
        ({"tasks": TASKS + TASKS}, "field tasks.1: 'blocks' is the name of tasks.0, too"),
        ({"options": {"fsp": 10}}, "field options.fsp: unknown option 'fsp'"),
        ({"options": {"fps": 7}}, "field options.fps: .*7"),
        ({"options": {"fps": [5, 10]}}, "field options.fps: fps takes one value, not"),
        ({"options": {"crf": "small"}}, "field options.crf: .*small"),
        ({"options": {"episodes": 7}}, "field options.episodes: episodes does not belong here"),
        ({"options": {"crf_of": "runs/blocks"}}, "field options.crf_of: unknown option 'crf_of'"),
        ({"options": {"models": "agent"}}, "field options.models: agent cannot answer in a campaign"),
        ({"layouts": ["fixed"], "looks": ["full"]}, "field looks.0: .*layouts that are drawn, not layouts fixed"),
    ],
)
def test_an_impossible_plan_is_refused_with_file_and_field(tmp_path: Path, keys: dict[Any, Any], said: str):
    with pytest.raises(SchemaMismatch, match=said) as refused:
        plan(tmp_path, **keys)
    assert "PLAN.yml" in refused.value.message


def test_all_wrong_fields_are_named_at_once_and_the_file_once(tmp_path: Path):
    (tmp_path / "PLAN.yml").write_text("name: x\ntaks: []\nepisodes: many\nlimits: {attemps: 3}\n")
    with pytest.raises(SchemaMismatch, match="4 fields are wrong") as refused:
        Plan.load(tmp_path / "PLAN.yml")
    assert sorted(refused.value.details["fields"]) == ["episodes", "limits.attemps", "taks", "tasks"]
    assert "field taks: unknown; did you mean tasks?" in refused.value.message
    assert refused.value.message.count("PLAN.yml") == 1


def test_all_impossible_values_are_named_at_once(tmp_path: Path):
    with pytest.raises(SchemaMismatch) as refused:
        plan(tmp_path, robots=["panda"], looks=["dark"], options={"fsp": 10, "seed": 3}, tasks=[{"scene": "moon"}])
    named = ["robots.0", "options.fsp", "options.seed", "looks.0", "tasks.0.scene", "tasks.0"]
    assert refused.value.details["fields"] == named


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "got nothing; expected name, tasks, episodes"),
        ("- a\n", "got a list; expected name, tasks, episodes"),
        ("name: x\ntasks:\n\t- a\n", "line 3: found character '.t'"),
        ("name: x\nname: y\n", "line 2: the key 'name' stands twice"),
    ],
)
def test_a_file_that_is_no_plan_is_refused_with_its_path(tmp_path: Path, text: str, said: str):
    (tmp_path / "PLAN.yml").write_text(text)
    with pytest.raises(InputFileError, match=said) as refused:
        Plan.load(tmp_path / "PLAN.yml")
    assert str(tmp_path / "PLAN.yml") in refused.value.message


@pytest.mark.parametrize(
    ("task", "said"),
    [
        ({"goals": ["marker inside packagng_box"]}, r"tasks.0.goals: unknown object .*'packagng_box'"),
        ({"goals": ["plate inside block"]}, r"tasks.0.goals: .*nothing can achieve"),
        ({"goals": ["mug on plate with the middle arm"]}, r"tasks.0.goals: unknown arm"),
        ({"instruction": "Write me a poem"}, r"tasks.0.instruction: 'Write' .* is not understood"),
    ],
)
def test_a_task_that_no_job_could_begin_is_refused(tmp_path: Path, task: dict[str, Any], said: str):
    found = plan(tmp_path, tasks=[task], options={"models": "offline"})
    with pytest.raises(SchemaMismatch, match=said):
        require_readable(tmp_path / "PLAN.yml", found)


@pytest.mark.parametrize("instruction", ["把苹果放到盘子上", "Write me a poem"])
def test_no_agent_is_offered_where_the_rules_do_not_read_an_instruction(tmp_path: Path, instruction: str):
    found = plan(tmp_path, tasks=[{"instruction": instruction}], options={"models": "offline"})
    with pytest.raises(SchemaMismatch) as refused:
        require_readable(tmp_path / "PLAN.yml", found)
    assert "let a model read it: options.models gemini, openai, anthropic or ollama" in refused.value.hint


def test_tasks_that_were_checked_before_and_instructions_for_a_model_are_not_read(tmp_path: Path):
    tasks = [{"instruction": "Write me a poem"}]
    found = plan(tmp_path, tasks=tasks, options={"models": "offline"})
    require_readable(tmp_path / "PLAN.yml", found, earlier=found)
    require_readable(tmp_path / "PLAN.yml", plan(tmp_path, tasks=tasks, options={"models": "gemini"}))


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


def test_options_with_another_place_in_a_plan_are_options_of_the_chain():
    assert ELSEWHERE.keys() | set(REFUSED) <= set(ChainOptions.__dataclass_fields__)
