"""Articulated objects of RoboTwin: joints, parts and points, and what each defect is called."""

from __future__ import annotations

import numpy as np
import pytest

from vcage.base.geometry import quat_to_rotation
from vcage.objects.importers.robotwin import import_robotwin
from vcage.objects.library import Library

QUARTER_TURN = quat_to_rotation([0.707106781, 0, 0, 0.707106781])
"""Rotation with which RoboTwin's tasks place a cabinet before the robot."""


def imported(cabinet, into):
    (entry,) = import_robotwin(cabinet.folder.parent, into)
    if entry.error is not None:
        raise entry.error
    return Library.load(into).asset(entry.name), entry.warnings


def refused(cabinet, into) -> str:
    (entry,) = import_robotwin(cabinet.folder.parent, into)
    assert list(into.glob("*")) == []
    return entry.error.message


def test_a_drawer_is_a_moving_part_that_opens_towards_the_robot(cabinet, into):
    asset, warnings = imported(cabinet.write(), into)
    (drawer,) = asset.model.links
    assert warnings == []
    assert (drawer.name, drawer.joint.kind, drawer.mass) == ("drawer", "slide", 0.3)
    np.testing.assert_allclose(drawer.joint.axis, (0, -1, 0), atol=1e-6)
    assert (drawer.joint.lower, drawer.joint.upper) == (0.0, pytest.approx(0.2))


def test_rigidly_joined_links_are_one_body_with_their_masses(cabinet, into):
    asset, _ = imported(cabinet.write(), into)
    assert asset.model.mass == pytest.approx(2.0 + 0.1)  # the base is not named, and has RoboTwin's default
    assert len(asset.model.hulls) == 4


def test_points_lie_where_robotwin_puts_them(cabinet, into):
    asset, _ = imported(cabinet.write(), into)
    lower = np.array([-0.56, -0.3, 0]) * 0.5  # of body and drawer together, before the quarter turn
    upper = np.array([0.4, 0.3, 0.3]) * 0.5
    turned = np.stack([lower, upper]) @ QUARTER_TURN.T
    pose = np.eye(4)
    pose[:3, :3] = QUARTER_TURN
    pose[:3, 3] = -np.append(turned[:, :2].mean(axis=0), 0)
    link = np.eye(4)
    link[:3, 3] = [0, 0, 0.04 * 0.5]
    for kind, ours in (("contact_points", asset.annotation.contact_points[0]),):
        local = np.array(cabinet.data[kind][0]["matrix"])
        local[:3, 3] *= 0.5
        world = pose @ link @ local
        np.testing.assert_allclose(ours.position, world[:3, 3], atol=1e-5)
        np.testing.assert_allclose(ours.approach, -world[:3, 1], atol=1e-5)
        np.testing.assert_allclose(ours.closing, -world[:3, 2], atol=1e-5)
        assert (ours.link, ours.name) == ("drawer", "handle")


def test_the_inside_of_the_drawer_receives(cabinet, into):
    asset, _ = imported(cabinet.write(), into)
    (point,) = asset.annotation.functional_points
    assert (point.holds, point.link) == ("in", "drawer")
    assert point.position[2] == pytest.approx(0.5 * (0.04 + 0.02))


def test_our_zero_is_where_robotwin_starts(cabinet, into):
    closed, _ = imported(cabinet.write(), into)
    cabinet.data["init_qpos"] = [0.1]
    (entry,) = import_robotwin(cabinet.write().folder.parent, into, force=True)
    asset = Library.load(into).asset(entry.name)
    assert (asset.model.links[0].joint.lower, asset.model.links[0].joint.upper) == pytest.approx((-0.1, 0.1))
    assert asset.size[1] == pytest.approx(closed.size[1] + 0.1)


def test_a_hinge_turns_about_its_axis(cabinet, into):
    cabinet.joint = "revolute"
    asset, _ = imported(cabinet.write(), into)
    joint = asset.model.links[0].joint
    assert (joint.kind, joint.upper) == ("turn", pytest.approx(0.4))
    np.testing.assert_allclose(joint.origin[2], 0.02, atol=1e-6)


