"""Import of RoboTwin's robots: config, URDF, and the error for each defect."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest
import yaml
from pydantic import ValidationError

from tests.sim.robotwin.embodiment import FINGER, HAND, arm, config, dual_config, write
from vcage.base.errors import DamagedFile, InputFileError, SchemaMismatch, UsageError
from vcage.schema.robot import Arm
from vcage.sim.arms import ArmControl, build_arm
from vcage.sim.kinematics import kinematics_of
from vcage.sim.robots import available, load_robot, package_file
from vcage.sim.robotwin import importing
from vcage.sim.robotwin.embodiment import read_embodiment
from vcage.sim.robotwin.importing import import_robot


@pytest.fixture(autouse=True)
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("VCAGE_DATA", str(tmp_path / "data"))
    monkeypatch.setenv("VCAGE_CACHE", str(tmp_path / "cache"))
    return tmp_path / "data"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "embodiments" / "Box-Arm"


def loaded(folder: Path, **options):
    imported = import_robot(folder, **options)
    return load_robot(imported.name), imported.warnings


def links(robot, side: str) -> set[str]:
    root = ElementTree.parse(package_file(robot.arms[side].urdf)).getroot()
    return {link.get("name") for link in root.findall("link")}


def camera(**changes) -> dict:
    """The field of the config, with one camera."""
    view = {"name": "x", "position": [0, 0, 1], "forward": [0, 0.6, -0.8], "left": [-1, 0, 0]}
    return {"static_camera_list": [{**view, **changes}]}


def test_an_imported_robot_is_found_by_name(folder):
    robot, _ = loaded(write(folder, config()))
    assert robot.name == "box-arm"
    assert set(available("robots")) >= {"box-arm", "dual_panda"}


def test_the_record_has_the_values_of_the_config(folder):
    robot, warnings = loaded(write(folder, config()), distance=0.8)
    left, right = robot.arms["left"], robot.arms["right"]
    assert (left.joints, left.home, left.tool_link) == (["shoulder", "elbow"], [0.1, 0.2], "hand")
    assert (left.stiffness, left.damping) == (1000, 200)
    assert (left.base.position, right.base.position) == ((-0.4, -0.65, 0.75), (0.4, -0.65, 0.75))
    assert [w for w in warnings if "field of view" not in w] == []


def test_the_gripper_is_measured_on_the_collision_shapes(folder):
    gripper = loaded(write(folder, config()))[0].arms["left"].gripper
    assert gripper.max_width == pytest.approx(0.06)
    assert gripper.tip_depth == pytest.approx(HAND[2] + FINGER[2] - 0.1)
    assert gripper.finger_length == pytest.approx(0.1 - HAND[2])
    assert gripper.palm_size == pytest.approx(HAND[:2])
    assert (gripper.closed, gripper.open, gripper.force) == (0.0, 0.03, 40.0)


def test_unknown_sizes_of_hand_and_arm_are_assumed(folder):
    arm_record = loaded(write(folder, config()))[0].arms["left"]
    hand = arm_record.gripper
    assert (hand.finger_width, hand.finger_thickness, hand.palm_height, hand.approach) == (0.022, 0.022, 0.12, 0.09)
    assert (hand.friction, hand.friction_patch, hand.empty_width) == (2.0, 0.1, 0.0015)
    assert (arm_record.max_speed, arm_record.max_acceleration, arm_record.self_collision_gap) == (2.1, 7.5, 4)


def test_the_gripper_frame_looks_out_of_the_hand_with_the_camera_at_its_x(folder):
    arm_record = loaded(write(folder, config()))[0].arms["left"]
    pose = arm_record.tool_offset.pose()
    np.testing.assert_allclose(pose.p, [0, 0, 0.1], atol=1e-6)
    np.testing.assert_allclose(pose.rotation(), np.eye(3), atol=1e-6)


def test_forward_kinematics_bring_the_frame_where_robotwin_has_it(folder):
    arm_record = loaded(write(folder, config()), distance=0.6)[0].arms["left"]
    pose = kinematics_of(arm_record).fk([0.0, 0.0])
    np.testing.assert_allclose(pose.p, [-0.3, -0.65, 0.75 + 0.1 + 0.2 + 0.2 + 0.1], atol=1e-5)


@pytest.mark.parametrize("mirrored", [False, True], ids=["same way", "other way"])
def test_both_fingers_open_and_close_together(folder, mirrored):
    import sapien

    factor = -0.9999995 if mirrored else 1.0  # rounded, as a file may have it
    fields = config(gripper_name=[{"base": "finger1", "mimic": [["finger2", factor, 0.0]]}])
    record = loaded(write(folder, fields, arm(mirrored=mirrored)))[0].arms["left"]
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    articulation = build_arm(scene, record, visual_faces=None)
    control = ArmControl("left", record, articulation, scene.step)
    left, right = (finger.pose.p for finger in control.fingers)
    assert np.linalg.norm(left - right) == pytest.approx(0.07, abs=1e-4)
    control.grip(0.0)
    left, right = (finger.pose.p for finger in control.fingers)
    assert np.linalg.norm(left - right) == pytest.approx(0.01, abs=2e-3)  # they touch


def test_two_arms_on_one_body_are_separated(folder):
    arms = [arm("l_", at="-.3 0 .1"), arm("r_", at=".3 0 .1")]
    robot, warnings = loaded(write(folder, dual_config(), *arms))
    assert {name for name in links(robot, "left") if name.startswith("r_")} == set()
    assert {name for name in links(robot, "right") if name.startswith("l_")} == set()
    assert robot.arms["left"].base == robot.arms["right"].base
    assert robot.arms["right"].tool_link == "r_hand"
    assert not any("distance" in w for w in warnings)


def test_the_body_of_two_arms_is_solid_once(folder):
    arms = [arm("l_", at="-.3 0 .1"), arm("r_", at=".3 0 .1")]
    robot, _ = loaded(write(folder, dual_config(), *arms))
    solid = {
        side: ElementTree.parse(package_file(record.urdf)).find("link[@name='base']/collision") is not None
        for side, record in robot.arms.items()
    }
    assert solid == {"left": True, "right": False}


def test_a_joint_of_the_other_arm_is_named(folder):
    fields = {**dual_config(), "ee_joints": ["l_wrist", "l_wrist"]}
    with pytest.raises(SchemaMismatch, match=r"ee_joints.1: 'l_wrist' does not hang on the arm that begins with 'r_sh"):
        import_robot(write(folder, fields, arm("l_"), arm("r_")))


def test_a_urdf_that_sapien_cannot_load_is_named(folder):
    write(folder, config())
    path = folder / "arm.urdf"
    path.write_text(path.read_text().replace('<box size="0.06 0.2 0.05"/>', "<nothing/>"))
    with pytest.raises(DamagedFile, match=r"config.yml: left gripper: SAPIEN cannot load the URDF"):
        import_robot(folder)


def test_a_camera_link_carries_a_wrist_camera(folder):
    robot, _ = loaded(write(folder, config()))
    assert set(robot.cameras) == {"head_camera", "cam_left_wrist", "cam_right_wrist"}
    assert (robot.cameras["cam_left_wrist"].arm, robot.cameras["cam_left_wrist"].link) == ("left", "camera")
    assert robot.cameras["head_camera"].up == pytest.approx((0, 0.8, 0.6))


def test_joints_outside_arm_and_gripper_are_held(folder):
    wheel = (
        '<link name="wheel"/><joint name="rolling" type="continuous"><parent link="base"/><child link="wheel"/></joint>'
    )
    robot, warnings = loaded(write(folder, config(), extra=wheel))
    root = ElementTree.parse(package_file(robot.arms["left"].urdf)).getroot()
    assert root.find("joint[@name='rolling']").get("type") == "fixed"
    assert any("held where they are: rolling" in w for w in warnings)


def test_round_collision_shapes_become_meshes_that_planning_knows(folder):
    ball = '<link name="ball"><collision><geometry><sphere radius=".02"/></geometry></collision></link>'
    ball += '<joint name="on" type="fixed"><parent link="base"/><child link="ball"/></joint>'
    robot, _ = loaded(write(folder, config(), extra=ball))
    assert any(link == "ball" for link, _ in kinematics_of(robot.arms["left"]).link_shapes)


@pytest.mark.parametrize(
    ("field", "assumed"),
    [
        ("gripper_bias", "0.12 is assumed"),
        ("robot_pose", "is assumed"),
        ("homestate", "zeros are assumed for the left arm"),
        ("joint_damping", "200.0 is assumed"),
        ("static_camera_list", "a camera over the table is assumed"),
        ("delta_matrix", "is assumed"),
    ],
)
def test_every_assumed_default_is_a_warning(folder, field, assumed):
    _, warnings = loaded(write(folder, config(**{field: None})))
    assert any(f"config.yml: field {field}: missing" in w and assumed in w for w in warnings)


def test_a_gripper_scale_beyond_the_limits_is_cut_to_them(folder):
    robot, warnings = loaded(write(folder, config(gripper_scale=[-0.01, 0.05])))
    assert (robot.arms["left"].gripper.closed, robot.arms["left"].gripper.open) == (0.0, 0.03)
    assert any("gripper_scale: -0.01 … 0.05 goes beyond the limits" in w for w in warnings)


def test_home_out_of_limits_is_taken_to_them(folder):
    robot, warnings = loaded(write(folder, config(homestate=[[9.0, 0.0]])))
    assert robot.arms["left"].home == [1.5, 0.0]
    assert any("field homestate: 9 for shoulder of the left arm" in w for w in warnings)


def test_the_config_keeps_its_home_when_the_record_gets_another(folder, monkeypatch):
    read = []
    monkeypatch.setattr(importing, "read_embodiment", lambda path: read.append(read_embodiment(path)) or read[0])
    import_robot(write(folder, config(homestate=[[9.0, 0.0]])))
    assert read[0].arms["left"].home == [9.0, 0.0]


@pytest.mark.parametrize("field", ["stiffness", "damping", "force"])
def test_a_drive_without_strength_is_no_arm(folder, field):
    record = loaded(write(folder, config()))[0].arms["left"]
    with pytest.raises(ValidationError, match=field):
        Arm.model_validate({**record.model_dump(), field: 0})


@pytest.mark.parametrize("field", ["urdf_path", "arm_joints_name", "ee_joints", "gripper_name", "gripper_scale"])
def test_a_missing_field_is_named(folder, field):
    with pytest.raises(SchemaMismatch, match=rf"config.yml: field {field}: missing"):
        import_robot(write(folder, config(**{field: None})))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"arm_joints_name": [["shoulder", "elbo"]]}, r"arm_joints_name.0.1: 'elbo' is no joint"),
        ({"arm_joints_name": [["shoulder", "shoulder"]]}, r"arm_joints_name.0: got .*expected different names"),
        ({"ee_joints": "hand"}, r"ee_joints.0: 'hand' is no joint of .*expected one of shoulder, elbow, wrist"),
        ({"gripper_name": [{"base": "finger"}]}, r"gripper_name.0: 'finger' is no joint"),
        ({"gripper_name": [{"mimic": []}]}, r"gripper_name.0.base"),
        ({"gripper_name": [{"base": "finger1", "mimic": [["finger2", 0.5, 0]]}]}, r"mimic.0: .*the factor 1 or"),
        ({"gripper_name": [{"base": "finger1", "mimic": 5}]}, r"gripper_name.0.mimic: got 5; .* list"),
        ({"joint_stiffness": -1}, r"joint_stiffness: got -1; .* greater than 0"),
        ({"joint_damping": 0}, r"joint_damping: got 0; .* greater than 0"),
        ({"gripper_bias": 10**400}, r"gripper_bias: got 1000.*expected a finite number"),
        ({"delta_matrix": [[10**400] * 3] * 3}, r"delta_matrix.0.0: .*expected a finite number"),
        (camera(position=[0, float("nan"), 0]), r"static_camera_list.0.position.1: got nan; expected a finite number"),
        (camera(forward=[0, float("inf"), 0]), r"static_camera_list.0.forward.1: got inf; expected a finite number"),
        (camera(left=[0, 0, 0]), r"static_camera_list.0.left: got .0, 0, 0.; expected a direction"),
        ({"gripper_scale": [0.0]}, r"gripper_scale.1: missing; expected a value"),
        ({"gripper_scale": [0.1, 0.2]}, r"gripper_scale: got 0.1, 0.2; expected different positions within 0 … 0.03"),
        ({"homestate": [[0.0], [0.0, 0.0]]}, r"homestate: .*entry 0 has 1 numbers; expected 2"),
        ({"robot_pose": [[0, 0, 0]]}, r"robot_pose.0: got .*at least 7 items"),
        ({"robot_pose": [[0, 0, 0, 0, 0, 0, 0]]}, r"robot_pose.0: got .*the quaternion"),
        ({"delta_matrix": [[1, 0, 0], [0, 1, 0], [0, 0, -1]]}, r"delta_matrix: .*expected a 3×3 rotation"),
        ({"delta_matrix": [[1, 0], [0, 1]]}, r"delta_matrix.0.2: missing"),
        ({"urdf_path": "./other.urdf"}, r"urdf_path: .*'./other.urdf' is missing"),
        ({"srdf_path": "./other.srdf"}, r"srdf_path.*: .*'./other.srdf' is missing"),
        ({"dual_arm": True}, r"arm_joints_name: .*dual_arm is true, but both arms have the same joints"),
        ({"static_camera_list": [{"name": "x"}]}, r"static_camera_list.0.position: missing"),
    ],
)  # fmt: skip
def test_a_wrong_field_is_named(folder, data, changes, message):
    with pytest.raises(InputFileError, match=message):
        import_robot(write(folder, config(**changes)))
    assert list(data.glob("robots/*")) == []


def test_all_missing_or_wrong_fields_are_named_in_one_error(folder, data):
    changes = {"ee_joints": None, "gripper_scale": [0.0, 0.0], "srdf_path": "./other.srdf", **camera(forward=None)}
    with pytest.raises(SchemaMismatch, match="4 fields are wrong") as error:
        import_robot(write(folder, config(**changes)))
    named = ["ee_joints", "gripper_scale", "srdf_path", "static_camera_list.0.forward"]
    assert sorted(error.value.details["fields"]) == named
    assert all(f" field {name}: " in error.value.message for name in named)
    assert "config.yml: 4 fields" in error.value.message
    assert list(data.glob("robots/*")) == []


def test_all_defects_of_a_urdf_are_named_in_one_error(folder):
    write(folder, config(ee_joints=["wrist2"]))
    (folder / "meshes" / "base.stl").unlink()
    path = folder / "arm.urdf"
    path.write_text(path.read_text().replace('<limit lower="-1.5" upper="1.5" effort="50" velocity="2"/>', "", 2))
    with pytest.raises(SchemaMismatch) as error:
        import_robot(folder)
    fields = ["mesh.filename", "ee_joints.0", "joint shoulder.limit", "joint elbow.limit", "ee_joints.1"]
    assert error.value.details["fields"] == fields


def test_a_direction_of_any_length_is_made_a_unit_vector(folder):
    robot, _ = loaded(write(folder, config(**camera(forward=[0, 6e200, -8e200]))))
    assert robot.cameras["x"].forward == pytest.approx((0, 0.6, -0.8))


def test_a_too_long_name_is_refused(tmp_path, data):
    with pytest.raises(UsageError, match=r"has 81 characters; expected at most 80"):
        import_robot(write(tmp_path / ("a" * 81), config()))
    assert list(data.glob("robots/*")) == []


def test_a_missing_config_is_named(folder):
    folder.mkdir(parents=True)
    with pytest.raises(InputFileError, match=r"config.yml: missing"):
        import_robot(folder)


@pytest.mark.parametrize(("file", "text"), [("config.yml", "a: ["), ("arm.urdf", "<robot>")])
def test_a_damaged_file_is_named(folder, file, text):
    write(folder, config())
    (folder / file).write_text(text)
    with pytest.raises(DamagedFile, match=file):
        import_robot(folder)


def test_a_missing_mesh_is_named(folder):
    write(folder, config())
    (folder / "meshes" / "base.stl").unlink()
    with pytest.raises(SchemaMismatch, match=r"arm.urdf: field mesh.filename: 'package://meshes/base.stl' is missing"):
        import_robot(folder)


def test_an_arm_joint_without_limits_is_named(folder):
    write(folder, config())
    path = folder / "arm.urdf"
    path.write_text(path.read_text().replace('<limit lower="-1.5" upper="1.5" effort="50" velocity="2"/>', "", 1))
    with pytest.raises(SchemaMismatch, match=r"field joint shoulder.limit: got lower None, upper None"):
        import_robot(folder)


def test_a_taken_name_is_refused_unless_forced(folder):
    import_robot(write(folder, config()))
    with pytest.raises(UsageError, match=r"'box-arm' is the name of .*box-arm.yml"):
        import_robot(folder)
    import_robot(folder, force=True)


def test_the_name_of_a_bundled_robot_is_refused(tmp_path):
    with pytest.raises(UsageError, match="'dual_panda' is the name of"):
        import_robot(write(tmp_path / "dual_panda", config()), force=True)


def test_a_distance_is_refused_where_both_arms_stand_on_one_body(folder):
    with pytest.raises(UsageError, match="no distance to set"):
        import_robot(write(folder, dual_config(), arm("l_"), arm("r_")), distance=0.5)


def test_an_srdf_loses_the_pairs_of_links_that_an_arm_does_not_have(folder):
    write(folder, {**dual_config(), "srdf_path": "arm.srdf"}, arm("l_", at="-.3 0 .1"), arm("r_", at=".3 0 .1"))
    pairs = "".join(f'<disable_collisions link1="{a}" link2="{b}" reason="Default"/>' for a, b in (("l_upper", "l_hand"), ("l_upper", "r_hand")))  # fmt: skip # noqa: E501
    (folder / "arm.srdf").write_text(f'<robot name="test">{pairs}</robot>')
    robot, _ = loaded(folder)
    kept = ElementTree.parse(package_file(robot.arms["left"].srdf)).getroot().findall("disable_collisions")
    assert [pair.get("link2") for pair in kept] == ["l_hand"]


def test_a_record_whose_urdf_is_gone_says_so(folder):
    robot, _ = loaded(write(folder, config()))
    path = Path(robot.arms["left"].urdf.removeprefix("file:"))
    path.unlink()
    with pytest.raises(DamagedFile, match=r"left.urdf is missing"):
        package_file(robot.arms["left"].urdf)


def test_the_record_is_yaml_of_our_schema(folder):
    path = import_robot(write(folder, config())).path
    assert yaml.safe_load(path.read_text())["schema"] == "vcage.robot/1"
