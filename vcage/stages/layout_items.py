"""What the optimisation of a layout needs of each object of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from vcage.base.geometry import Pose
from vcage.layout.capacities import opening_for
from vcage.layout.hands import hand_clearance
from vcage.layout.items import TableItem, table_item
from vcage.layout.placement.reach import reach_for
from vcage.schema.scene import Scene
from vcage.sim.robots import load_robot
from vcage.stages.context import StageContext


def layout_items(
    scene: Scene,
    targets: Mapping[str, Pose],
    yaws: Mapping[str, float],
    inside: Mapping[str, str],
    context: StageContext,
) -> list[TableItem]:
    """Every object at its heading, with where it should be and may be.

    Args:
        scene: with its robot.
        targets: where the objects should be, by id.
        yaws: their headings, by id, radians.
        inside: what an object lies in or on, by id.
        context: the library, and what the robots reach.
    """
    objects = context.objects(scene)
    reach = context.reach(scene.robot, scene.workspace, scene.table)
    # Without an instruction each receptacle receives what either arm brings, and a scanner reads what either arm has.
    common = context.reach(scene.robot, scene.workspace, scene.table, every=scene.instruction is None)
    hand = hand_clearance(load_robot(scene.robot))
    items = []
    for o in objects:
        contents = [other.asset for other in objects if inside.get(other.id) == o.id]
        shared = o.record.role == "receptacle" or bool(o.asset.annotation.faces_of("reader"))
        items.append(
            replace(
                table_item(o.id, o.asset),
                yaws=(yaws[o.id],),
                target=(float(targets[o.id].p[0]), float(targets[o.id].p[1])),
                opening=opening_for(o.asset, contents),
                inside=inside.get(o.id),
                allowed=reach_for(o.asset, o.record.role, common if shared else reach),
                hand=hand if o.record.role == "content" else None,
            )
        )
    return items
