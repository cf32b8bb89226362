"""Rigid objects of RoboTwin: where things come to lie, and what each defect is called."""

from __future__ import annotations

import json
import re
import zlib
from pathlib import Path

import numpy as np
import pytest
import trimesh

from tests.objects.importers.conftest import TOP_DOWN, frame
from vcage.base.errors import OversizedFile
from vcage.base.geometry import quat_to_rotation
from vcage.base.pictures import write_picture
from vcage.objects.importers.robotwin import import_robotwin
from vcage.objects.library import Library

UPRIGHT = quat_to_rotation([0.707106781, 0.707106781, 0, 0])
GRASP = np.array([[0, 0, 1], [-1, 0, 0], [0, -1, 0]])


def imported(rigid, into: Path):
    """The asset in our library, and the warnings."""
    (entry,) = import_robotwin(rigid.folder, into)
    if entry.error is not None:
        raise entry.error
    return Library.load(into).asset(entry.name), entry.warnings


def actor(scale) -> np.ndarray:
    """RoboTwin's pose of the actor whose object stands where ours does: its mesh's origin in our object frame."""
    upright = np.array([(1, 1, -2), (9, 3, 2)]) * scale @ UPRIGHT.T  # the tray's corners
    lower, upper = upright.min(axis=0), upright.max(axis=0)
    pose = np.eye(4)
    pose[:3, :3] = UPRIGHT
    pose[:3, 3] = -np.array([(lower[0] + upper[0]) / 2, (lower[1] + upper[1]) / 2, lower[2]])
    return pose


def world_point(matrix, scale) -> np.ndarray:
    """RoboTwin's formula: T_actor · M, with the translation multiplied by the scale per component."""
    local = np.array(matrix, dtype=float)
    local[:3, 3] *= scale
    return actor(scale) @ local


@pytest.mark.parametrize("scale", [[0.025, 0.025, 0.025], [0.02, 0.05, 0.03]], ids=["uniform", "per axis"])
def test_points_lie_where_robotwin_puts_them(rigid, into, scale):
    rigid.data["scale"] = scale
    asset, warnings = imported(rigid.write(), into)
    assert warnings == []
    for ours, matrix in zip(asset.annotation.contact_points, rigid.data["contact_points_pose"], strict=True):
        world = world_point(matrix, scale)
        gripper = world[:3, :3] @ GRASP
        np.testing.assert_allclose(ours.position, world[:3, 3], atol=1e-5)
        np.testing.assert_allclose(ours.approach, gripper[:, 0], atol=1e-5)
        np.testing.assert_allclose(ours.closing, gripper[:, 1], atol=1e-5)
    (receptacle,) = asset.annotation.functional_points
    world = world_point(rigid.data["functional_matrix"][0], scale)
    np.testing.assert_allclose(receptacle.position[:2], world[:2, 3], atol=1e-5)
    np.testing.assert_allclose(receptacle.axis, -world[:3, 2], atol=1e-5)


def test_the_origin_is_at_the_centre_of_the_bottom_and_z_is_up(rigid, into):
    asset, _ = imported(rigid.write(), into)
    np.testing.assert_allclose(asset.bounds, [[-0.1, -0.05, 0], [0.1, 0.05, 0.05]], atol=1e-6)


def test_every_component_of_the_collision_mesh_is_one_convex_piece(rigid, into):
    asset, _ = imported(rigid.write(), into)
    assert len(asset.pieces) == 5
    assert asset.grasp_width(asset.annotation.contact_points[0]) == pytest.approx(0.005, abs=1e-6)


def test_a_functional_point_between_walls_holds_things_in_it_on_the_floor(rigid, into):
    asset, _ = imported(rigid.write(), into)
    (point,) = asset.annotation.functional_points
    assert (point.holds, point.name) == ("in", "the inside")
    assert point.position[2] == pytest.approx(0.005, abs=1e-6)
    assert asset.opening(point).depth == pytest.approx(0.045, abs=1e-3)


