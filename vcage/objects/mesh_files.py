"""Files that a mesh names, such as materials, pictures and buffers: regular files of its object, and no others."""

from __future__ import annotations

import os.path
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

from trimesh.resolvers import FilePathResolver

from vcage.base.errors import DamagedFile, InputFileError
from vcage.base.placeholders import require_fetched
from vcage.base.reading import open_regular


@dataclass(frozen=True)
class MeshFileLimits:
    """The largest file that is read for a mesh.

    Args:
        max_bytes: of the file.
    """

    max_bytes: int = 1_000_000_000


LIMITS = MeshFileLimits()


class MeshFiles(FilePathResolver):
    """Find and read files that a mesh names, for trimesh.

    trimesh passes over what it cannot read, so :meth:`require_regular` tells afterwards.

    Args:
        mesh: path of the mesh.
        root: folder that names may lead to; by default the mesh's own.
    """

    def __init__(self, mesh: Path, root: Path | None = None):
        super().__init__(str(mesh))
        self.mesh, self.root = mesh, root or mesh.parent
        self._folders = [mesh.parent]
        self._refused: list[InputFileError] = []

    def find(self, name: str) -> Path | None:
        """Return the object's file of this name, or None.

        A name that leads elsewhere, as on the machine that wrote it, means the file of its last part beside the mesh.
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
            with open_regular(path, "a file of a mesh", LIMITS.max_bytes) as handle:
                self._folders.append(path.parent)  # names in a library of materials are relative to it
                return handle.read()
        except InputFileError as error:
            self._refused.append(error)
            raise

    def require_regular(self) -> None:
        """Raise what :meth:`get` refused, if anything."""
        if self._refused:
            raise self._refused[0]
