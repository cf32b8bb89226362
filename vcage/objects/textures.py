"""Pictures that a mesh file names, looked at before the mesh is read: trimesh passes over those it cannot open."""

from __future__ import annotations

import base64
import json
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from vcage.base.errors import InputFileError, OversizedFile
from vcage.base.pictures import picture_header

_JSON_CHUNK, _BIN_CHUNK = 0x4E4F534A, 0x004E4942
"""Types of the chunks of a binary glTF file."""

Source = tuple[str, Path | bytes | None]
"""What a texture is called, and its file or content; None where the mesh file is wrong about it."""


def tell_textures(path: Path, tell: Callable[[str], None]) -> None:
    """Tell of each colour texture that cannot be seen on a mesh: its plain colour is seen in its place.

    Args:
        path: of the mesh: glTF, binary glTF, or OBJ with its materials.
        tell: takes a sentence about each.

    Raises:
        OversizedFile: a texture is too large to be read.
    """
    for name, source in dict.fromkeys(_sources(path)):
        if isinstance(source, Path) and not source.is_file():
            why = "is missing"
        elif source is None:
            why = "is not in the file"
        else:
            why = _why_not(source, f"{path}: the texture {name!r}")
        if why:
            tell(f"{path}: the texture {name!r} {why}; the plain colour of its material is seen")


def _why_not(source: Path | bytes, name: str) -> str:
    try:
        picture_header(source, name)
    except OversizedFile:
        raise
    except InputFileError as error:
        return error.message.removeprefix(f"{name} ")
    return ""


def _sources(path: Path) -> Iterator[Source]:
    """The colour textures that a mesh file names; none of a file that is no mesh, which whoever reads it refuses."""
    try:
        if path.suffix.lower() == ".obj":
            yield from _of_obj(path)
        elif path.suffix.lower() in (".glb", ".gltf"):
            yield from _of_gltf(path)
    except (OSError, ValueError, LookupError, TypeError, AttributeError, struct.error, RecursionError):
        return


def _of_obj(path: Path) -> Iterator[Source]:
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        words = line.split(maxsplit=1)
        if len(words) < 2 or words[0] != "mtllib":
            continue
        library = path.parent / words[1].strip()
        if not library.is_file():
            yield library.name, library
            continue
        for entry in library.read_text(encoding="utf-8", errors="replace").splitlines():
            key, _, name = entry.strip().partition(" ")
            if key.lower() == "map_kd" and name.strip():
                yield name.strip(), library.parent / name.strip()


def _of_gltf(path: Path) -> Iterator[Source]:
    header, binary = _gltf(path.read_bytes())
    for material in header.get("materials", []):
        used = material.get("pbrMetallicRoughness", {}).get("baseColorTexture")
        if used is None:
            continue
        texture = header["textures"][used["index"]]
        extended = (found["source"] for found in texture.get("extensions", {}).values() if "source" in found)
        number = next(extended, texture.get("source"))
        image = header["images"][number]
        yield image.get("name") or image.get("uri", "")[:80] or f"image {number}", _image(header, binary, image, path)


def _image(header: dict[str, Any], binary: bytes, image: dict[str, Any], path: Path) -> Path | bytes | None:
    if "bufferView" in image:
        view = header["bufferViews"][image["bufferView"]]
        start = view.get("byteOffset", 0)
        return binary[start : start + view["byteLength"]] if view.get("buffer", 0) == 0 else None
    uri = image.get("uri")
    if not uri:
        return None
    if uri.startswith("data:"):
        return base64.b64decode(uri.partition(",")[2])
    return path.parent / unquote(uri)


def _gltf(data: bytes) -> tuple[dict[str, Any], bytes]:
    """The JSON of a glTF file, and the binary chunk that a binary one has."""
    if not data.startswith(b"glTF"):
        return json.loads(data), b""
    chunks, at = {}, 12
    while at + 8 <= len(data):
        length, kind = struct.unpack_from("<II", data, at)
        chunks[kind] = data[at + 8 : at + 8 + length]
        at += 8 + length
    return json.loads(chunks[_JSON_CHUNK]), chunks.get(_BIN_CHUNK, b"")
