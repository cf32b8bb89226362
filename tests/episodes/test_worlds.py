"""Randomised worlds of an episode: all statements stay true, and objects without room are counted."""

from __future__ import annotations

import numpy as np
import pytest

from tests.run_folders import Finished
from vcage.base.errors import NoFeasibleTask
from vcage.base.words import look_words, tokens
from vcage.episodes import starts as starts_module
from vcage.episodes.layouts import EpisodeLayoutSettings
from vcage.episodes.starts import Start, Starts
from vcage.episodes.worlds import Worlds, drawn_models, other_phrases, reworded
from vcage.runs.inputs import read_plan
from vcage.schema.randomisation import WorldDraw, WorldRanges
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtasks

pytestmark = pytest.mark.slow

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


def worlds_of(
    finished: Finished, scene: Scene, instruction: str, ranges: WorldRanges, count: int = 6
) -> list[WorldDraw]:
    """Draw for the run's chain under another instruction."""
    record = Subtasks.read(finished.run.subtasks)
    kept = {subtask.id: subtask for subtask in record.kept}
    chain = [kept[name] for name in record.chains[0].subtasks]
    said = scene.model_copy(update={"instruction": instruction})
    source = Worlds(said, chain, finished.context)
    return [source.draw(ranges, np.random.default_rng(seed)) for seed in range(count)]


def test_a_look_that_the_instruction_names_is_neither_changed_nor_drawn(finished, scene):
    named = next(o for o in scene.objects if o.role == "content")
    colour = finished.context.asset(named).variant.colour
    drawn = worlds_of(finished, scene, f"Put the {colour} block on the plate", WorldRanges(variants=True), 20)
    assert any(world.variants for world in drawn)
    for world in drawn:
        assert named.id not in world.variants
        for name, variant in world.variants.items():
            look = finished.context.library.asset(scene.object(name).asset, variant).variant
            assert colour not in look_words(look.colour)


def test_where_everything_is_meant_there_is_no_clutter(finished, scene):
    assert any(world.clutter for world in worlds_of(finished, scene, "Put the blocks on the plate", RANGES))
    assert not any(world.clutter for world in worlds_of(finished, scene, "Everything goes on the plate", RANGES))


def test_no_clutter_falls_under_a_quantifier_of_the_instruction(finished, scene):
    drawn = worlds_of(finished, scene, "Put all the food on the plate", RANGES, 20)
    kinds = {kind for world in drawn for kind in world.clutter.values()}
    assert kinds
    assert not {"food", "fruit", "vegetable"} & {finished.context.library.entry(k).words.category for k in kinds}


def test_each_object_is_called_as_no_other_in_every_world(drawn):
    for start in drawn:
        phrases = [tuple(tokens(o.phrase)) for o in start.scene.objects]
        assert len(set(phrases)) == len(phrases)


def test_things_are_called_as_they_look(finished, scene, drawn):
    for start in drawn:
        for name in start.world.variants:
            now = start.scene.object(name)
            assert now.variant == start.world.variants[name]
            assert finished.context.asset(now).variant.colour in now.phrase


def test_recorded_clutter_stands_in_the_scene_and_touches_nothing(scene, drawn):
    own = {o.id for o in scene.objects}
    for start in drawn:
        assert {o.id for o in start.scene.objects} - own == start.world.clutter.keys()
        assert len(start.world.clutter) <= start.world.clutter_drawn
        assert all(start.scene.object(name).role == "context" for name in start.world.clutter)


def test_a_table_lower_by_whole_centimetres_carries_everything(scene, drawn):
    for start in drawn:
        height = scene.table.height + start.world.table_height
        assert start.scene.table.height == pytest.approx(height)
        assert 100 * start.world.table_height == pytest.approx(round(100 * start.world.table_height))
        assert all(o.pose.p[2] == pytest.approx(height, abs=0.005) for o in start.objects.values())


def test_mass_and_friction_match_the_models(drawn):
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


def test_clutter_without_room_is_dropped_and_reported(finished, scene, monkeypatch):
    monkeypatch.setattr("vcage.episodes.layouts.SETTINGS", EpisodeLayoutSettings(clutter_gap_m=0.6))
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


def test_refused_layouts_lead_to_less_clutter():
    world = WorldDraw(variants={"a": "red"}, clutter={f"c{n}": "cup" for n in range(6)}, clutter_drawn=6)
    assert [(len(w.clutter), w.variants) for w, _ in starts_module._eased(world)] == [
        (6, {"a": "red"}),
        (3, {"a": "red"}),
        (0, {}),
    ]


def test_where_small_shifts_break_the_chain_objects_stand_as_optimised(finished, scene, monkeypatch):
    own, proven = {o.id: o.pose.pose() for o in scene.objects}, starts_module.proven

    def as_optimised_only(chain, objects, *others):
        if any(not np.allclose(o.pose.p, own[o.id].p) for o in objects):
            raise NoFeasibleTask("shifted")
        return proven(chain, objects, *others)

    monkeypatch.setattr(starts_module, "proven", as_optimised_only)
    source = made(finished, scene, WorldRanges())
    source._relations = None
    drawn = source.draw(np.random.default_rng(0))
    assert all(np.allclose(o.pose.p, own[name].p) for name, o in drawn.objects.items())
