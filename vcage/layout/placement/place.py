"""Collision-free placement (paper, section III-A1): every object gets a place, or the answer says why not.

Free regions are exact (:mod:`~vcage.layout.placement.free_region`); the arms' reach and the camera's view are
unions of rectangles of the same calculation. :mod:`~vcage.layout.placement.search` finds the places, and
:mod:`~vcage.layout.placement.infeasible` explains failures.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from vcage.layout.items import Placement, TableItem
from vcage.layout.placement.arrangement import Spot
from vcage.layout.placement.contents import Carried, Local, content_plane, contents_of
from vcage.layout.placement.infeasible import no_place, require_room
from vcage.layout.placement.plane import Plane, make_plane
from vcage.layout.placement.related import Related
from vcage.layout.placement.search import arrange
from vcage.layout.validation import as_rectangles, as_workspace, check_items, check_margin
from vcage.schema.plan import Relation


def place(
    items: Sequence[TableItem],
    workspace: ArrayLike,
    rng: np.random.Generator,
    margin: float = 0.01,
    obstacles: ArrayLike = (),
    relations: Sequence[Relation] = (),
    container: str | None = None,
) -> dict[str, Placement]:
    """Place every item so that no two axis-aligned boxes come closer than ``margin``.

    The contents of a container keep :data:`~vcage.layout.placement.contents.CONTENT_MARGIN_M` from its walls and from
    each other, in the container's frame.

    Args:
        items: to place.
        workspace: (2, 2) lower and upper corner; every box stays within.
        rng: the only source of randomness.
        margin: smallest gap between two boxes, metres.
        obstacles: (n, 2, 2) occupied rectangles.
        relations: to satisfy, between the items and to the table; those of contents are kept between
            their containers.
        container: id of the object whose opening the workspace is, for the error; None for the table.

    Returns:
        Placement by id, in the order of ``items``.

    Raises:
        InfeasibleScene: names the objects without a place, the area that is missing, and a way out.
        UsageError: an item, the workspace, the margin or an obstacle makes no sense.
    """
    check_margin(margin)
    check_items(items)
    local: dict[str, Local] = {}
    for plane in _openings(items):
        spots = _solved(plane, rng)
        local |= {plane.items[k].id: Local(spot.centre, spot.yaw) for k, spot in spots.items()}
    carried = Carried(items, local)
    plane = replace(_table(contents_of(items, None), workspace, margin, obstacles, carried), container=container)
    if relations:
        plane = _related(plane, Related(relations, items, carried, plane.bounds), carried)
    placed: dict[str, Placement] = {}
    for k, (_, centre, yaw) in _solved(plane, rng).items():
        placed |= carried.stand(plane.items[k], Placement(float(centre[0]), float(centre[1]), yaw))
    return {item.id: placed[item.id] for item in items}


def require_possible(
    items: Sequence[TableItem], workspace: ArrayLike, margin: float = 0.01, obstacles: ArrayLike = ()
) -> None:
    """Refuse an object that fits nowhere even alone, or a total area above the free area.

    Raises:
        InfeasibleScene, UsageError: as :func:`place`.
    """
    check_margin(margin)
    check_items(items)
    for plane in _openings(items):
        require_room(plane)
    on_table = contents_of(items, None)
    require_room(_table(on_table, workspace, margin, obstacles, Carried(on_table, {})))


def _openings(items: Sequence[TableItem]) -> list[Plane]:
    """The planes of the contents of every container that something lies in."""
    held = [(container, contents_of(items, container.id)) for container in items]
    return [content_plane(container, contents) for container, contents in held if contents]


def _table(
    items: Sequence[TableItem], workspace: ArrayLike, margin: float, obstacles: ArrayLike, carried: Carried
) -> Plane:
    taken = as_rectangles(obstacles, "the obstacles")
    return make_plane(items, as_workspace(workspace), margin, taken, carried.unions)


def _related(plane: Plane, related: Related, carried: Carried) -> Plane:
    """The same plane with relations that are kept on it."""

    def unions(item: TableItem, yaw: float) -> list[np.ndarray]:
        return [*carried.unions(item, yaw), *related.thirds(item, yaw)]

    return make_plane(plane.items, plane.bounds, plane.margin, plane.obstacles, unions, related)


def _solved(plane: Plane, rng: np.random.Generator) -> dict[int, Spot]:
    """Spots of all items of a plane, or why there are none."""
    require_room(plane)
    outcome = arrange(plane, rng)
    if outcome.left:
        raise no_place(plane, outcome)
    return outcome.spots
