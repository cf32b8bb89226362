"""Objects with moving parts in a world: at rest, pushed, snapshotted, recorded and drawn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.articulated import LID_RANGE, TRAVEL, drawer_cabinet, lidded_chest, push_button
from vcage.base.errors import UnknownName
from vcage.base.geometry import Camera, Pose, frame_from_axes, look_at
from vcage.sim.bodies import Body
from vcage.sim.cameras import observe
from vcage.sim.collision import CollisionScene
from vcage.sim.motion import MotionPlanner
from vcage.sim.paths import Load
from vcage.sim.recording import StateLog
from vcage.sim.replay import render_state
from vcage.sim.world import World

PLACES = {
    "cabinet": Pose.from_yaw([0.2, 0.08, 0.742], 0.1),
    "chest": Pose.from_yaw([-0.15, 0.08, 0.742], -0.1),
    "button": Pose([-0.1, -0.12, 0.742]),
}
OPEN = {"cabinet": (TRAVEL, 0.06), "chest": (LID_RANGE,), "button": ()}


@pytest.fixture(scope="module")
def things(tmp_path_factory):
    folder = tmp_path_factory.mktemp("articulated")
    return {"cabinet": drawer_cabinet(folder), "chest": lidded_chest(folder), "button": push_button(folder)}


@pytest.fixture
def build(template, robot, things):
    """Makes worlds of the three objects; joints by id."""

    def build(joints=None, **options):
        bodies = {name: Body(model, PLACES[name], (joints or {}).get(name, ())) for name, model in things.items()}
        return World(template.table, bodies, robot, **options)

    return build


def pull(world: World, object_id: str, link: str, force: float, steps: int) -> None:
    """A constant force or torque along a joint."""
    articulation = world._object(object_id)._articulation
    forces = [force if joint.name == link else 0.0 for joint in articulation.active_joints]
    for _ in range(steps):
        articulation.set_qf(forces)
        world.step()
    articulation.set_qf(np.zeros(len(forces)))


@pytest.mark.parametrize("joints", [{}, OPEN], ids=["closed", "open"])
def test_parts_stay_where_they_are_under_gravity(build, joints):
    world = build(joints)
    before = {name: world.object_joints(name) for name in world.object_ids}
    report = world.settle(max_steps=1000)
    assert report.settled
    assert max(report.drift_m.values()) < 0.003
    for name in ("cabinet", "chest"):
        np.testing.assert_allclose(world.object_joints(name), before[name], atol=0.002)


def test_joints_stop_at_their_limits(build):
    world = build()
    pull(world, "cabinet", "drawer_upper", 3.0, 250)
    assert world.object_joints("cabinet")[1] == pytest.approx(TRAVEL, abs=0.002)
    pull(world, "cabinet", "drawer_upper", -3.0, 250)
    assert world.object_joints("cabinet")[1] == pytest.approx(0.0, abs=0.002)


def test_a_pulled_drawer_moves_alone(build):
    world = build()
    pull(world, "cabinet", "drawer_lower", 1.0, 100)
    lower, upper = world.object_joints("cabinet")
    assert lower > 0.03
    assert upper == pytest.approx(0.0, abs=0.002)


def test_a_pressed_button_springs_back(build):
    world = build()
    pull(world, "button", "knob", 4.0, 100)
    assert world.object_joints("button")[0] == pytest.approx(0.008, abs=0.001)
    world.step(250)
    assert world.object_joints("button")[0] < 0.002


def test_a_finger_that_pushes_an_open_drawer_closes_it(build):
    world = build({"cabinet": (0.0, TRAVEL)})
    arm, planner = world.arms["right"], MotionPlanner(CollisionScene.of_world(world, "right"))
    pose = world.object_pose("cabinet")
    # 2 cm in front of the drawer's front, above its fin's side, fingers closed
    start = frame_from_axes(pose.apply([0.05, -TRAVEL - 0.12, 0.165]), [0, 0.5, -0.866], pose.rotation()[:, 0])
    arm.command_gripper(0.0)
    arm.move(planner.fastest(planner.move(arm.joints, start, Load(opening=0.0))))
    way = Pose(start.p + pose.rotation()[:, 1] * 0.08, start.q)
    push = planner.line(arm.joints, way, Load(opening=0.0, ignore=["cabinet/drawer_upper"], speed=0.4))
    arm.move(planner.fastest(push))
    assert world.object_joints("cabinet")[1] < TRAVEL - 0.03


def test_fresh_worlds_continue_from_a_snapshot_bit_for_bit(build):
    first = build(OPEN)
    first.step(30)
    pull(first, "cabinet", "drawer_upper", -1.0, 20)
    snapshot, ends = first.snapshot(), []
    for _ in range(2):
        world = build()
        world.restore(snapshot)
        for name in world.object_ids:
            assert np.array_equal(world.object_joints(name), first.object_joints(name))
        world.step(150)
        ends.append(world.snapshot())
    assert ends[0] == ends[1]


def test_a_world_can_be_built_with_open_parts(build):
    world = build(OPEN)
    np.testing.assert_allclose(world.object_joints("cabinet"), [TRAVEL, 0.06], atol=1e-6)
    assert world.body("chest").joints == pytest.approx((LID_RANGE,))


def test_a_moved_object_keeps_its_joints(build):
    world = build(OPEN)
    goal = Pose.from_yaw([0.0, 0.1, 0.74], 0.5)
    world.set_object_pose("cabinet", goal)
    np.testing.assert_allclose(world.object_pose("cabinet").p, goal.p, atol=1e-6)
    np.testing.assert_allclose(world.object_joints("cabinet"), [TRAVEL, 0.06], atol=1e-6)


def test_the_mass_of_every_part_is_the_models(build, things):
    import sapien

    kind = sapien.physx.PhysxArticulationLinkComponent
    masses = {k: e.find_component_by_type(kind).mass for k, e in build().entities("cabinet").items()}
    model = things["cabinet"]
    assert masses == pytest.approx({None: model.mass, **{link.name: link.mass for link in model.links}})


def test_contacts_name_objects_and_never_an_objects_own_parts(build):
    world = build()
    world.settle()
    assert world.touching("cabinet") == {"table"}
    assert world.touching("cabinet/drawer_upper") == set()
    with pytest.raises(UnknownName, match="cabinet/drawer_lower"):
        world.touching("cabinet/door")


@pytest.fixture
def over_drawer(build):
    """The right arm's surroundings with the upper drawer open, and joints with the fingers over it, straight down.

    Args:
        x, z: of the gripper frame in the cabinet's frame, metres.
    """
    world = build({"cabinet": (0.0, TRAVEL)})
    scene, pose = CollisionScene.of_world(world, "right"), world.object_pose("cabinet")

    def over_drawer(x, z):
        return scene, scene.kinematics.ik(frame_from_axes(pose.apply([x, -0.155, z]), [0, 0, -1], [1, 0, 0]))

    return over_drawer


def test_moving_parts_are_obstacles_of_their_own(over_drawer):
    scene, q = over_drawer(0.0, 0.138)
    assert scene.first_contact(q).other == "cabinet/drawer_upper"
    assert scene.first_contact(q, ignore=["cabinet/drawer_upper"]) is None


def test_fingers_may_touch_obstacles_that_the_hand_may_not(over_drawer):
    scene, q = over_drawer(0.0, 0.138)
    assert scene.first_contact(q, fingers_may_touch=["cabinet/drawer_upper"]) is None
    scene, q = over_drawer(0.03, 0.12)
    assert scene.first_contact(q, fingers_may_touch=["cabinet/drawer_upper"]).moving == "panda_hand"


def test_recorded_joints_are_shown_again(build):
    world, log = build(), StateLog(fps=10)
    log.record(world)
    pull(world, "cabinet", "drawer_upper", 1.0, 150)
    joints = log.joint_array("cabinet")
    assert joints.shape == (6, 2)
    assert joints[-1, 1] > joints[0, 1] + 0.03
    again = build()
    again.set_state(log.frames[-1].world_state())
    np.testing.assert_allclose(again.object_joints("cabinet"), joints[-1], atol=1e-6)
    assert set(log.frames[0].object_joints) == {"cabinet", "chest", "button"}


def test_an_opened_drawer_is_drawn_open_with_the_objects_value(build, template):
    world = build(render=True)
    camera = Camera(160, 120, 0.6, look_at([0.2, 0.0, 1.7], [0.2, 0.0, 0.74], up=(0, 1, 0)))
    areas = []
    for joints in ([0.0, 0.0], [0.0, TRAVEL]):
        world.set_state(replace(world.state(), object_joints={"cabinet": np.array(joints)}))
        shot = observe(world, camera)
        areas.append(int((shot.segmentation == world.segmentation_ids["cabinet"]).sum()))
    assert areas[1] > 1.3 * areas[0]
    closed = build().state()
    shown = render_state(world, closed, ["cam_high"])
    assert shown.pictures["cam_high"].shape == (240, 320, 3)
    np.testing.assert_allclose(world.object_joints("cabinet"), 0.0, atol=1e-6)
