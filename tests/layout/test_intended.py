from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.models.tabletop import BLOCKS, BOX, ERASER, HEIGHT, MARKERS, PLATE, Thing, scene_of
from vcage.base.geometry import Pose, boxes_overlap, wrap_angle
from vcage.layout.intended import IntendedLayout, intended_layout, supports_of
from vcage.layout.items import TableItem, item_of
from vcage.models.rules.layout import plan_layout
from vcage.objects.openings import Opening
from vcage.plans.kept import relations_kept
from vcage.plans.relations import ground_box
from vcage.schema.plan import LayoutPlan, Relation
from vcage.schema.scene import Scene


def plan(*triples: tuple[str, str, str]) -> LayoutPlan:
    return LayoutPlan(text="…", relations=[Relation(subject=s, relation=r, reference=o) for s, r, o in triples])


def laid_out(scene: Scene, layout: LayoutPlan, **options) -> IntendedLayout:
    items = {o.id: item_of(o) for o in scene.objects} | options.pop("items", {})
    return intended_layout(scene, layout.relations, items, **options)


def inside(scene: Scene, content: str, container: str) -> Scene:
    objects = [o.model_copy(update={"container": container}) if o.id == content else o for o in scene.objects]
    return scene.model_copy(update={"objects": objects})


@pytest.mark.parametrize("seed", range(4))
def test_the_offline_plan_is_kept_without_overlap_in_the_workspace(seed: int) -> None:
    scene = scene_of([BOX, *MARKERS, ERASER, PLATE.moved(at=(-0.2, -0.1), role="context")])
    layout = plan_layout(scene, (), np.random.default_rng(seed))
    boxes = laid_out(scene, layout).boxes
    assert relations_kept(layout.relations, boxes, ground_box(scene.workspace, scene.table.height)).sentences == []
    assert not any(boxes_overlap(boxes[a], boxes[b]) for a, b in itertools.combinations(boxes, 2))
    lower, upper = scene.workspace.lower, scene.workspace.upper
    assert all(np.all(b[0, :2] >= np.array(lower) - 1e-9) and np.all(b[1, :2] <= np.array(upper) + 1e-9)
               for b in boxes.values())  # fmt: skip


@settings(max_examples=15, deadline=None)
@given(data=st.data())
def test_nothing_is_lost_and_nothing_overlaps_under_any_plan(data: st.DataObject) -> None:
    scene = scene_of([PLATE, *BLOCKS, MARKERS[0]])
    names = st.sampled_from([o.id for o in scene.objects])
    words = st.sampled_from(["left_of", "right_of", "in_front_of", "behind", "near", "beside"])
    triples = data.draw(st.lists(st.tuples(names, words, names), min_size=1, max_size=8))
    boxes = laid_out(scene, plan(*triples)).boxes
    assert set(boxes) == {o.id for o in scene.objects}
    assert not any(boxes_overlap(boxes[a], boxes[b]) for a, b in itertools.combinations(boxes, 2))


def test_fixed_objects_stay_and_the_others_go_round_them() -> None:
    scene = scene_of([PLATE, *BLOCKS])
    there = {"red-block": Pose.from_yaw((0.0, 0.05, HEIGHT), 0.3)}
    layout = plan(("plate", "center", "table"), ("green-block", "left_of", "red-block"))
    found = laid_out(scene, layout, fixed=there)
    assert found.poses["red-block"].p.tolist() == [0.0, 0.05, HEIGHT]
    assert found.poses["red-block"].yaw == pytest.approx(0.3)
    boxes = found.boxes
    assert not any(boxes_overlap(boxes[a], boxes[b]) for a, b in itertools.combinations(boxes, 2))
    assert relations_kept(layout.relations[1:], boxes, ground_box(scene.workspace, scene.table.height)).share == 1


def test_fixed_objects_may_overlap_each_other_and_stand_outside_the_workspace(caplog: pytest.LogCaptureFixture) -> None:
    scene = scene_of([PLATE, *BLOCKS])
    there = {name: Pose.from_yaw((0.5, 0.0, HEIGHT), 0.0) for name in ("plate", "red-block")}
    found = laid_out(scene, plan(("green-block", "left_of", "plate")), fixed=there)
    assert found.kept.share == 1 and found.overlapping == [] and not caplog.text
    assert all(found.poses[name].p[:2].tolist() == [0.5, 0.0] for name in there)