def test_a_functional_point_without_walls_holds_things_on_it(rigid, into):
    rigid.parts = rigid.parts[:1]
    rigid.data["contact_points_pose"] = []
    rigid.data["contact_points_group"] = rigid.data["contact_points_mask"] = []
    asset, _ = imported(rigid.write(), into)
    assert asset.annotation.functional_points[0].holds == "on"


@pytest.mark.parametrize(
    ("matrix", "reason"),
    [
        ([[1, 0, 0, 5], [0, 0, 1, 1.25], [0, -1, 0, 0], [0, 0, 0, 1]], "points up"),
        ([[0, 0, 1, 9], [0, 1, 0, 2], [-1, 0, 0, 0], [0, 0, 0, 1]], "as a tool's does"),
        ([[1, 0, 0, 1.1], [0, 0, -1, 1], [0, 1, 0, 0], [0, 0, 0, 1]], "as the frame of a foot does"),
        ([[1, 0, 0, 5], [0, 0, -1, -1], [0, 1, 0, 0], [0, 0, 0, 1]], "under or outside the object"),
    ],
    ids=["up", "tool", "foot", "under the table"],
)
def test_a_functional_frame_that_receives_nothing_is_kept_out_and_named(rigid, into, matrix, reason):
    rigid.data["functional_matrix"].append(matrix)
    asset, warnings = imported(rigid.write(), into)
    assert [point.id for point in asset.annotation.functional_points] == [0]
    (warning,) = warnings
    assert "model_data0.json: field functional_matrix.1" in warning and reason in warning


def test_words_come_from_badly_spelt_keys_and_from_points_info(rigid, into):
    rigid.data["discription"] = "A red tray."
    rigid.data["contact_points_discription"] = ["left wall"]
    rigid.info = {"contact_points": [{"id": [0, 1], "description": "a wall", "usage": "grasp"}]}
    asset, _ = imported(rigid.write(), into)
    assert [point.name for point in asset.annotation.contact_points] == ["left wall", "a wall"]
    words = asset.annotation.words
    assert (words.name, words.plural, words.description) == ("deep tray", "deep trays", "A red tray.")
    assert asset.variant.colour == "red"


def test_the_picture_of_the_mesh_is_kept(rigid, into):
    from PIL import Image

    rigid.write()
    picture = np.arange(8 * 8 * 3, dtype=np.uint8).reshape(8, 8, 3)
    mesh = trimesh.util.concatenate(rigid.parts)
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=Image.fromarray(picture))
    mesh.visual = trimesh.visual.TextureVisuals(
        uv=np.random.default_rng(0).random((len(mesh.vertices), 2)), material=material
    )
    (rigid.folder / "visual" / "base0.glb").write_bytes(mesh.export(file_type="glb"))
    asset, _ = imported(rigid, into)
    (seen,) = trimesh.load_scene(asset.model.visual).geometry.values()
    np.testing.assert_array_equal(np.asarray(seen.visual.material.baseColorTexture.convert("RGB")), picture)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"scale": [0.025, 0, 0.025]}, "scale"),
        ({"scale": [0.025, -0.025, 0.025]}, "scale"),
        ({"scale": [0.025, 0.025]}, "scale"),
        ({"scale": "small"}, "scale"),
    ],
    ids=["zero", "negative", "two numbers", "text"],
)
def test_an_invalid_scale_refuses_the_object(rigid, into, change, field):
    rigid.data.update(change)
    (entry,) = import_robotwin(rigid.write().folder, into)
    assert f"model_data0.json: field {field}: got" in entry.error.message and "expected" in entry.error.message
    assert list(into.glob("*")) == []


