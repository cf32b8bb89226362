"""The same files loaded by SAPIEN, as RoboTwin loads them, and by us come to lie in the same places."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from vcage.objects.importers.robotwin import import_robotwin
from vcage.objects.library import Library

QUARTER_TURN = [0.707106781, 0, 0, 0.707106781]


def corners(entity_pose, shapes) -> np.ndarray:
    """(2, 3) bounding box in the world."""
    points = [
        (entity_pose * shape.local_pose).to_transformation_matrix()
        @ np.vstack([(np.asarray(shape.vertices) * shape.scale).T, np.ones(len(shape.vertices))])
        for shape in shapes
    ]
    points = np.hstack(points)[:3].T
    return np.stack([points.min(axis=0), points.max(axis=0)])


def ours(asset, link: str | None) -> np.ndarray:
    points = np.concatenate([piece.vertices for piece in asset.pieces_of(link)])
    return np.stack([points.min(axis=0), points.max(axis=0)])


def imported(folder: Path, into: Path):
    (entry,) = import_robotwin(folder, into)
    return Library.load(into).asset(entry.name)


def test_a_rigid_object(rigid, into):
    import sapien

    rigid.data["scale"] = [0.02, 0.05, 0.03]
    asset = imported(rigid.write().folder, into)
    shapes = sapien.physx.PhysxCollisionShapeConvexMesh.load_multiple(
        str(rigid.folder / "collision" / "base0.glb"), rigid.data["scale"], sapien.physx.PhysxMaterial(1, 1, 0)
    )
    theirs = corners(sapien.Pose(q=[0.707106781, 0.707106781, 0, 0]), shapes)
    origin = np.append(theirs[:, :2].mean(axis=0), theirs[0, 2])
    np.testing.assert_allclose(ours(asset, None), theirs - origin, atol=1e-5)


@pytest.mark.parametrize("start", [[0.0, 0.0], [0.05, 0.7]], ids=["closed", "ajar"])
def test_an_articulated_object(cabinet, into, tmp_path, start):
    import sapien

    cabinet.data["init_qpos"] = start
    cabinet.write()
    path = cabinet.folder / "mobility.urdf"
    lid = """<link name="lid"><visual><geometry><box size=".1 .2 .02"/></geometry></visual>
      <collision><origin xyz=".05 0 .01" rpy="0 0 .3"/>
      <geometry><mesh filename="body.obj" scale=".5 -.3 .2"/></geometry></collision></link>
      <joint name="hinge" type="revolute"><origin xyz=".1 0 .3" rpy=".2 .1 1.5"/><axis xyz="0 1 1"/>
      <parent link="body"/><child link="lid"/><limit lower="-.1" upper="1.2"/></joint></robot>"""
    path.write_text(path.read_text().replace("</robot>", lid))
    asset = imported(cabinet.folder.parent, into)

    bare = cabinet.folder / "bare.urdf"
    bare.write_text(re.sub(r"<visual>.*?</visual>", "", path.read_text(), flags=re.DOTALL))
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    loader = scene.create_urdf_loader()
    loader.scale, loader.fix_root_link, loader.load_multiple_collisions_from_file = 0.5, True, True
    articulation = loader.load(str(bare))
    articulation.set_root_pose(sapien.Pose(q=QUARTER_TURN))
    articulation.set_qpos([start[0], start[1]])
    boxes = {
        link.name: corners(link.entity_pose, link.collision_shapes)
        for link in articulation.links
        if link.collision_shapes
    }
    shift = boxes["body"][0] - ours(asset, None)[0]
    for name, link in (("body", None), ("drawer", "drawer"), ("lid", "lid")):
        np.testing.assert_allclose(ours(asset, link), boxes[name] - shift, atol=2e-5)
    hinge = asset.model.link("lid").joint
    frame = articulation.find_joint_by_name("hinge").global_pose.to_transformation_matrix()
    np.testing.assert_allclose(hinge.axis, frame[:3, 0], atol=1e-5)
    np.testing.assert_allclose(hinge.origin, frame[:3, 3] - shift, atol=2e-5)
    assert (hinge.lower, hinge.upper) == pytest.approx((-0.1 - start[1], 1.2 - start[1]))
