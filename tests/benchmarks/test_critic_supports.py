"""Outcomes with a support pushed away or an object that slid off it, made in the simulator."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks._critic.played import Case, Played
from benchmarks._critic.supports import PUSHED, knocked_over, pushed_away, slid_off
from tests.example_scenes import TABLE_TOP, script_of, subtask, thing, world_of
from vcage.base.geometry import Pose
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.task import Task


def put_on(support: SceneObject, seed: int) -> Played:
    """A block that was put on the middle of the top of a support, by hand."""
    block = thing("block", (-0.3, -0.1), id="upper")
    step = subtask("upper", support.id)
    top = Pose([*support.aabb.mean(axis=0)[:2], support.aabb[1, 2] + 0.002])
    objects = [block, support]
    return Case(
        subtask=step,
        script=script_of(step, lambda task: raised(task, top)),
        objects={o.id: o for o in objects},
        slots={},
        build=lambda: world_of(objects),
        others=(),
        rng=np.random.default_rng(seed),
    ).play()


def raised(task: Task, pose: Pose) -> None:
    task.world.set_object_pose("upper", pose)
    task.world.settle()


SUPPORTS = {"a block": thing("block", (0.05, 0.05), id="lower"), "a plate": thing("plate", (0.05, 0.05), id="lower")}


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("support", SUPPORTS.values(), ids=SUPPORTS)
def test_a_support_that_was_pushed_away_stands_elsewhere_and_the_thing_beside_it(
    support: SceneObject, seed: int
) -> None:
    played = put_on(support, seed)
    assert played.shots.truth.success
    shots = pushed_away(played)
    assert shots is not None and not shots.truth.success
    now, was = played.now(shots.after), played.now(played.shots.after)
    way = np.linalg.norm((now["lower"].pose.p - was["lower"].pose.p)[:2])
    assert PUSHED[0] - 0.01 < way < PUSHED[1] + 0.01
    assert now["upper"].aabb[0, 2] == pytest.approx(TABLE_TOP, abs=0.005)
    apart = np.maximum(now["upper"].aabb[0] - now["lower"].aabb[1], now["lower"].aabb[0] - now["upper"].aabb[1])
    assert -0.005 < apart[:2].max() < 0.05


@pytest.mark.parametrize("seed", range(4))
def test_an_object_that_slid_off_lies_beside_its_support(seed: int) -> None:
    played = put_on(SUPPORTS["a block"], seed)
    shots = slid_off(played)
    assert shots is not None and not shots.truth.success
    now, was = played.now(shots.after), played.now(played.shots.after)
    assert np.linalg.norm(now["lower"].pose.p - was["lower"].pose.p) < 0.02
    assert now["upper"].aabb[0, 2] < TABLE_TOP + 0.01
    assert now["upper"].pose.p[2] < was["upper"].pose.p[2] - 0.01


def test_nothing_slides_off_a_flat_support() -> None:
    assert slid_off(put_on(SUPPORTS["a plate"], 0)) is None


def test_a_cube_is_not_knocked_over_as_it_stands_on_any_side_alike() -> None:
    assert knocked_over(put_on(SUPPORTS["a block"], 0)) is None