@pytest.mark.parametrize(
    ("field", "value", "named", "expected"),
    [
        ("contact_points_pose", [np.eye(3).tolist()], "contact_points_pose.0", "expected 4×4"),
        ("contact_points_pose", [(2 * np.eye(4)).tolist()], "contact_points_pose.0", "a last row of 0 0 0 1"),
        ("contact_points_pose", [np.diag([1.0, 1, 2, 1]).tolist()], "contact_points_pose.0", "expected a rotation"),
        ("contact_points_pose", [np.diag([1.0, 1, -1, 1]).tolist()], "contact_points_pose.0", "expected a rotation"),
        ("contact_points_pose", "none", "contact_points_pose", "expected a list"),
        ("contact_points_group", [[0], [7]], "contact_points_group.1", "indices from 0 to 1"),
        ("contact_points_mask", [True], "contact_points_mask", "expected one for each of 2 groups"),
        ("contact_point_pose", [], "contact_point_pose", "did you mean contact_points_pose?"),
    ],
)
def test_a_wrong_field_causes_a_warning_with_its_name(rigid, into, field, value, named, expected):
    rigid.data[field] = value
    _, warnings = imported(rigid.write(), into)
    assert any(f"model_data0.json: field {named}:" in w and expected in w for w in warnings)


def test_a_masked_group_keeps_its_points_out(rigid, into):
    rigid.data["contact_points_mask"] = [True, False]
    asset, warnings = imported(rigid.write(), into)
    assert [point.id for point in asset.annotation.contact_points] == [0]
    assert "keeps out the contact points [1]" in warnings[0]


def test_a_contact_point_outside_the_object_is_left_out(rigid, into):
    rigid.data["contact_points_pose"][1][0][3] = 20.0
    asset, warnings = imported(rigid.write(), into)
    assert [point.id for point in asset.annotation.contact_points] == [0]
    assert "field contact_points_pose.1: lies outside the object: got (0.375" in warnings[0]


def test_without_model_data_scale_1_is_assumed_for_small_objects(rigid, into):
    rigid.parts = [trimesh.creation.box([0.1, 0.05, 0.1])]
    asset, warnings = imported(rigid.write(data=False), into)
    assert asset.size == pytest.approx([0.1, 0.1, 0.05])
    assert "model_data0.json: missing" in warnings[0] and "scale 1 is assumed" in warnings[0]


def test_without_model_data_a_mesh_in_other_units_is_refused(rigid, into):
    (entry,) = import_robotwin(rigid.write(data=False).folder, into)
    assert "field scale: missing, and at scale 1 the object would measure 8 × 4 × 2 m" in entry.error.message


def test_a_scale_in_another_unit_is_refused_with_the_size_it_would_give(rigid, into):
    rigid.data["scale"] = [25, 25, 25]
    (entry,) = import_robotwin(rigid.write().folder, into)
    assert "field scale: with it the object would measure 200 × 100 × 50 m; expected" in entry.error.message


def test_a_scale_that_leaves_nothing_to_be_seen_is_refused(rigid, into):
    rigid.data["scale"] = [1e-9, 1e-9, 1e-9]
    (entry,) = import_robotwin(rigid.write().folder, into)
    assert entry.error.exit_code == 3


def test_without_a_visual_mesh_the_collision_mesh_is_seen(rigid, into):
    _, warnings = imported(rigid.write(visual=False), into)
    assert "visual/base0.glb: missing" in warnings[0]


def test_without_a_collision_mesh_the_pieces_come_from_the_visible_mesh_and_stay_open(rigid, into):
    rigid.parts = [trimesh.boolean.union(_overlapping(rigid.parts))]
    asset, warnings = imported(rigid.write(collision=False), into)
    assert "collision/base0.glb: missing" in warnings[0]
    assert len(warnings) == 1
    (point,) = asset.annotation.functional_points
    assert (point.holds, point.position[2]) == ("in", pytest.approx(0.005, abs=0.002))


