"""The layout of an episode: as the plan and the robot allow, drawn anew each time, with a chain that is feasible."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace

import h5py
import numpy as np
import pytest

from tests.run_folders import OPTIONS, Finished, copied
from vcage.base.attempts import LIMITS
from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose, boxes_overlap, world_aabb
from vcage.episodes import layouts
from vcage.episodes.layouts import Layout, Layouts, NoLayout
from vcage.goals.thresholds import THRESHOLDS
from vcage.layout.items import ANY_YAW
from vcage.plans.kept import relations_kept
from vcage.plans.relations import ground_box
from vcage.runs.inputs import read_plan
from vcage.schema.episodes import Episodes
from vcage.schema.goals import goal_of
from vcage.schema.plan import Relation
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask, Subtasks
from vcage.stages import collect

pytestmark = pytest.mark.slow

SEEDS = 6


@pytest.fixture(scope="module")
def scene(finished: Finished) -> Scene:
    return Scene.read(finished.run.layout)


@pytest.fixture(scope="module")
def relations(finished: Finished) -> list[Relation]:
    return read_plan(finished.run, Scene.read(finished.run.scene), finished.context).relations


@pytest.fixture(scope="module")
def chain(finished: Finished) -> list[Subtask]:
    record = Subtasks.read(finished.run.subtasks)
    kept = {subtask.id: subtask for subtask in record.kept}
    return [kept[name] for name in record.chains[0].subtasks]


@pytest.fixture(scope="module")
def source(finished: Finished, scene: Scene, relations: list[Relation], chain: list[Subtask]) -> Layouts:
    return Layouts(scene, relations, chain, finished.context)


@pytest.fixture(scope="module")
def drawn(source: Layouts) -> list[Layout]:
    return [source.draw(np.random.default_rng(seed)) for seed in range(SEEDS)]


def boxes(finished: Finished, scene: Scene, layout: Layout) -> dict[str, np.ndarray]:
    return {o.id: world_aabb(o.asset.bounds, layout.poses[o.id]) for o in finished.context.objects(scene)}


def test_every_layout_retains_the_same_plan_as_the_run(finished, scene, relations, drawn):
    own = {o.id: np.array(o.aabb) for o in scene.objects}
    ground = ground_box(scene.workspace, scene.table.height)
    kept = [r for r in relations if r not in relations_kept(relations, own, ground).broken]
    assert kept
    for layout in drawn:
        assert relations_kept(kept, boxes(finished, scene, layout), ground).broken == []


def test_no_two_objects_come_near_each_other_in_any(finished, scene, drawn):
    for layout in drawn:
        for first, second in itertools.combinations(boxes(finished, scene, layout).values(), 2):
            assert not boxes_overlap(first, second, 0.04)


def test_places_and_headings_are_spread(drawn, scene):
    for o in scene.objects:
        at = np.array([layout.poses[o.id].p[:2] for layout in drawn])
        assert at.std(axis=0).max() > 0.03, o.id
    block = next(o.id for o in scene.objects if o.role == "content")
    assert np.ptp([layout.poses[block].yaw for layout in drawn]) > np.radians(30)


def test_the_same_numbers_draw_the_same_layout(source, drawn):
    again = source.draw(np.random.default_rng(0))
    assert again.grasps == drawn[0].grasps
    assert all(np.array_equal(pose.p, drawn[0].poses[name].p) for name, pose in again.poses.items())


def test_every_sub_task_has_grasps_and_a_slot_there(drawn, chain):
    for layout in drawn:
        assert layout.slots.keys() == layout.grasps.keys() == {subtask.id for subtask in chain}
        assert all(layout.grasps.values())


def test_contents_move_with_their_container(finished, scene, relations, chain):
    block, plate = (next(o for o in scene.objects if o.role == role) for role in ("content", "receptacle"))
    lying = block.model_copy(update={"container": plate.id, "pose": plate.pose})
    objects = [lying if o.id == block.id else o for o in scene.objects]
    others = [subtask for subtask in chain if subtask.object != block.id]
    around = [r for r in relations if block.id not in (r.subject, r.reference)]
    source = Layouts(scene.model_copy(update={"objects": objects}), around, others, finished.context)
    poses = source._solved(np.random.default_rng(1))
    assert np.allclose(poses[block.id].p, poses[plate.id].p)
    assert not np.allclose(poses[plate.id].p, plate.pose.position, atol=0.005)


def test_a_layout_with_a_goal_already_true_is_refused(finished, scene, chain, relations):
    told = next(r for r in relations if r.relation == "left_of")
    goal = chain[0].goals[0].model_copy(update=told.model_dump())
    begun = [chain[0].model_copy(update={"goals": [goal]})]
    source = Layouts(scene, relations, begun, finished.context)
    source._fulfilled_before = set()
    with pytest.raises(NoLayout) as caught:
        source.draw(np.random.default_rng(0))
    assert f"{goal} already" in caught.value.details["refused"]


def test_a_layout_with_a_thing_at_the_centre_that_is_to_go_there_is_refused(finished, scene, chain, relations):
    goal = goal_of([chain[0].object, "centred"])
    block = next(o for o in finished.context.objects(scene) if o.id == goal.subject)
    source = Layouts(scene, relations, [chain[0].model_copy(update={"goals": [goal]})], finished.context)
    now = {o.id: o.pose for o in finished.context.objects(scene)}
    off, at_centre = (now | {block.id: Pose([x, 0.0, block.pose.p[2]])} for x in (2 * THRESHOLDS.centred_m, 0.0))
    assert source._fulfilled(off) == set()
    assert source._fulfilled(at_centre) == {goal}


def test_a_thing_to_face_the_customer_is_at_most_a_quarter_turned_away(finished, scene, chain, relations):
    goal = goal_of([chain[0].object, "presented"])
    source = Layouts(scene, relations, [chain[0].model_copy(update={"goals": [goal]})], finished.context)
    item = next(item for item in source._standing if item.id == goal.subject)
    assert len(item.yaws) == len(ANY_YAW) / 2 + 1
    assert all(np.cos(yaw - np.pi) > -1e-6 for yaw in item.yaws)


def test_things_that_one_arm_must_reach_are_drawn_where_it_reaches_them(finished, scene, relations, chain):
    source = Layouts(scene, relations, chain, finished.context)
    near = np.array([[[0.05, -0.2], [0.4, 0.15]]])
    source._for_one_arm = [[[replace(item, allowed=near) for item in source._standing]]]
    for poses in (source._random_poses(np.random.default_rng(seed)) for seed in range(3)):
        assert all(0.05 <= pose.p[0] <= 0.4 for pose in poses.values())


def test_a_goal_that_the_runs_own_layout_fulfils_too_is_no_reason_to_refuse(finished, scene, chain, relations):
    told = next(r for r in relations if r.relation == "left_of")
    goals = [*chain[0].goals, chain[0].goals[0].model_copy(update=told.model_dump())]
    source = Layouts(scene, relations, [chain[0].model_copy(update={"goals": goals})], finished.context)
    assert not [why for why in source.draw(np.random.default_rng(0)).refused if why.endswith(" already")]


def test_without_a_new_layout_the_runs_own_is_used_and_recorded(finished: Finished, tmp_path, monkeypatch):
    def nowhere(*_: object, **__: object) -> None:
        raise InfeasibleScene("full")

    monkeypatch.setattr(layouts, "place", nowhere)
    run = copied(finished.run, tmp_path / "run", before="collect")
    collect.execute(run, OPTIONS, finished.context)
    (episode,) = Episodes.read(run.episodes).episodes
    assert (episode.layout, episode.layouts_refused) == ("fixed", {"there is no room": LIMITS.episode_layouts})
    assert episode.accepted


def test_an_episode_and_its_file_say_where_it_started(finished: Finished, scene: Scene):
    (episode,) = Episodes.read(finished.run.episodes).episodes
    assert episode.layout == "varied"
    started = episode.scene(scene)
    assert started.objects != scene.objects
    with h5py.File(finished.run.root / str(episode.file)) as file:
        text = next(v for k, v in _attributes(file) if k == "scene")
    assert [o["pose"] for o in json.loads(text)["objects"]] == [o.pose.model_dump(mode="json") for o in started.objects]


def _attributes(file: h5py.File) -> list[tuple[str, str]]:
    found = [(name.rpartition("/")[2], value) for name, value in file.attrs.items()]

    def visit(name: str, node: h5py.Group | h5py.Dataset) -> None:
        found.extend((key, value) for key, value in node.attrs.items())
        if isinstance(node, h5py.Dataset) and node.shape == () and node.dtype.kind in "OS":
            value = node[()]
            found.append((name.rpartition("/")[2], value.decode() if isinstance(value, bytes) else value))

    file.visititems(visit)
    return found


def test_the_spread_of_starts_is_counted_over_accepted_episodes(finished: Finished):
    record = Episodes.read(finished.run.episodes)
    episode = record.episodes[0].model_copy(update={"layouts_refused": {}})
    first, *rest = episode.objects
    name, (x, y, z) = first.id, first.pose.position
    moved = first.model_copy(update={"pose": first.pose.model_copy(update={"position": (x + 0.2, y, z)})})
    other = episode.model_copy(update={"index": 1, "objects": [moved, *rest]})
    lost = episode.model_copy(update={"index": 2, "accepted": False, "layouts_refused": {"there is no room": 3}})
    both = record.model_copy(update={"episodes": [episode, other, lost]})
    assert both.spread()[name].deviation == pytest.approx((0.1, 0.0), abs=1e-4)
    assert both.layouts() == {"drawn": 6, "refused": 3}
