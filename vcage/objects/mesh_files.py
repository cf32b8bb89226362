"""Files that a mesh names, such as materials, pictures and buffers: regular files of its object, and no others."""

from __future__ import annotations

import base64
import json
import os.path
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from trimesh.resolvers import FilePathResolver

from vcage.base.errors import DamagedFile, InputFileError, OversizedFile
from vcage.base.pictures import picture_header
from vcage.base.placeholders import require_fetched
from vcage.base.reading import open_regular


class MeshFiles(FilePathResolver):
    """Find and read files that a mesh names, for trimesh.

    trimesh skips unreadable files, so :meth:`require_regular` checks afterwards.

    Args:
        mesh: path of the mesh.
        root: folder that names may lead to; by default the mesh's own.
        max_bytes: of the largest file that is read.
    """

    def __init__(self, mesh: Path, root: Path | None = None, max_bytes: int = 1_000_000_000):
        super().__init__(str(mesh))
        self.mesh, self.root, self._max_bytes = mesh, root or mesh.parent, max_bytes
        self._folders = [mesh.parent]
        self._refused: list[InputFileError] = []

    def find(self, name: str) -> Path | None:
        """Return the object's file of this name, or None.

        A name that leads elsewhere, as on the author's machine, means the file of its last part beside the mesh.
        """
        name = name.strip()
        wanted = (name, unquote(name), Path(name).name)
        for path in (folder / one for folder in self._folders for one in wanted if one and "\0" not in one):
            inside = Path(os.path.normpath(path)).is_relative_to(os.path.normpath(self.root))
            if inside and os.path.lexists(path):
                return path
        return None

    def locate(self, name: str) -> Path | None:
        """As :meth:`find`, for a file that can be read.

        Raises:
            DamagedFile: it is a pipe, a device, a folder, or was not fetched; names mesh and file.
        """
        path = self.find(name)
        if path is not None:
            try:
                require_fetched(path)
            except DamagedFile as error:
                named = f"{self.mesh} names {name.strip()!r}: {error.message}"
                raise DamagedFile(named, hint=error.hint, details={"path": str(self.mesh)}) from error
        return path

    def get(self, name: str) -> bytes:
        """The content of a file, for trimesh; raises as :meth:`locate`, and FileNotFoundError."""
        try:
            path = self.locate(name)
            if path is None:
                raise FileNotFoundError(name)
            with open_regular(path, "a file of a mesh", self._max_bytes) as handle:
                self._folders.append(path.parent)  # names in a library of materials are relative to it
                return handle.read()
        except InputFileError as error:
            self._refused.append(error)
            raise

    def require_regular(self) -> None:
        """Raise what :meth:`get` refused, if anything."""
        if self._refused:
            raise self._refused[0]


_JSON_CHUNK, _BIN_CHUNK = 0x4E4F534A, 0x004E4942
"""Types of the chunks of a binary glTF file."""

Source = tuple[str, Path | bytes | None]
"""Name of a texture, and its file or content; None where the object has no such file, or the mesh no such content."""


def report_unseen_textures(path: Path, report: Callable[[str], None], root: Path | None = None) -> None:
    """Report each colour texture of a mesh that cannot be shown; the plain colour of its material replaces it.

    Args:
        path: of the mesh: glTF, binary glTF, or OBJ with its materials.
        report: called with a sentence about each.
        root: folder of the object; by default the mesh's own.

    Raises:
        DamagedFile: the mesh, or a file that it names, is a pipe, a device or a folder, or was not fetched; names it.
        OversizedFile: a texture is too large to be read.
    """
    require_fetched(path)
    for name, source in dict.fromkeys(_sources(path, MeshFiles(path, root))):
        why = "is missing" if source is None else _why_not(source, f"{path}: the texture {name!r}")
        if why:
            report(f"{path}: the texture {name!r} {why}; the plain colour of its material is shown")


def _why_not(source: Path | bytes, name: str) -> str:
    try:
        picture_header(source, name)
    except OversizedFile:
        raise
    except InputFileError as error:
        return error.message.removeprefix(f"{name} ")
    return ""


def _sources(path: Path, files: MeshFiles) -> Iterator[Source]:
    """Yield the colour textures named by a mesh file; none for another file: reading it raises."""
    try:
        if path.suffix.lower() == ".obj":
            yield from _of_obj(path, files)
        elif path.suffix.lower() in (".glb", ".gltf"):
            yield from _of_gltf(path, files)
    except (OSError, ValueError, LookupError, TypeError, AttributeError, struct.error, RecursionError):
        return


def _of_obj(path: Path, files: MeshFiles) -> Iterator[Source]:
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        words = line.split(maxsplit=1)
        if len(words) < 2 or words[0] != "mtllib":
            continue
        if files.locate(words[1]) is None:
            yield words[1].strip(), None
            continue
        for entry in files.get(words[1]).decode(errors="replace").splitlines():
            key, *name = entry.split(maxsplit=1)
            if key.lower() == "map_kd" and name:
                yield name[0].strip(), files.locate(name[0])


def _of_gltf(path: Path, files: MeshFiles) -> Iterator[Source]:
    header, binary = _gltf(path.read_bytes())
    for named in (*header.get("buffers", []), *header.get("images", [])):  # all of them are opened
        if _is_file(named.get("uri", "")):
            files.locate(named["uri"])
    for material in header.get("materials", []):
        used = material.get("pbrMetallicRoughness", {}).get("baseColorTexture")
        if used is None:
            continue
        texture = header["textures"][used["index"]]
        extended = (found["source"] for found in texture.get("extensions", {}).values() if "source" in found)
        number = next(extended, texture.get("source"))
        image = header["images"][number]
        yield image.get("name") or image.get("uri", "")[:80] or f"image {number}", _image(header, binary, image, files)


def _is_file(uri: str) -> bool:
    return bool(uri) and not uri.startswith("data:")


def _image(header: dict[str, Any], binary: bytes, image: dict[str, Any], files: MeshFiles) -> Path | bytes | None:
    if "bufferView" in image:
        view = header["bufferViews"][image["bufferView"]]
        start, buffer = view.get("byteOffset", 0), header["buffers"][view.get("buffer", 0)]
        return _content(buffer.get("uri"), binary, files)[start : start + view["byteLength"]]
    uri = image.get("uri")
    if uri is None:
        return None
    return files.locate(uri) if _is_file(uri) else _content(uri, b"", files) or None


def _content(uri: str | None, binary: bytes, files: MeshFiles) -> bytes:
    """Return the content of a URI; without one, the binary chunk."""
    if uri is None:
        return binary
    return files.get(uri) if _is_file(uri) else base64.b64decode(uri.partition(",")[2])


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
