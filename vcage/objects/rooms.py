"""The room at the functional points of an asset, for the catalogue; measured once and cached."""

from __future__ import annotations

import hashlib
from pathlib import Path

from pydantic import ValidationError

from vcage.base.errors import InputFileError
from vcage.base.files import cache_dir, read_json, write_json
from vcage.objects import asset, convex, openings
from vcage.objects.asset import Asset
from vcage.schema.asset import PointRoom
from vcage.schema.base import Record


class _RoomsFile(Record):
    rooms: list[PointRoom]


def rooms_of(measured: Asset) -> list[PointRoom]:
    """The room at each functional point that has any, in the order of the points.

    Points without room and meshes that do not load are left out; using the object raises.
    """
    if not measured.annotation.functional_points:
        return []
    try:
        path = cache_dir("rooms") / f"{measured.name}-{_key(measured)}.json"
    except OSError:  # a hull is gone
        return []
    try:
        return _RoomsFile.model_validate(read_json(path)).rooms
    except (InputFileError, ValidationError):  # not measured yet, or damaged: measure
        pass
    try:
        rooms = _measured(measured)
    except InputFileError:
        return []
    write_json(path, _RoomsFile(rooms=rooms).model_dump(mode="json"))
    return rooms


def _measured(measured: Asset) -> list[PointRoom]:
    found = []
    for point in measured.annotation.functional_points:
        try:
            opening = measured.opening(point)
        except ValueError:
            continue
        width, depth = opening.size
        height = opening.depth if point.holds == "in" else 0.0
        found.append(PointRoom(point=point.id, size=(round(width, 4), round(depth, 4), round(height, 4))))
    return found


def _key(measured: Asset) -> str:
    """Digest of the points, the hulls' files and the code that measures."""
    hulls = [path for link in (measured.model, *measured.model.links) for path in link.hulls]
    stated = [(path, (status := Path(path).stat()).st_size, status.st_mtime_ns) for path in hulls]
    points = [point.model_dump_json() for point in measured.annotation.functional_points]
    digest = hashlib.sha256(repr((stated, points)).encode())
    for module in (asset, convex, openings):
        digest.update(Path(str(module.__file__)).read_bytes())
    return digest.hexdigest()[:16]