def test_contents_move_and_turn_with_their_container() -> None:
    pen = MARKERS[0].moved(at=(BOX.at[0] + 0.03, BOX.at[1]), yaw=BOX.yaw, base=0.005)
    scene = inside(scene_of([BOX, pen]), pen.id, "box")
    found = laid_out(scene, plan(("box", "center", "table"), (pen.id, "inside", "box"))).poses
    turn = wrap_angle(found["box"].yaw - BOX.yaw)
    expected = found["box"].p[:2] + 0.03 * np.array([np.cos(turn), np.sin(turn)])
    assert wrap_angle(found[pen.id].yaw - pen.yaw) == pytest.approx(turn) == pytest.approx(-BOX.yaw)
    assert found[pen.id].p[:2] == pytest.approx(expected)


def test_contents_are_centred_in_the_opening_of_their_container() -> None:
    scene = scene_of([BOX, BLOCKS[0].moved(yaw=0), BLOCKS[1].moved(yaw=0)])
    layout = plan(("box", "center", "table"), ("red-block", "inside", "box"))
    items = {"box": TableItem("box", BOX.size, opening=Opening((0.01, 0.0), (0.2, 0.16), 0.005, 0.08))}
    found = laid_out(scene, layout, items=items).poses
    assert found["red-block"].p[:2] == pytest.approx(found["box"].p[:2] + [0.01, 0])
    assert found["red-block"].p[2] == pytest.approx(HEIGHT + 0.005)
    both = plan(*((r.subject, r.relation, r.reference) for r in layout.relations),
                ("green-block", "inside", "box"), ("green-block", "left_of", "red-block"))  # fmt: skip
    assert laid_out(scene, both, items=items).kept.sentences == []


def test_an_object_that_fits_its_container_only_when_turned_is_turned() -> None:
    pen = MARKERS[0].moved(yaw=np.pi / 2)
    box = BOX.moved(size=(0.2, 0.05, 0.08), yaw=0.0)
    found = laid_out(scene_of([box, pen]), plan(("box", "center", "table"), (pen.id, "inside", "box")))
    assert found.kept.share == 1 and abs(np.cos(found.poses[pen.id].yaw)) == pytest.approx(1)


def test_supports_that_run_in_a_circle_are_broken_up() -> None:
    triples = plan(("a", "inside", "b"), ("b", "inside", "c"), ("c", "on", "a"), ("a", "on", "c")).relations
    assert supports_of(triples) == {"a": "b", "b": "c"}


def test_names_that_the_scene_does_not_have_are_passed_over() -> None:
    scene = scene_of([PLATE, *BLOCKS])
    found = laid_out(scene, plan(("cup", "left_of", "plate"), ("plate", "near", "cup")))
    assert set(found.poses) == {o.id for o in scene.objects}


def test_an_object_larger_than_the_workspace_is_put_in_its_middle() -> None:
    scene = scene_of([Thing("board", (1, 2, 3), (1.0, 0.6, 0.02), at=(0.1, 0.1))])
    box = laid_out(scene, plan(("board", "center", "table"))).boxes["board"]
    assert box[:, :2].mean(axis=0) == pytest.approx([0, 0])


def test_an_object_without_room_to_keep_apart_is_named(caplog: pytest.LogCaptureFixture) -> None:
    boards = [Thing(name, (1, 2, 3), (0.5, 0.45, 0.02), at=(0.1, 0.1)) for name in ("oak", "elm", "ash", "fir")]
    scene, layout = scene_of(boards), plan(("oak", "center", "table"))
    found = laid_out(scene, layout).overlapping
    assert len(found) >= 2
    assert f"no room to keep these apart: {', '.join(found)}" in caplog.text


def test_contents_do_not_count_as_overlapping(caplog: pytest.LogCaptureFixture) -> None:
    scene = scene_of([BOX, BLOCKS[0]])
    layout = plan(("box", "center", "table"), ("red-block", "inside", "box"))
    assert laid_out(scene, layout).overlapping == []
    assert not caplog.text


def test_a_thousand_relations_are_laid_out() -> None:
    scene = scene_of([PLATE, *BLOCKS])
    triples = [("red-block", "left_of", "plate"), ("green-block", "right_of", "plate")] * 500
    assert laid_out(scene, plan(*triples)).kept.share == 1


def test_the_same_plan_is_laid_out_in_the_same_way() -> None:
    scene = scene_of([PLATE, *BLOCKS])
    layout = plan_layout(scene, (), np.random.default_rng(0))
    first, second = (laid_out(scene, layout).boxes for _ in range(2))
    assert all(np.array_equal(first[name], second[name]) for name in first)
