"""What is edited by hand is noticed, checked, recorded as edited and carried on; or refused with file and field."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.run_folders import INSTRUCTION, OPTIONS, QUICK_VIDEOS, Finished, command, copied, digests
from vcage.base.errors import InputFileError, MissingStage, SchemaMismatch, StaleStage
from vcage.base.files import RunFolder, read_json, sha256_file, write_json
from vcage.base.pictures import read_picture, write_picture
from vcage.episodes.store import log_path
from vcage.models.protocols import EditRequest
from vcage.runs.edits import SEAL, edited_scripts, edits
from vcage.runs.running import accept_edits, run_stage
from vcage.runs.stage import StageOptions
from vcage.schema.episodes import BY_HAND, Episodes, Verdicts
from vcage.schema.plan import Plan
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtasks
from vcage.stages import chain, collect, compress, inpaint_plan, match, optimize, search_subtasks, select_place, verify


@pytest.fixture
def run(finished: Finished, tmp_path: Path) -> RunFolder:
    return copied(finished.run, tmp_path / "run")


def edit(path: Path, change: Callable[[Any], Any]) -> None:
    data = read_json(path)
    change(data)
    write_json(path, data)


def again(stage: Any, run: RunFolder, finished: Finished, **changes: Any) -> Any:
    options: StageOptions = stage.Options(**{name: getattr(OPTIONS, name) for name in vars(stage.Options())} | changes)
    return run_stage(stage, run, options, finished.context)


def _first(found: Any) -> Any:
    """The first verdict on the first episode."""
    return next(iter(found["episodes"].values()))[0]


def moved(number: int = 0, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Callable[[Any], None]:
    """An edit that moves an object, and does not mind its box."""

    def change(scene: Any) -> None:
        position = scene["objects"][number]["pose"]["position"]
        scene["objects"][number]["pose"]["position"] = [position[0] + x, position[1] + y, position[2] + z]

    return change


# --- noticed -------------------------------------------------------------------------------------------


def test_outputs_of_the_stages_count_as_unedited(finished):
    assert {path.name: edits(path) for path in finished.run.documents} == {p.name: [] for p in finished.run.documents}


def test_another_layout_of_the_same_json_is_no_edit(run):
    run.layout.write_text(run.layout.read_text().replace("\n", " "))
    assert edits(run.layout) == []


def test_an_edit_of_the_json_or_of_a_picture_is_noticed(run):
    edit(run.plan, lambda plan: plan.update(text="Otherwise."))
    picture = run.plan.with_name("target.png")
    write_picture(picture, 255 - read_picture(picture))
    assert edits(run.plan) == ["plan.json", "target.png"]


def test_a_missing_record_of_the_output_names_the_stage(run):
    run.layout.with_name(SEAL).unlink()
    with pytest.raises(MissingStage, match=r"written\.json") as caught:
        edits(run.layout)
    assert caught.value.maker == "optimize"


@pytest.mark.parametrize(("stage", "picture"), [(select_place, "source.png"), (optimize, "top.png")])
def test_an_edit_undone_from_a_copy_edits_only_the_json_and_redraws_its_pictures(run, finished, stage, picture):
    job = stage.job(run, OPTIONS, finished.context)
    shown, copy = job.output.with_name(picture), job.output.read_bytes()
    before = read_picture(shown).astype(float)
    edit(job.output, moved(x=-0.01, y=-0.01))
    accept_edits(job, finished.context, force=False)
    assert np.abs(read_picture(shown) - before).max() > 50
    job.output.write_bytes(copy)
    assert edits(job.output) == ["scene.json"]
    accept_edits(job, finished.context, force=False)
    differs = np.abs(read_picture(shown) - before) > 10
    assert differs.mean() < 1e-4  # settled again, it lies as before except for a few pixels of an edge


# --- carried on ----------------------------------------------------------------------------------------


def test_an_edited_layout_has_figures_boxes_and_pictures_of_its_own(run, finished):
    top = sha256_file(run.layout.with_name("top.png"))
    before = Scene.read(run.layout)
    edit(run.layout, moved(x=-0.01, y=-0.01))
    done = again(optimize, run, finished)
    assert not done.fresh and done.record.edited == ["scene.json"]
    assert "cost_after" not in done.record.checks and "relations_kept" in done.record.checks
    assert done.record.objects[0].aabb[0][0] == pytest.approx(before.objects[0].aabb[0][0] - 0.01, abs=1e-3)
    assert sha256_file(run.layout.with_name("top.png")) != top
    assert edits(run.layout) == []


def test_the_stage_after_an_edit_takes_it_over(run, finished):
    edit(run.layout, moved(x=-0.01, y=-0.01))
    record = again(search_subtasks, run, finished, force=True).record
    assert Scene.read(run.layout).edited == ["scene.json"]
    assert record.provenance.inputs == {"optimize/scene.json": sha256_file(run.layout)}


def test_an_edited_scene_is_photographed_again(run, finished):
    before = sha256_file(run.scene.with_name("source.png"))
    edit(run.scene, moved(x=-0.01))
    again(inpaint_plan, run, finished, force=True)
    assert sha256_file(run.scene.with_name("source.png")) != before
    assert Scene.read(run.scene).edited == ["scene.json"]


class Blackens:
    """An editor whose pictures are black."""

    provider = "blackener"

    def rearrange(self, request: EditRequest) -> np.ndarray:
        return np.zeros_like(request.picture)


def test_an_edited_plan_is_redrawn_and_the_drawing_model_is_reported(run, finished, monkeypatch):
    monkeypatch.setattr(finished.context, "models", replace(finished.context.models, editor=Blackens()))
    edit(run.plan, lambda plan: plan.update(text="Otherwise."))
    again(match, run, finished, force=True)
    plan = Plan.read(run.plan)
    assert plan.edited == ["plan.json"] and plan.provenance.providers["editor"] == "blackener"
    assert read_picture(run.plan.with_name("target.png")).max() == 0


def test_an_edited_picture_is_not_drawn_over(run, finished):
    picture = run.plan.with_name("target.png")
    write_picture(picture, read_picture(picture) // 2)
    edit(run.plan, lambda plan: plan.update(text="Otherwise."))
    mine = sha256_file(picture)
    assert again(inpaint_plan, run, finished).record.edited == ["plan.json", "target.png"]
    assert sha256_file(picture) == mine


def test_edited_matches_are_measured_by_the_plan_again(run, finished):
    edit(run.matches, lambda found: found["matches"][0].update(position=[0.3, 0.2]))
    record = again(match, run, finished).record
    assert record.edited == ["matches.json"] and record.checks["relations_shown"] < 1


def test_words_of_an_edited_sub_task_reach_its_script(run, finished):
    edit(run.subtasks, lambda found: found["kept"][0].update(text="Do it gently."))
    record = again(search_subtasks, run, finished).record
    assert "TEXT = 'Do it gently.'" in (run.root / record.kept[0].script).read_text()


def test_an_edited_script_changes_no_record_and_is_kept(run, finished):
    script = run.root / Subtasks.read(run.subtasks).kept[0].script
    script.write_text(script.read_text() + "\n# mine\n")
    assert not again(search_subtasks, run, finished).record.edited
    edit(run.subtasks, lambda found: found["kept"][0].update(text="Do it gently."))
    assert again(search_subtasks, run, finished).record.edited == ["subtasks.json"]
    assert script.read_text().endswith("# mine\n") and list(edited_scripts(run.subtasks)) == [script.name]


def test_an_edited_script_is_not_thrown_away_where_another_layout_asks_for_other_sub_tasks(run, finished):
    script = run.root / Subtasks.read(run.subtasks).kept[0].script
    script.write_text(script.read_text() + "\n# mine\n")
    edit(run.layout, moved(x=-0.01, y=-0.01))
    with pytest.raises(StaleStage) as told:
        again(search_subtasks, run, finished)
    assert told.value.details["edited"] == [script.name]


def test_a_verdict_that_was_changed_by_hand_counts(run, finished):
    edit(run.verdicts, lambda found: _first(found).update(accepted=False))
    before = Verdicts.read(run.verdicts)
    record = again(verify, run, finished).record
    assert record.edited == ["verdicts.json"] and list(record.refused.values()) == ["refused by hand"]
    assert next(iter(record.episodes.values()))[0].provider == BY_HAND
    assert record.critic == before.critic, "which is what the critic said"


def test_a_reason_given_by_hand_is_kept(run, finished):
    said = {"accepted": False, "reason": "it is upside down"}
    edit(run.verdicts, lambda found: _first(found).update(said))
    assert list(again(verify, run, finished).record.refused.values()) == ["it is upside down"]


def test_an_episode_may_be_refused_by_hand(run, finished):
    edit(run.episodes, lambda found: found["episodes"][0].update(accepted=False, reason="it looks odd"))
    again(verify, run, finished, force=True)
    assert Episodes.read(run.episodes).edited == ["episodes.json"]
    assert Episodes.read(run.episodes).episodes[0].reason == "it looks odd"
    assert Verdicts.read(run.verdicts).episodes == {}


def test_a_whole_run_goes_on_from_an_edit_but_does_not_throw_episodes_away(run, finished):
    edit(run.layout, moved(x=-0.01, y=-0.01))
    with pytest.raises(StaleStage, match=r"episodes\.json") as caught:
        chain.run_chain(run, OPTIONS, finished.context)
    assert caught.value.maker == "collect" and "by itself" in caught.value.hint
    assert Scene.read(run.layout).edited == ["scene.json"]
    assert Subtasks.read(run.subtasks).provenance.inputs == {"optimize/scene.json": sha256_file(run.layout)}


def test_a_whole_run_names_the_command_that_keeps_the_edit(run, capsys):
    edit(run.layout, moved(x=-0.01, y=-0.01))
    words = ("--models", "offline", "--episodes", "1", "--fps", "5", "--workers", "1")
    answer = command(capsys, "run", INSTRUCTION, "--out", run, *words)
    assert answer.code == 3 and " collect --run " in answer.record["next"]
    assert answer.record["next"].endswith(" --force") and " run " not in answer.error["hint"].partition(": ")[2]


@pytest.mark.slow
def test_verdicts_that_were_changed_by_hand_are_kept_when_episodes_come(run, finished):
    edit(run.verdicts, lambda found: _first(found).update(accepted=False))
    done = chain.run_chain(run, replace(OPTIONS, episodes=2), finished.context)
    record = done["verify"].record
    assert record.edited == ["verdicts.json"]
    assert record.refused == {"episodes/episode_000000.hdf5": "refused by hand"} and len(record.episodes) == 2
    assert [dataset.episodes for dataset in done["export"].record.datasets] == [1, 1, 1]


def test_verdicts_changed_by_hand_are_kept_when_an_episode_is_edited(run, finished):
    edit(run.verdicts, lambda found: _first(found).update(accepted=False))
    edit(run.episodes, lambda found: found["episodes"][0].update(reason="as I saw it"))
    record = again(verify, run, finished).record
    assert list(record.refused.values()) == ["refused by hand"]


def test_verdicts_of_other_episodes_lead_to_verify_and_not_to_force(run, capsys):
    edit(run.verdicts, lambda found: _first(found).update(accepted=False))
    edit(run.episodes, lambda found: found["episodes"][0].update(reason="as I saw it"))
    answer = command(capsys, "compress", "--run", run, *QUICK_VIDEOS)
    assert answer.code == 3 and answer.error["code"] == "stale_stage"
    assert answer.record["next"].split()[-3:] == ["verify", "--run", str(run)] and "--force" not in answer.error["hint"]


def test_force_discards_an_edit(run, finished):
    edit(run.layout, moved(z=0.5))
    record = again(optimize, run, finished, force=True).record
    assert record.edited == [] and record.objects == Scene.read(finished.run.layout).objects


def test_the_result_states_the_edits_the_models_and_the_pictures(run, capsys):
    edit(run.matches, lambda found: found["matches"][0].update(note="I looked"))
    answer = command(capsys, "match", "--run", run, "--models", "offline").record
    assert answer["edited"] == ["matches.json"]
    assert answer["answered_by"] == {"detector": "offline", "embedder": "offline"}
    assert answer["pictures"] == [str(run.matches.with_name("overlay.png"))]


# --- lost ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("stage", "name"),
    [(inpaint_plan, "target.png"), (optimize, "top.png"), (select_place, "source.png"), (match, "overlay.png")],
)
def test_a_finished_stage_that_lost_a_file_makes_it_again(run, finished, stage, name):
    path = stage.job(run, OPTIONS, finished.context).output.with_name(name)
    path.unlink()
    assert again(stage, run, finished).fresh
    assert sha256_file(path) == sha256_file(finished.run.root / run.relative(path))


def test_where_an_edit_would_be_lost_the_missing_file_is_named(run, finished):
    edit(run.layout, moved(x=-0.01, y=-0.01))
    again(optimize, run, finished)
    run.layout.with_name("top.png").unlink()
    with pytest.raises(InputFileError, match=r"top\.png is gone, which optimize had written") as caught:
        again(optimize, run, finished)
    assert caught.value.maker == "optimize" and Scene.read(run.layout).edited == ["scene.json"]


def test_a_missing_log_does_not_repeat_the_collection(run, finished):
    log_path(run.episodes.parent).unlink()
    with pytest.raises(InputFileError, match=r"log\.jsonl is gone, which collect had written"):
        again(collect, run, finished)


# --- refused -------------------------------------------------------------------------------------------


def _onto_another(scene: Any) -> None:
    scene["objects"][0]["pose"]["position"] = scene["objects"][1]["pose"]["position"]


IMPOSSIBLE = {
    "an object in another": (_onto_another, r"objects\.\d\.pose: \w+ overlaps"),
    "in the air": (moved(z=0.1), r"objects\.0\.pose: \w+ does not stay there: it moves by 1\d\d mm"),
    "under the table": (moved(z=-0.1), r"objects\.0\.pose: \w+ does not stay there"),
    "beside the table": (moved(x=-5.0), r"objects\.0\.pose: \w+ reaches .* beyond the table's edge"),
    "an unknown asset": (lambda s: s["objects"][0].update(asset="blok"), r"objects\.0\.asset: 'blok'; expected block"),
    "an unknown look": (lambda s: s["objects"][0].update(variant="plaid"), r"objects\.0\.variant: 'plaid'; expected"),
    "an unknown robot": (lambda s: s.update(robot="r2d2"), r"robot: 'r2d2'; expected"),
    "parts it has not": (
        lambda s: s["objects"][0].update(joints=[0.1]),
        r"objects\.0\.joints: 1 positions; expected 0",
    ),
    "a goal of nobody": (lambda s: s["goals"][0]["goal"].update(subject="cat"), r"goals\.0\.goal: there is no cat"),
    "a goal of itself": (
        lambda s: s["goals"][0]["goal"].update(reference=s["goals"][0]["goal"]["subject"]),
        r"goals\.0\.goal\.subject: '\w+'; expected not its own reference",
    ),
    "what is inside the table": (
        lambda s: s["goals"][0]["goal"].update(relation="inside", reference="table"),
        r"goals\.0\.goal\.reference: 'table'; expected",
    ),
    "words that nobody said": (
        lambda s: s["goals"][0].update(words="Cook"),
        r"goals\.0\.words: 'Cook'; expected words of",
    ),
    "what the instruction does not say": (
        lambda s: s["goals"][0]["goal"].update(relation="beside"),
        rf"goals: .*; expected what the instruction says: '{INSTRUCTION}'",
    ),
    "an arm that nobody asked for": (
        lambda s: s["goals"][0].update(arm="left"),
        "goals: a goal names the left arm, but the instruction does not; expected",
    ),
    "no goals": (lambda s: s.update(goals=[]), "goals: none; expected those of the instruction"),
    "another instruction": (
        lambda s: s.update(instruction="Cook the soup"),
        f'instruction: "Cook the soup"; expected "{INSTRUCTION}"',
    ),
    "a camera that looks elsewhere": (
        lambda s: s["top_camera"].update(fovy=0.1),
        r"top_camera\.fovy: 0\.1; expected 0\.51",
    ),
    "another table": (lambda s: s["table"].update(texture="nope"), r'table\.texture: "nope"; expected "grey_stone"'),
    "another workspace": (lambda s: s["workspace"].update(lower=[-0.1, -0.1]), r"workspace\.lower\.0: -0\.1; expected"),
    "nobody to leave alone": (lambda s: s.update(untouched=["cat"]), r"untouched\.0: 'cat'"),
    "a container it is not in": (
        lambda s: s["objects"][0].update(container=s["objects"][1]["id"]),
        r"objects\.0\.container: .*lies in or on no object; expected null",
    ),
}


@pytest.mark.parametrize("what", IMPOSSIBLE)
def test_a_layout_that_cannot_be_is_refused_by_field_and_nothing_changes(run, finished, what):
    change, complaint = IMPOSSIBLE[what]
    edit(run.layout, change)
    files = digests(run.root)
    with pytest.raises(InputFileError, match=rf"optimize/scene\.json: field {complaint}") as caught:
        again(search_subtasks, run, finished, force=True)
    assert caught.value.exit_code == 3
    assert digests(run.root) == files


def test_an_object_inside_another_must_be_declared_so(run, finished):
    scene = read_json(run.layout)
    plate = next(o for o in scene["objects"] if o["asset"] == "plate")
    block = next(o for o in scene["objects"] if o["asset"] == "block")
    x, y, z = plate["pose"]["position"]
    block["pose"]["position"] = [x, y, z + 0.0066]
    write_json(run.layout, scene)
    with pytest.raises(InputFileError, match=r"container: None, but block_\w+ lies in or on plate_white"):
        again(search_subtasks, run, finished, force=True)


def _chain(*names: str) -> Callable[[Any], None]:
    return lambda found: found["chains"][0].update(subtasks=list(names))


SUBTASKS = {
    "no step": (_chain(), "chains.0.subtasks"),
    "no sub-task": (lambda found: found.update(kept=[]), "chains: .*expected kept sub-tasks .there are none., got "),
    "a refused one of an unknown kind": (
        lambda found: found["refused"][0].update(template="fly"),
        "refused.0.template: 'fly'; expected one of place, ",
    ),
    "an unknown step": (_chain("fly"), "chains: .*expected kept sub-tasks .* got 'fly'"),
    "too few steps": (
        lambda found: found["chains"][0]["subtasks"].pop(),
        r"chains\.0\.subtasks: .* is not brought about .*; expected a chain that does what is asked",
    ),
    "an unknown arm": (lambda found: found["kept"][0]["grasps"][0].update(arm="third"), r"kept\.0\.grasps\.0\.arm"),
    "an unknown contact": (lambda found: found["kept"][0]["grasps"][0].update(contact=99), r"grasps\.0\.contact: 99"),
    "an unknown object": (lambda found: found["kept"][0].update(object="cat"), r"kept\.0\.object: 'cat'; expected"),
    "into itself": (
        lambda found: found["kept"][0].update(receptacle=found["kept"][0]["object"]),
        r"kept\.0\.\w+: '?\w+'?; expected",
    ),
    "a placing that pushes": (
        lambda found: found["kept"][0].update(template="push"),
        r"kept\.0\.template: push does not do that with \w+: \w+ on plate_white; expected place",
    ),
    "a placing that opens": (
        lambda found: found["kept"][0].update(template="open"),
        r"kept\.0\.template: open does not do that",
    ),
    "another goal than it has": (
        lambda found: found["kept"][0]["goals"][0].update(relation="beside"),
        r"kept\.0: place does not do that with \w+: \w+ beside plate_white; expected what place can do",
    ),
    "an unknown place": (lambda found: found["kept"][0].update(functional_point=9), r"functional_point: 9; expected"),
    "a goal of nobody": (
        lambda found: found["kept"][0]["goals"][0].update(subject="cat"),
        r"goals\.0: there is no cat",
    ),
    "a script elsewhere": (lambda found: found["kept"][0].update(script="/etc/x.py"), r"kept\.0\.script"),
    "another instruction": (lambda found: found.update(instruction="Fly"), 'instruction: "Fly"; expected'),
    "another name of a chain": (
        lambda found: found["chains"][0].update(text="Fly"),
        rf'chains\.0\.text: "Fly"; expected "{INSTRUCTION}"',
    ),
    "a wording that asks for less": (
        lambda found: found["chains"][0].update(wordings=["Put the red block on the plate."]),
        r"chains\.0\.wordings\.0: 'Put the red block on the plate\.'; expected a sentence that asks for the same",
    ),
    "the same chain twice": (
        lambda found: found["chains"].append(found["chains"][0]),
        r"chains\.1: the same as another; expected each chain once",
    ),
}


@pytest.mark.parametrize("what", SUBTASKS)
def test_sub_tasks_that_cannot_be_are_refused_by_field_before_anything_is_collected(run, finished, what):
    change, complaint = SUBTASKS[what]
    shutil.rmtree(run.episodes.parent)
    edit(run.subtasks, change)
    with pytest.raises((InputFileError, SchemaMismatch), match=rf"subtasks\.json: field {complaint}|{complaint}"):
        again(collect, run, finished)
    assert not run.episodes.parent.exists()


@pytest.mark.parametrize(("field", "value"), [("text", ""), ("relations", [])])
def test_a_plan_without_words_or_relations_is_refused_by_field(run, finished, field, value):
    edit(run.plan, lambda plan: plan.update({field: value}))
    with pytest.raises(SchemaMismatch, match=rf"plan\.json: field {field}: "):
        again(match, run, finished, force=True)


def test_an_empty_record_is_part_of_what_was_written(run, finished):
    edit(run.compression, lambda found: found.pop("left_out"))
    with pytest.raises(InputFileError, match=r"compression\.json: field left_out: nothing; expected \{\}"):
        again(compress, run, finished)


def test_where_nothing_may_be_edited_no_edit_is_declared(run, finished):
    edit(run.compression, lambda found: found.update(edited=["compression.json"]))
    with pytest.raises(InputFileError, match=r"compression\.json: field edited"):
        again(compress, run, finished)


def test_a_plan_that_points_to_a_picture_elsewhere_is_refused(run, finished):
    edit(run.plan, lambda plan: plan.update(target="place/source.png"))
    with pytest.raises(InputFileError, match="field target"):
        again(match, run, finished, force=True)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (lambda e: e["verdicts"][0].update(accepted=False), "accepted: true; expected false"),
        (lambda e: e["verdicts"].pop(), "verdicts: 1 of them; expected 2 of them, as it was written"),
        (lambda e: e.update(file=None), "file: null; expected "),
        (lambda e: e.update(file="episodes/episode_000001.hdf5"), "file: "),
        (lambda e: e.update(chain=4), "chain: 4; expected 0"),
        (lambda e: e.update(index=1), "index: 1; expected 0"),
        (lambda e: e.update(frames=0), "frames: 0; expected "),
        (lambda e: e.update(seed=99), "seed: 99; expected 0"),
        (lambda e: e.update(attempts=70), "attempts: 70; expected "),
        (lambda e: e["goals_hold"].update(success=False), r"goals_hold\.success: false; expected true"),
    ],
)
def test_of_an_episode_a_hand_decides_whether_it_counts_and_nothing_else(run, finished, change, complaint):
    edit(run.episodes, lambda found: change(found["episodes"][0]))
    with pytest.raises(InputFileError, match=rf"episodes\.json: field episodes\.0\.{complaint}"):
        again(verify, run, finished, force=True)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (lambda found: found["episodes"].append(found["episodes"][0]), "episodes: 2 of them; expected 1"),
        (lambda found: found.update(attempts=1000), "attempts: 1000; expected "),
        (lambda found: found.update(acceptance={}), r"acceptance\.\S+: nothing; expected "),
        (lambda found: found["provenance"].pop("inputs"), r"provenance\.inputs\.\S+: nothing; expected "),
        (lambda found: found["critic"].update(judged=1000), r"critic\.judged: 1000; expected "),
    ],
)
def test_figures_of_a_collection_are_not_to_be_edited(run, finished, change, complaint):
    edit(run.episodes, change)
    with pytest.raises(InputFileError, match=rf"episodes\.json: field {complaint}"):
        again(verify, run, finished, force=True)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (lambda found: found.update(episodes={}), "episodes\\.episodes/episode_000000\\.hdf5: nothing; expected "),
        (lambda found: found["critic"].update(judged=1000), r"critic\.judged: 1000; expected "),
        (
            lambda found: _first(found).update(provider="me"),
            r'episodes\.\S+\.0\.provider: "me"',
        ),
    ],
)
def test_an_edit_of_verdicts_changes_only_the_acceptance(run, finished, change, complaint):
    edit(run.verdicts, change)
    with pytest.raises(InputFileError, match=rf"verdicts\.json: field {complaint}"):
        again(verify, run, finished)


@pytest.mark.parametrize("name", ["scene", "plan", "matches", "layout", "subtasks", "episodes", "verdicts"])
def test_where_a_file_comes_from_is_not_to_be_edited(run, finished, name):
    edit(getattr(run, name), lambda found: found["provenance"].update(seed=99))
    files = digests(run.root)
    with pytest.raises(InputFileError, match=rf"{getattr(run, name).name}: field provenance\.seed: 99; expected 0"):
        chain.run_chain(run, OPTIONS, finished.context)
    assert digests(run.root) == files


@pytest.mark.parametrize("kind", ["*-after-top.png", "*-background-top.png"])
def test_a_picture_that_was_recorded_is_evidence_and_not_to_be_edited(run, finished, kind):
    picture = next((run.episodes.parent / "critic").glob(kind))
    write_picture(picture, read_picture(picture) // 4)
    with pytest.raises(InputFileError, match=rf"{picture.name}: field \(whole file\): changed by hand") as caught:
        again(verify, run, finished, force=True)
    assert caught.value.maker == "collect"


def test_the_log_of_all_attempts_is_evidence_too(run, finished):
    log = log_path(run.episodes.parent)
    log.write_text(log.read_text().replace('"accepted":true', '"accepted":false'))
    with pytest.raises(InputFileError, match=r"log\.jsonl: field"):
        again(verify, run, finished, force=True)


def test_figures_of_the_compression_are_not_to_be_edited(run, finished):
    edit(run.compression, lambda found: found.update(reduction_raw=0.9999))
    with pytest.raises(InputFileError, match=r"compression\.json: field"):
        again(compress, run, finished)
