"""Tools with a head, over what they hit."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import thing
from vcage.base.geometry import Pose
from vcage.tasks.hitting import SETTINGS, free_hitting_poses, hits, hitting_poses

HAMMER, BLOCK = thing("hammer", (-0.2, 0.0), 0.7), thing("block", (0.05, 0.05), 0.3)


@pytest.mark.parametrize("name", ["block", "apple", "cereal_box", "plate"])
def test_the_head_is_held_over_the_middle_and_clear_of_the_top(name: str) -> None:
    target = thing(name, (0.05, 0.05), 0.3)
    for pose in hitting_poses(HAMMER, target):
        held = HAMMER.moved(pose)
        assert hits(held, target)
        assert held.lowest == pytest.approx(target.aabb[1, 2] + SETTINGS.above_m, abs=0.002)


def test_the_heading_it_has_comes_first() -> None:
    first, *others = hitting_poses(HAMMER, BLOCK)
    assert first.yaw == pytest.approx(0.7) and len(others) == SETTINGS.headings - 1


@pytest.mark.parametrize(
    ("shift", "over"),
    [((0.0, 0.015), True), ((0.0, 0.03), False), ((-0.025, 0.0), False)],
    ids=["near", "beside", "off"],
)
def test_a_head_beside_the_middle_hits_nothing(shift: tuple[float, float], over: bool) -> None:
    there = next(hitting_poses(HAMMER, BLOCK, above_m=0.0))
    assert hits(HAMMER.moved(Pose(there.p + [*shift, 0.0], there.q)), BLOCK) is over


def test_a_head_that_faces_up_hits_nothing() -> None:
    there = next(hitting_poses(HAMMER, BLOCK, above_m=0.0))
    over = Pose(there.p, there.q) * Pose(q=[0.0, 1.0, 0.0, 0.0])
    at = HAMMER.asset.annotation.faces_of("head")[0].position
    assert not hits(HAMMER.moved(Pose(over.p + there.apply(at) - over.apply(at), over.q)), BLOCK)


def test_what_has_no_head_hits_nothing() -> None:
    assert not [*hitting_poses(thing("banana"), BLOCK)] and not hits(BLOCK, BLOCK)


def test_what_is_in_the_way_is_named() -> None:
    ring = [
        thing("cereal_box", (0.05 + 0.13 * np.cos(a), 0.05 + 0.13 * np.sin(a)), a + np.pi / 2, id=f"box_{number}")
        for number, a in enumerate(np.linspace(0, 2 * np.pi, 5, endpoint=False).tolist())
    ]
    poses, met = free_hitting_poses(HAMMER, BLOCK, ring)
    assert not poses and met is not None and met.id.startswith("box_")