@pytest.mark.parametrize("limit", ["", '<limit effort="1"/>', '<limit lower="1" upper="0"/>'])
def test_a_joint_without_limits_is_refused_by_name(cabinet, into, limit):
    cabinet.limit = limit
    assert "mobility.urdf: field joint sliding.limit: got lower" in refused(cabinet.write(), into)


def test_a_joint_that_turns_without_end_is_kept_with_a_warning(cabinet, into):
    cabinet.joint, cabinet.limit = "continuous", ""
    _, warnings = imported(cabinet.write(), into)
    assert any("joint sliding: turns without end" in w for w in warnings)


@pytest.mark.parametrize("name", ["/etc/passwd", "file:///etc/passwd", "../../elsewhere.obj"])
def test_a_mesh_outside_the_objects_folder_is_refused(cabinet, into, name):
    urdf = cabinet.write().folder / "mobility.urdf"
    urdf.write_text(urdf.read_text().replace("body.obj", name))
    assert "mobility.urdf: field link body.visual.mesh: expected a relative path" in refused(cabinet, into)


def test_a_missing_mesh_is_named(cabinet, into):
    message = refused(cabinet.write(meshes=False), into)
    assert "mobility.urdf: field link body.visual.mesh: 'body.obj' is missing" in message


def test_an_unknown_link_of_a_point_is_named_with_the_known_ones(cabinet, into):
    cabinet.data["contact_points"][0]["base"] = "lid"
    asset, warnings = imported(cabinet.write(), into)
    assert asset.annotation.contact_points == []
    assert "field contact_points.0.matrix: its base is 'lid'; expected a link, one of base, body, drawer" in warnings[0]


@pytest.mark.parametrize("entry", [{"matrix": np.eye(4).tolist(), "link": "drawer"}, {"base": "drawer"}])
def test_unknown_keys_of_a_point_are_named(cabinet, into, entry):
    cabinet.data["contact_points"] = [entry]
    _, warnings = imported(cabinet.write(), into)
    assert "field contact_points.0: got the keys" in warnings[0]


def test_starting_positions_must_be_as_many_as_the_joints(cabinet, into):
    cabinet.data["init_qpos"] = [0.0, 0.0]
    assert "field init_qpos: got 2 numbers; expected one for each joint: sliding" in refused(cabinet.write(), into)


def test_a_start_out_of_range_is_taken_to_the_range(cabinet, into):
    cabinet.data["init_qpos"] = [0.9]
    asset, warnings = imported(cabinet.write(), into)
    assert "field init_qpos: 0.9 for sliding; expected 0 … 0.2" in warnings[0]
    assert asset.model.links[0].joint.upper == pytest.approx(0.0)


def test_scales_that_differ_per_axis_cannot_be_used_with_a_urdf(cabinet, into):
    cabinet.data["scale"] = [0.5, 0.5, 0.4]
    assert "field scale" in refused(cabinet.write(), into)


def test_damaged_xml_is_named(cabinet, into):
    cabinet.write()
    (cabinet.folder / "mobility.urdf").write_text("<robot>")
    assert "mobility.urdf is not a URDF" in refused(cabinet, into)


def test_an_unknown_parent_link_is_named(cabinet, into):
    cabinet.write()
    path = cabinet.folder / "mobility.urdf"
    path.write_text(path.read_text().replace('<parent link="body"/>', '<parent link="bodi"/>'))
    assert "field joint sliding.parent: 'bodi' is no link; expected one of base, body, drawer" in refused(cabinet, into)


@pytest.mark.parametrize(
    ("dynamics", "expected"),
    [
        ("", (20.0, 1.0)),
        ('<dynamics damping="7" friction="0.5"/>', (7.0, 0.5)),
        ('<dynamics damping="-1"/>', (20.0, 1.0)),
    ],
)
def test_resistance_is_the_urdfs_or_that_of_a_drawer_that_stays(cabinet, into, dynamics, expected):
    cabinet.limit += dynamics
    asset, _ = imported(cabinet.write(), into)
    joint = asset.model.links[0].joint
    assert (joint.damping, joint.friction) == expected
