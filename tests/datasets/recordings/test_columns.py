from __future__ import annotations

import pytest

from vcage.datasets.recordings.columns import act_grippers


@pytest.mark.parametrize(("numbers", "columns"), [(14, (6, 13)), (7, (6,)), (6, ()), (16, ())])
def test_each_arm_of_six_joints_has_a_gripper(numbers, columns):
    assert act_grippers(numbers) == columns
