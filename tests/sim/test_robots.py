from __future__ import annotations

import pytest
from pydantic import ValidationError

from vcage.base.errors import DamagedFile, MissingDependency, UnknownName
from vcage.objects.surface_pictures import SURFACES
from vcage.schema.robot import DEFAULT_ROBOT, Arm
from vcage.schema.scene import SceneTemplate
from vcage.sim.robots import available, load_robot, load_template, package_file


def test_every_robot_and_scene_file_is_valid():
    assert [load_robot(name).name for name in available("robots")] == available("robots")
    assert [load_template(name).name for name in available("scenes")] == available("scenes")


def test_an_unknown_robot_error_lists_the_known_ones():
    with pytest.raises(UnknownName, match=r"'panda'.*dual_panda"):
        load_robot("panda")


def test_every_scene_of_ours_has_the_default_robot():
    assert {load_template(name).robot for name in available("scenes")} == {DEFAULT_ROBOT}


@pytest.mark.parametrize("name", ["aloha_agilex", "dual_panda"])
def test_a_scene_that_names_a_robot_keeps_it_unless_another_is_asked_for(template, name: str):
    named = SceneTemplate.model_validate(template.model_dump() | {"robot": name})
    assert named.robot == name
    assert load_template("table", name).robot == name


def test_aloha_agilex_has_no_part_of_a_package_of_others():
    assert all(arm.urdf.startswith("assets:") and arm.srdf is None for arm in load_robot("aloha_agilex").arms.values())


def test_a_missing_package_is_named_with_the_command_that_installs_it():
    with pytest.raises(MissingDependency, match="no_such_package") as caught:
        package_file("no_such_package:arm.urdf")
    assert caught.value.command.endswith("-m pip install no_such_package")


def test_a_file_that_a_package_lacks_is_named():
    with pytest.raises(DamagedFile, match=r"arms/none\.urdf"):
        package_file("mani_skill:arms/none.urdf")


@pytest.mark.parametrize("name", available("robots"))
def test_the_arms_at_home_leave_the_workspace_free_in_the_top_view(template, name):
    from vcage.sim.kinematics import kinematics_of

    camera = template.top_camera.camera()
    x0, y0 = template.workspace.lower
    edge = camera.project([x0, y0, template.table.height])[1]
    for arm in load_robot(name).arms.values():
        kinematics = kinematics_of(arm)
        base, poses = arm.base.pose(), kinematics.base_poses(kinematics.home, 1.0)
        for link, shape in kinematics.link_shapes:
            centre = base.apply((poses[link] * shape.local).to_transformation_matrix()[:3] @ [*shape.centre, 1])
            assert camera.project(centre)[1] > edge, link


def test_the_five_scenes_of_the_paper_are_there_with_their_table_tops():
    assert {"kitchen", "bathroom", "office_desk", "cashier_desk", "cabinet"} <= set(available("scenes"))
    assert {load_template(name).table.texture for name in available("scenes")} <= set(SURFACES["table"])


def test_a_limit_is_one_number_for_every_joint_or_one_for_each():
    arm = load_robot("dual_panda").arms["left"]
    assert arm.model_copy(update={"max_speed": 1.5}).speeds == [1.5] * 7
    assert arm.speeds == [2.175] * 4 + [2.61] * 3


def test_limits_for_another_number_of_joints_are_refused():
    record = load_robot("dual_panda").arms["left"].model_dump() | {"max_jerk": [5000.0, 5000.0]}
    with pytest.raises(ValidationError, match="max_jerk has 2 numbers for 7 joints"):
        Arm.model_validate(record)
