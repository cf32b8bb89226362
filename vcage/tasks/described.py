"""Check the descriptions of a scene against its objects and their moving parts where they are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from vcage.base.errors import InfeasibleScene
from vcage.plans.descriptions import false_descriptions, false_in_words
from vcage.plans.relations import ground_box
from vcage.schema.asset import PhysicalModel
from vcage.schema.goals import Description
from vcage.schema.robot import Robot
from vcage.schema.scene import Scene
from vcage.sim.world import World
from vcage.tasks.scene_objects import SceneObject


def untrue(scene: Scene, objects: Sequence[SceneObject]) -> list[Description]:
    """The descriptions of a scene that are not true.

    Args:
        scene: with its descriptions and its workspace.
        objects: of the scene, where they stand.
    """
    boxes = {o.id: o.aabb for o in objects}
    parts = {(d.reference, d.part) for d in scene.descriptions if d.part is not None}
    boxes |= {f"{o.id}/{part}": _box(o, part) for o in objects for name, part in parts if o.id == name}
    return false_descriptions(scene.descriptions, boxes, ground_box(scene.workspace, scene.table.height))


def complaints(scene: Scene, objects: Sequence[SceneObject]) -> list[str]:
    """Complaints about where the objects stand, a sentence for each description that is not true."""
    return false_in_words(untrue(scene, objects), {o.id: o.phrase for o in scene.objects})


def require_described(scene: Scene, objects: Sequence[SceneObject], where: str) -> None:
    """Check that all descriptions of a scene are true.

    Args:
        scene, objects: as :func:`untrue` takes them.
        where: which layout it is, in words.

    Raises:
        InfeasibleScene: names those that are not.
    """
    if found := complaints(scene, objects):
        names = sorted({name for d in untrue(scene, objects) for name in (d.subject, d.reference)})
        raise InfeasibleScene(
            f"in {where} {'; '.join(found)}",
            hint="try another --seed; or say it otherwise, or with fewer objects",
            details={"objects": names, "descriptions": found},
        )


def require_settled(
    scene: Scene, models: Mapping[str, PhysicalModel], objects: Sequence[SceneObject], where: str, robot: Robot | None
) -> None:
    """:func:`require_described` of the objects when they have come to rest; where nothing is described, nothing is
    simulated.

    Args:
        scene, objects, where: as :func:`require_described` takes them.
        models: of the objects, by id.
        robot: of the scene; None for no robot.
    """
    if scene.descriptions:
        world = World.of_scene(scene, models, robot)
        world.settle()
        settled = [o.moved(world.object_pose(o.id), world.body(o.id).joints) for o in objects]
        require_described(scene, settled, where)


def _box(o: SceneObject, part: str) -> np.ndarray:
    """(2, 3) world box of a moving part."""
    corners = o.part_box(part).corners
    return np.stack([corners.min(axis=0), corners.max(axis=0)])
