"""Start descriptions are true in every layout of a run, from the placement to the episodes."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from tests.run_folders import OPTIONS
from vcage.base.errors import InfeasibleScene, InputFileError, ModelRefused
from vcage.base.files import RunFolder, read_json, write_json
from vcage.base.pictures import read_labels
from vcage.episodes import starts
from vcage.episodes.layouts import Layouts, NoLayout
from vcage.episodes.starts import Starts
from vcage.models.rules.reasoner import OfflineReasoner
from vcage.plans.relations import holds
from vcage.runs.context import StageContext
from vcage.schema.goals import AskedGoal, Description, Goal, Reading
from vcage.schema.plan import Plan, Relation, SelectedAsset, Selection
from vcage.schema.randomisation import WorldRanges
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask, Subtasks
from vcage.sim.robots import load_randomisation
from vcage.stages import inpaint_plan, match, optimize, search_subtasks, select_place
from vcage.tasks.described import require_settled, untrue

pytestmark = pytest.mark.slow

TEXT = "Put the block on the left plate"
LEFT = Description(subject="plate_white", relation="left_of", reference="plate_blue", words="the left plate")
PLATES = [
    SelectedAsset(asset="block", variant="red", role="content"),
    SelectedAsset(asset="plate", variant="white", role="receptacle"),
    SelectedAsset(asset="plate", variant="blue", role="context"),
]
ONTO_WHITE = Goal(subject="block_red", relation="on", reference="plate_white")


class Scripted(OfflineReasoner):
    """A reasoner that chooses these objects and reads these goals and descriptions, and plans by the rules."""

    provider = "scripted"

    def __init__(self, chosen: Sequence[SelectedAsset], goal: Goal, *descriptions: Description):
        self.chosen, self.goal, self.descriptions = list(chosen), goal, list(descriptions)

    def select_assets(self, instruction, catalogue, rng, check, scene="table") -> Selection:
        selection = Selection(objects=self.chosen)
        if complaints := check(selection):
            raise ModelRefused("; ".join(complaints))
        return selection

    def read_goals(self, asked) -> Reading:
        goal = AskedGoal(goal=self.goal, step=1, words=asked.instruction)
        return Reading(goals=[goal], descriptions=self.descriptions)


def placed(folder: Path, text: str, reasoner: Scripted, seed: int = 0) -> tuple[RunFolder, StageContext]:
    run, context = RunFolder(folder), StageContext("offline")
    context.models = replace(context.models, reasoner=reasoner)
    select_place.execute(run, select_place.Options(instruction=text, seed=seed), context)
    return run, context


@dataclass(frozen=True)
class LaidOut:
    """A run up to its sub-tasks."""

    run: RunFolder
    context: StageContext

    @property
    def scene(self) -> Scene:
        return Scene.read(self.run.layout)

    @property
    def relations(self) -> list[Relation]:
        return Plan.read(self.run.plan).relations

    @property
    def chain(self) -> list[Subtask]:
        record = Subtasks.read(self.run.subtasks)
        kept = {subtask.id: subtask for subtask in record.kept}
        return [kept[name] for name in record.chains[0].subtasks]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> LaidOut:
    run, context = placed(tmp_path_factory.mktemp("plates") / "run", TEXT, Scripted(PLATES, ONTO_WHITE, LEFT))
    for stage in (inpaint_plan, match, optimize, search_subtasks):
        stage.execute(run, OPTIONS, context)
    return LaidOut(run, context)


@pytest.mark.parametrize("seed", range(4))
def test_the_drawn_placement_has_the_described_plate_on_the_left(tmp_path, seed):
    run, _ = placed(tmp_path / "run", TEXT, Scripted(PLATES, ONTO_WHITE, LEFT), seed)
    scene = Scene.read(run.scene)
    white, blue = scene.object("plate_white").aabb, scene.object("plate_blue").aabb
    assert holds("left_of", white, blue) and scene.descriptions == [LEFT]


def test_contradictory_descriptions_are_refused_by_name_before_anything_is_written(tmp_path):
    back = LEFT.model_copy(update={"subject": "plate_blue", "reference": "plate_white", "words": "left"})
    with pytest.raises(InfeasibleScene, match="the white plate is to the left of the blue plate") as caught:
        placed(tmp_path / "run", TEXT, Scripted(PLATES, ONTO_WHITE, LEFT, back))
    assert caught.value.details["objects"] == ["plate_blue", "plate_white"]
    assert not (tmp_path / "run" / "place").exists()


def test_the_plan_says_it_and_the_optimised_layout_keeps_it(made):
    assert Relation(subject="plate_white", relation="left_of", reference="plate_blue") in made.relations
    assert untrue(made.scene, made.context.objects(made.scene)) == []


@pytest.mark.parametrize(("side", "word"), [("left_of", "left"), ("right_of", "right"), ("in_front_of", "front")])
def test_a_plate_described_by_a_side_of_the_table_is_optimised_into_that_third(tmp_path, side, word):
    said = Description(subject="plate_white", relation=side, reference="table", words=f"the {word} plate")
    text = f"Put the block on the {word} plate"
    run, context = placed(tmp_path / "run", text, Scripted(PLATES[:2], ONTO_WHITE, said))
    for stage in (inpaint_plan, match, optimize):
        stage.execute(run, OPTIONS, context)
    scene = Scene.read(run.layout)
    assert untrue(scene, context.objects(scene)) == []


def test_every_layout_of_an_episode_keeps_it_even_where_the_plan_does_not_say_so(made):
    source = Layouts(made.scene, [], made.chain, made.context)
    for seed in range(3):
        layout = source.draw(np.random.default_rng(seed))
        there = [o.moved(layout.poses[o.id]) for o in made.context.objects(made.scene)]
        assert untrue(made.scene, there) == []


def test_layouts_against_the_description_are_refused_and_counted(made, monkeypatch):
    source = Layouts(made.scene, made.relations, made.chain, made.context)
    swapped = {o.id: o.pose for o in made.context.objects(made.scene)}
    swapped |= {"plate_white": swapped["plate_blue"], "plate_blue": swapped["plate_white"]}
    monkeypatch.setattr(source, "_solved", lambda _: swapped)
    with pytest.raises(NoLayout) as caught:
        source.draw(np.random.default_rng(0), draws=2)
    (reason,) = caught.value.details["refused"]
    assert "it is not so that the white plate is to the left of the blue plate" in reason


def test_small_shifts_that_make_it_false_are_not_taken(made, monkeypatch):
    def swapped(objects, rng):
        poses = {o.id: o.pose for o in objects}
        return poses | {"plate_white": poses["plate_blue"], "plate_blue": poses["plate_white"]}

    monkeypatch.setattr(starts, "shifted_poses", swapped)
    drawn = Starts(made.scene, None, made.chain, _nothing_else(), made.context).draw(np.random.default_rng(0))
    assert untrue(drawn.scene, list(drawn.objects.values())) == []


def _nothing_else() -> WorldRanges:
    return load_randomisation("none").world


def test_a_start_that_settles_against_the_description_is_no_start(made):
    objects = {o.id: o for o in made.context.objects(made.scene)}
    swapped = [
        objects["plate_white"].moved(objects["plate_blue"].pose),
        objects["plate_blue"].moved(objects["plate_white"].pose),
        objects["block_red"],
    ]
    records = [o.record.model_copy(update={"pose": o.record.pose.of(o.pose)}) for o in swapped]
    scene = made.scene.model_copy(update={"objects": records})
    models = made.context.physical_models(scene)
    with pytest.raises(InfeasibleScene, match="in the start of the episode it is not so that the white plate"):
        require_settled(scene, models, swapped, "the start of the episode", None)


def test_a_scene_edited_against_the_description_is_refused_by_field(made, tmp_path):
    shutil.copytree(made.run.root, tmp_path / "run")
    run = RunFolder(tmp_path / "run")
    path = run.layout
    data = read_json(path)
    data["descriptions"][0]["relation"] = "right_of"
    write_json(path, data)
    with pytest.raises(InputFileError, match=r"descriptions\.0.*it is not true where the objects stand"):
        optimize.EDITABLE.accepted(run, path, [path.name], tmp_path, made.context)


def test_a_goal_edited_to_another_plate_than_the_described_one_is_refused(made, tmp_path):
    shutil.copytree(made.run.root, tmp_path / "run")
    run = RunFolder(tmp_path / "run")
    path = run.layout
    data = read_json(path)
    data["goals"][0]["goal"]["reference"] = "plate_blue"
    write_json(path, data)
    with pytest.raises(InputFileError, match=r"scene\.json: field goals: 'the left …' is said, but"):
        optimize.EDITABLE.accepted(run, path, [path.name], tmp_path, made.context)


# --- what starts in a drawer -------------------------------------------------------------------------------

CABINET = "cabinet_one_drawer_oak"
DRAWER = Description(subject="battery_pack_copper", relation="inside", reference=CABINET, part="drawer", words="x")
ON_TABLE = Goal(subject="battery_pack_copper", relation="on", reference="table")
IN_DRAWER = [
    SelectedAsset(asset="battery_pack", variant="copper", role="content"),
    SelectedAsset(asset="cabinet_one_drawer", variant="oak", role="context"),
]


def test_an_object_described_in_a_drawer_starts_there_and_no_picture_shows_it(tmp_path):
    run, _ = placed(tmp_path / "run", "x", Scripted(IN_DRAWER, ON_TABLE, DRAWER))
    scene = Scene.read(run.scene)
    pack = scene.object("battery_pack_copper")
    assert (pack.container, pack.container_part) == (CABINET, "drawer")
    shown = np.unique(read_labels(run.file(scene.pictures["segmentation"])))
    assert scene.segmentation_ids[pack.id] not in shown


def test_it_goes_where_the_cabinet_goes_and_is_taken_out_of_the_open_drawer(tmp_path):
    run, context = placed(tmp_path / "run", "x", Scripted(IN_DRAWER, ON_TABLE, DRAWER))
    for stage in (inpaint_plan, match, optimize, search_subtasks):
        stage.execute(run, OPTIONS, context)
    made = LaidOut(run, context)
    assert [subtask.template for subtask in made.chain] == ["open", "set_down"]
    layout = Layouts(made.scene, made.relations, made.chain, context).draw(np.random.default_rng(0))
    there = [o.moved(layout.poses[o.id]) for o in context.objects(made.scene)]
    assert untrue(made.scene, there) == []
    assert not np.allclose(layout.poses[CABINET].p, made.scene.object(CABINET).pose.position, atol=0.005)


def test_a_start_too_small_for_its_object_is_refused_with_the_sizes(tmp_path):
    pan = SelectedAsset(asset="frying_pan", variant="black", role="content")
    goal, said = (one.model_copy(update={"subject": "frying_pan_black"}) for one in (ON_TABLE, DRAWER))
    with pytest.raises(InfeasibleScene, match=r"frying_pan_black has no room where it starts, in the drawer of .* cm"):
        placed(tmp_path / "run", "x", Scripted([pan, IN_DRAWER[1]], goal, said))


def test_a_description_with_an_unknown_object_is_refused_by_name(tmp_path):
    said = LEFT.model_copy(update={"reference": "plate_pink"})
    with pytest.raises(InfeasibleScene, match="there is no object 'plate_pink'"):
        placed(tmp_path / "run", TEXT, Scripted(PLATES, ONTO_WHITE, said))