def _overlapping(parts: list[trimesh.Trimesh]) -> list[trimesh.Trimesh]:
    """The same boxes, grown a little: a union of boxes that only touch has seams."""
    return [
        part.copy().apply_translation(-part.centroid).apply_scale(1.001).apply_translation(part.centroid)
        for part in parts
    ]


def test_an_obj_takes_the_place_of_a_missing_glb(rigid, into):
    rigid.write(visual=False)
    (rigid.folder / "visual" / "textured0.obj").write_text(
        trimesh.util.concatenate(rigid.parts).export(file_type="obj")
    )
    _, warnings = imported(rigid, into)
    assert warnings == []


@pytest.mark.parametrize("kind", ["visual", "collision"])
def test_a_mesh_that_does_not_load_is_named(rigid, into, kind):
    rigid.write()
    (rigid.folder / kind / "base0.glb").write_bytes(b"glTF nonsense")
    (entry,) = import_robotwin(rigid.folder, into)
    said = entry.error.message if kind == "visual" else entry.warnings[0]
    assert f"{kind}/base0.glb is not a mesh that can be read" in said


def test_files_that_windows_saved_are_read(rigid, into):
    rigid.info = {"contact_points": [{"id": 0, "description": "left rim"}]}
    rigid.write()
    for path in rigid.folder.glob("*.json"):
        path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes().replace(b",", b",\r\n"))
    (entry,) = import_robotwin(rigid.folder, into)
    assert entry.error is None and not any("json" in warning for warning in entry.warnings)


def test_damaged_json_is_named(rigid, into):
    rigid.write()
    (rigid.folder / "model_data0.json").write_text("{")
    (entry,) = import_robotwin(rigid.folder, into)
    assert "model_data0.json is not JSON" in entry.error.message


def test_a_bad_variant_does_not_lose_the_good_one(rigid, into):
    rigid.write()
    rigid.data["scale"] = [0, 0, 0]
    rigid.write(number=1)
    asset, warnings = imported(rigid, into)
    assert [variant.id for variant in asset.annotation.variants] == ["base0"]
    assert "model_data1.json: field scale" in warnings[0] and "this variant is left out" in warnings[0]


def test_variants_with_the_same_points_are_one_object(rigid, into):
    rigid.write().write(number=12)
    asset, _ = imported(rigid, into)
    assert [variant.id for variant in asset.annotation.variants] == ["base0", "base12"]


def test_a_variant_with_other_points_becomes_an_object_of_its_own(rigid, into):
    rigid.write()
    rigid.data["contact_points_pose"][0][2][3] = 1.0
    rigid.write(number=3)
    entries = import_robotwin(rigid.folder, into)
    assert [entry.name for entry in entries] == ["rt_deep-tray", "rt_deep-tray_3"]
    assert "imported as rt_deep-tray_3" in entries[0].warnings[0]
    assert json.loads((into / "rt_deep-tray_3" / "asset.json").read_text())["variants"][0]["id"] == "base3"


# --- textures, and grasps through the table --------------------------------------------------------------


def textured_obj(rigid, written: bool) -> Path:
    """The tray as OBJ, whose material names a picture; the path of the picture, there if ``written``."""
    folder = rigid.write(visual=False).folder / "visual"
    mesh = trimesh.util.concatenate(rigid.parts)
    mesh.visual = trimesh.visual.TextureVisuals(uv=np.zeros((len(mesh.vertices), 2)))
    text, _ = trimesh.exchange.obj.export_obj(mesh, return_texture=True)
    (folder / "textured0.obj").write_text("mtllib look.mtl\nusemtl wood\n" + re.sub("(mtllib|usemtl)", "# ", text))
    (folder / "look.mtl").write_bytes(b"newmtl wood\r\nKd 0.9 0.9 0.9\r\nmap_Kd wood grain.png\r\n")
    picture = folder / "wood grain.png"
    if written:
        write_picture(picture, np.full((4, 4, 3), (20, 20, 200), np.uint8))
    return picture


