"""What is simulated otherwise in an episode: all that is said stays true, and what there is no room for is counted."""

from __future__ import annotations

import numpy as np
import pytest

from tests.runs import Finished
from vcage.models.rules.bystanders import asked_by
from vcage.schema.randomisation import WorldDraw, WorldRanges
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtasks
from vcage.stages import starts as starts_module
from vcage.stages.inputs import read_plan
from vcage.stages.starts import Start, Starts
from vcage.stages.worlds import drawn_models, other_phrases, reworded
from vcage.tasks.scene_objects import SceneObject

RANGES = WorldRanges(
    variants=True, clutter=(2, 6), table_height=(-0.03, 0.0), mass=(0.7, 1.4), friction=(0.7, 1.2), start=0.05
)


@pytest.fixture(scope="module")
def scene(finished: Finished) -> Scene:
    return Scene.read(finished.run.layout)


def made(finished: Finished, scene: Scene, ranges: WorldRanges) -> Starts:
    record = Subtasks.read(finished.run.subtasks)
    kept = {subtask.id: subtask for subtask in record.kept}
    relations = read_plan(finished.run, Scene.read(finished.run.scene), finished.context).relations
    return Starts(scene, relations, [kept[name] for name in record.chains[0].subtasks], ranges, finished.context)


@pytest.fixture(scope="module")
def drawn(finished: Finished, scene: Scene) -> list[Start]:
    source = made(finished, scene, RANGES)
    return [source.draw(np.random.default_rng(seed)) for seed in range(3)]


def test_the_instruction_asks_for_the_same_in_every_world(finished, scene, drawn):
    def asked(objects: list[SceneObject]) -> object:
        return asked_by(str(scene.instruction), {o.id: o.kind() for o in objects}, {})

    for start in drawn:
        assert asked(list(start.objects.values())) == asked(finished.context.objects(scene))


def test_things_are_called_as_they_look(finished, scene, drawn):
    for start in drawn:
        for name in start.world.variants:
            now = start.scene.object(name)
            assert now.variant == start.world.variants[name]
            assert finished.context.asset(now).variant.colour in now.phrase


def test_what_is_recorded_as_clutter_stands_in_the_scene_and_touches_nothing(scene, drawn):
    own = {o.id for o in scene.objects}
    for start in drawn:
        assert {o.id for o in start.scene.objects} - own == start.world.clutter.keys()
        assert len(start.world.clutter) <= start.world.clutter_drawn
        assert all(start.scene.object(name).role == "context" for name in start.world.clutter)


def test_everything_stands_on_a_table_that_is_lower_by_whole_centimetres(scene, drawn):
    for start in drawn:
        height = scene.table.height + start.world.table_height
        assert start.scene.table.height == pytest.approx(height)
        assert 100 * start.world.table_height == pytest.approx(round(100 * start.world.table_height))
        assert all(o.pose.p[2] == pytest.approx(height, abs=0.005) for o in start.objects.values())


def test_mass_and_friction_are_those_of_the_models(drawn):
    for start in drawn:
        for name, model in start.models.items():
            assert model.total_mass == pytest.approx(start.world.mass[name])
            assert model.friction == start.world.friction[name]


def test_moving_parts_weigh_as_much_more_as_the_body(finished):
    model = finished.context.library.asset("cabinet_one_drawer").model
    heavier = drawn_models({"cabinet": model}, WorldDraw(mass={"cabinet": 2 * model.total_mass}))["cabinet"]
    assert [link.mass for link in heavier.links] == pytest.approx([2 * link.mass for link in model.links])
    assert heavier.mass == pytest.approx(2 * model.mass)


def test_the_arms_start_beside_home(drawn):
    for start in drawn:
        offsets = np.concatenate(list(start.world.start.values()))
        assert 0 < np.abs(offsets).max() <= 0.05


def test_plain_ranges_change_nothing(finished, scene):
    start = made(finished, scene, WorldRanges()).draw(np.random.default_rng(0))
    assert start.world == WorldDraw()
    assert start.phrases == {}


def test_where_there_is_no_room_for_clutter_there_is_none_and_that_is_told(finished, scene, monkeypatch):
    monkeypatch.setattr("vcage.stages.layouts.CLUTTER_GAP", 0.6)
    start = made(finished, scene, WorldRanges(clutter=(4, 4))).draw(np.random.default_rng(0))
    assert start.drawn
    assert (start.world.clutter, start.world.clutter_drawn) == ({}, 4)
    assert start.world.short_of_room


def test_red_for_blue_and_blue_for_red_are_exchanged_at_once(finished, scene):
    first, second, *_ = [o for o in scene.objects if o.role == "content"]
    swapped = [first.model_copy(update={"phrase": second.phrase}), second.model_copy(update={"phrase": first.phrase})]
    subtask = next(s for s in Subtasks.read(finished.run.subtasks).kept if s.object == first.id)
    said = reworded(subtask, other_phrases(scene, swapped))
    assert second.phrase in said.text
    assert first.phrase not in said.text


def test_less_is_drawn_of_what_takes_room_when_layouts_are_refused():
    world = WorldDraw(variants={"a": "red"}, clutter={f"c{n}": "cup" for n in range(6)}, clutter_drawn=6)
    assert [(len(w.clutter), w.variants) for w, _ in starts_module._eased(world)] == [
        (6, {"a": "red"}),
        (3, {"a": "red"}),
        (0, {}),
    ]
