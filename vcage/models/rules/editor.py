"""The image editor that needs no model: takes each object out of the picture and draws it where the plan wants it."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.errors import InfeasibleScene, InputFileError
from vcage.layout.intended import IntendedLayout
from vcage.models.protocols import EditRequest
from vcage.models.rules import PROVIDER
from vcage.models.rules.cutouts import cutouts
from vcage.models.rules.light import find_light
from vcage.models.rules.painting import Painting, View, paint_objects
from vcage.schema.plan import Relation

logger = logging.getLogger(__name__)


@dataclass
class OfflineEditor:
    """Implements :class:`vcage.models.protocols.ImageEditor` with the plan as the layout's solver keeps it.

    Args:
        good_share: share of an object that the target picture shows, unless the plan puts something in or on it; below
            that, another layout is tried, and the rest is a warning.
        min_share: share below which the picture is refused.
    """

    good_share: float = 0.9
    min_share: float = 0.5
    provider = PROVIDER

    def rearrange(self, request: EditRequest) -> np.ndarray:
        """The target picture, in the size of the source. An object missing in the source is left out.

        Raises:
            InputFileError: the pictures do not belong together.
            InfeasibleScene: an object would be hidden behind another, or lie outside the picture.
        """
        _check_sizes(request)
        items = cutouts(request.scene, request.segmentation)
        for item in items:
            if item.hidden:
                logger.warning("%s: the picture shows nothing of it, so it stays where it is", item.record.id)
        light = find_light(
            request.picture, request.background, items, request.scene.top_camera.camera(), request.scene.table.height
        )
        view = View(request.scene.top_camera.camera(), light, request.scene.table.height)

        def draw(layout: IntendedLayout, relations: Sequence[Relation]) -> Painting:
            holders = {r.reference for r in relations if r.relation in ("inside", "on")}
            return paint_objects(request.picture, request.background, items, layout.poses, view, holders)

        drawing = draw(request.layout, request.plan.relations)
        hidden = drawing.hidden(self.good_share)
        if hidden:
            others = [r for r in request.plan.relations if r.subject not in hidden and r.reference not in hidden]
            freer = draw(request.laid_out(others), others)
            if freer.least_visible > drawing.least_visible:
                drawing = freer
                logger.warning(
                    "so that %s can be seen, the target picture does not keep to: %s",
                    ", ".join(hidden),
                    "; ".join(
                        f"{r.subject} {r.relation} {r.reference}" for r in request.plan.relations if r not in others
                    ),
                )
        lost = drawing.hidden(self.min_share)
        if lost:
            raise InfeasibleScene(
                f"{', '.join(lost)} would be hidden, or outside the picture, in the planned layout",
                hint="plan with fewer or lower objects, or try another --seed",
                details={"objects": lost, "visible": {name: round(drawing.visible[name], 2) for name in lost}},
            )
        for name in drawing.hidden(self.good_share):
            logger.warning("%s: %.0f %% of it is seen in the target picture", name, 100 * drawing.visible[name])
        return drawing.picture


def _check_sizes(request: EditRequest) -> None:
    camera = request.scene.top_camera
    for name in ("picture", "background", "segmentation"):
        array = getattr(request, name)
        if array.shape[:2] != (camera.height, camera.width):
            raise InputFileError(
                f"the {name} is {array.shape[1]} x {array.shape[0]} pixels, the top camera's pictures are "
                f"{camera.width} x {camera.height}",
                maker="select_place",
            )
