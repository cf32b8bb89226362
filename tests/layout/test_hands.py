from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.layout.items import standing_at
from vcage.layout.groups import hand_gaps
from vcage.layout.hands import HandClearance, hand_clearance
from vcage.sim.robots import load_robot

HAND = HandClearance(height=0.05, gap=0.095)


def test_a_panda_passes_over_low_things_and_has_its_palm_beside_what_it_grasps() -> None:
    assert hand_clearance(load_robot("dual_panda")) == HAND


def test_the_largest_hand_of_a_robot_counts() -> None:
    robot = load_robot("dual_panda")
    left = robot.arms["left"]
    larger = left.gripper.model_copy(update={"finger_length": 0.02, "palm_size": (0.3, 0.1)})
    arms = {**robot.arms, "left": left.model_copy(update={"gripper": larger})}
    found = hand_clearance(robot.model_copy(update={"arms": arms}))
    assert found == HandClearance(height=0.033, gap=0.143)


def test_only_what_a_palm_would_touch_beside_what_is_grasped_gets_more_room() -> None:
    grasped, low, high = (
        standing_at(name, (0.05, 0.05, z), 0.0, (0, 0)) for name, z in (("a", 0.04), ("b", 0.05), ("c", 0.2))
    )
    gaps = hand_gaps([replace(grasped, hand=HAND), low, high], margin=0.01)
    np.testing.assert_array_equal(gaps, [[0, 0, 0.085], [0, 0, 0], [0.085, 0, 0]])
    assert hand_gaps([grasped, low, high], margin=0.01) is None
    assert hand_gaps([replace(grasped, hand=HAND), low], margin=0.01) is None
