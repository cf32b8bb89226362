"""The close pictures of a scan show bar code and window."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from tests.example_scenes import robot, scene_of, thing
from vcage.base.geometry import Camera, Pose
from vcage.episodes import photographs
from vcage.episodes.photographs import CODE, WINDOW, Photographer, light_look, scan_cameras
from vcage.episodes.question import TOP
from vcage.schema.goals import Goal
from vcage.sim.cameras import observe, shoot
from vcage.sim.looks import look_world
from vcage.sim.state import WorldState
from vcage.sim.world import World
from vcage.tasks.reading import reading_poses
from vcage.tasks.scene_objects import SceneObject

SCANNED = Goal(subject="juice_carton", relation="scanned")


def scanning(*others: SceneObject) -> list[SceneObject]:
    """A scanner that reads the code of a carton in the middle of the table, and other things."""
    carton, scanner = thing("juice_carton"), thing("barcode_scanner", (0.2, 0.0))
    return [carton, scanner.moved(next(iter(reading_poses(scanner, carton, 0.74)))), *others]


def rendered(objects: Sequence[SceneObject]) -> World:
    world = look_world(*_of(objects))
    for o in objects:
        world.set_object_pose(o.id, o.pose)
    return world


def _of(objects: Sequence[SceneObject]) -> tuple:
    scene, models = scene_of(objects), {o.id: o.asset.model for o in objects}
    return scene, models, robot(), light_look(scene, models, robot(), np.random.default_rng(0))


def face(o: SceneObject, kind: str, camera: Camera) -> float:
    """Cosine of the angle between where a face of an object looks and where a camera stands; the largest."""
    found = []
    for one in o.asset.annotation.faces_of(kind):
        way = camera.pose.p - o.pose.apply(one.position)
        found.append(float(o.pose.rotation() @ np.asarray(one.axis) @ way / np.linalg.norm(way)))
    return max(found)


def in_the_middle(world: World, camera: Camera) -> str | None:
    """Id of the object in the middle of a camera's picture."""
    value = observe(world, camera).segmentation[camera.height // 2, camera.width // 2]
    return next((name for name, number in world.segmentation_ids.items() if number == value), None)


def test_one_camera_looks_onto_the_code_and_one_into_the_window() -> None:
    carton, scanner = objects = scanning()
    world = rendered(objects)
    cameras = scan_cameras(world, objects, carton.id)
    assert face(carton, "code", cameras[CODE]) > 0.3 and face(scanner, "reader", cameras[WINDOW]) > 0.3
    assert in_the_middle(world, cameras[CODE]) == carton.id
    assert in_the_middle(world, cameras[WINDOW]) == scanner.id


def test_a_camera_moves_to_the_other_side_of_an_obstacle() -> None:
    alone = scanning()
    first = scan_cameras(rendered(alone), alone, "juice_carton")[CODE]
    at = 0.5 * first.pose.p[:2]
    objects = scanning(thing("cereal_box", (float(at[0]), float(at[1])), yaw=np.pi / 2))
    world = rendered(objects)
    second = scan_cameras(world, objects, "juice_carton")[CODE]
    assert in_the_middle(world, first) == "cereal_box", "it would be in the way"
    assert in_the_middle(world, second) == "juice_carton"


def test_without_a_scanner_there_is_nothing_to_show() -> None:
    objects = [thing("juice_carton"), thing("block", (0.2, 0.0))]
    assert scan_cameras(rendered(objects), objects, "juice_carton") == {}


def test_only_the_moment_of_a_scan_is_looked_at_closely() -> None:
    objects = scanning()
    photographer = Photographer(*_of(objects), objects)
    state = photographer.world.state()
    assert {CODE, WINDOW} <= set(photographer.shots(state, [SCANNED], "left"))
    pressed = Goal(subject="juice_carton", relation="pressed", part="lid")
    for goals, arm in (([SCANNED], None), ([pressed], "left")):
        assert not {CODE, WINDOW} & set(photographer.shots(state, goals, arm))


def test_pictures_of_one_state_are_taken_once(monkeypatch: pytest.MonkeyPatch) -> None:
    objects = [thing("juice_carton")]
    photographer = Photographer(*_of(objects), objects)
    taken = []
    monkeypatch.setattr(photographs, "shoot", lambda world, camera: taken.append(camera) or shoot(world, camera))
    states = [photographer.world.state(), photographer.world.state()]
    first, again = map(photographer.shots, states)
    number = len(taken)
    assert number == len(first) and all(np.array_equal(first[name], again[name]) for name in first)
    photographer.empty_table()
    moved = WorldState({"juice_carton": Pose([0.1, 0.1, 0.8])}, states[0].joints)
    assert not np.array_equal(photographer.shots(moved)[TOP], first[TOP])
    assert np.array_equal(photographer.shots(states[1])[TOP], first[TOP])
    assert len(taken) == 3 * number + 1  # the empty table is seen from above alone