def test_a_present_texture_is_used_without_a_warning(rigid, into):
    textured_obj(rigid, written=True)
    asset, warnings = imported(rigid, into)
    assert asset.variant.colour == "blue" and not any("texture" in warning for warning in warnings)


def test_a_missing_texture_is_reported(rigid, into):
    textured_obj(rigid, written=False)
    asset, warnings = imported(rigid, into)
    assert asset.variant.colour == "white"
    assert any("textured0.obj: the texture 'wood grain.png' is missing" in warning for warning in warnings)


def test_a_damaged_texture_is_reported(rigid, into):
    textured_obj(rigid, written=True).write_bytes(b"no picture")
    _, warnings = imported(rigid, into)
    assert any("'wood grain.png' cannot be read as a picture" in warning for warning in warnings)


def test_a_too_large_texture_refuses_its_variant(rigid, into):
    path = textured_obj(rigid, written=True)
    data = bytearray(path.read_bytes())
    data[16:24] = (30_000).to_bytes(4, "big") * 2
    data[29:33] = zlib.crc32(data[12:29]).to_bytes(4, "big")
    path.write_bytes(data)
    with pytest.raises(OversizedFile, match=r"'wood grain\.png' is too large: 30000 x 30000 pixels"):
        imported(rigid, into)


def test_a_texture_enlarged_beyond_the_limit_after_the_import_is_refused(rigid, into):
    asset, _ = imported(rigid.write(), into)
    path = Path(asset.model.visual)
    data = bytearray(path.read_bytes())
    at = data.index(b"\x89PNG") + 16
    data[at : at + 8] = (30_000).to_bytes(4, "big") * 2
    data[at + 13 : at + 17] = zlib.crc32(data[at - 4 : at + 13]).to_bytes(4, "big")
    path.write_bytes(data)
    with pytest.raises(OversizedFile, match="30000 x 30000"):
        Library.load(into).asset("rt_deep-tray")


@pytest.mark.parametrize("image", [{"uri": "gone.png"}, {}], ids=["file", "nothing"])
def test_a_texture_missing_in_a_binary_gltf_is_reported(rigid, into, image):
    path = rigid.write().folder / "visual" / "base0.glb"
    header, binary = gltf_of(path)
    header["images"] = [image]
    header["textures"] = [{"source": 0}]
    header["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    write_gltf(path, header, binary)
    _, warnings = imported(rigid, into)
    assert any("base0.glb: the texture" in warning and "plain colour" in warning for warning in warnings)


def gltf_of(path: Path) -> tuple[dict, bytes]:
    data = path.read_bytes()
    length = int.from_bytes(data[12:16], "little")
    return json.loads(data[20 : 20 + length]), data[20 + length :]


def write_gltf(path: Path, header: dict, binary: bytes) -> None:
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    chunks = len(text).to_bytes(4, "little") + b"JSON" + text + binary
    path.write_bytes(b"glTF" + (2).to_bytes(4, "little") + (12 + len(chunks)).to_bytes(4, "little") + chunks)


@pytest.mark.parametrize(
    ("rotation", "height", "told"),
    [
        (TOP_DOWN, 0.9, "below the bottom, under the table"),
        ([[0, 0, 1], [0, -1, 0], [1, 0, 0]], 1.2, "is grasped from below"),
        ([[0, 0, 1], [0, -1, 0], [1, 0, 0]], 2.9, None),
        (TOP_DOWN, 1.2, None),
    ],
    ids=["under", "from below", "from below but high", "from above"],
)
def test_a_grasp_through_the_table_is_left_out(rigid, into, rotation, height, told):
    rigid.data["contact_points_pose"][1] = frame(rotation, [8.9, height, 0.5])
    asset, warnings = imported(rigid.write(), into)
    assert [point.id for point in asset.annotation.contact_points] == ([0] if told else [0, 1])
    assert any("contact_points_pose.1" in w and told in w for w in warnings) if told else not warnings
