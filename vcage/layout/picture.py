"""A plan drawing of the layout before and after the optimisation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.drawing import INK, PAPER, WARNING, Canvas, Colour, distinct_colours
from vcage.base.geometry import rotation_2d
from vcage.layout.items import TableItem
from vcage.schema.scene import Table, Workspace


@dataclass(frozen=True)
class PictureSettings:
    """Sizes and colours of the drawing.

    Args:
        panel_px: width of one of the two plans.
        edge_px, header_px, footer_px: margins around them.
        wood, grey: colours of the table and of the workspace's dots.
        shortest_move_mm: moves that are shorter are not marked.
    """

    panel_px: int = 900
    edge_px: int = 24
    header_px: int = 64
    footer_px: int = 44
    wood: Colour = (236, 222, 200)
    grey: Colour = (150, 145, 138)
    shortest_move_mm: float = 3


SETTINGS = PictureSettings()


def draw_layout(
    before: Sequence[TableItem],
    after: Sequence[TableItem],
    labels: Mapping[str, str],
    workspace: Workspace,
    table: Table,
) -> np.ndarray:
    """The table from above, twice: left the target layout with its collisions in red, right the optimised one.

    Args:
        before, after: the same objects, with their targets at where they should be and where they ended.
        labels: texts beside the objects, by id.
        workspace: drawn dotted.
        table: drawn as wood; the robot stands below the picture.

    Returns:
        (H, W, 3) uint8.
    """
    plan = _Plan(table)
    sheet = np.full(
        (plan.height + SETTINGS.header_px + SETTINGS.footer_px, 2 * SETTINGS.panel_px + 3 * SETTINGS.edge_px, 3),
        PAPER,
        dtype=np.uint8,
    )
    canvas = Canvas(sheet, text_size=17)
    colours = dict(zip([f.id for f in before], distinct_colours(len(before)), strict=True))
    clashes = collisions(before)
    moved = {f.id: 1000 * float(np.hypot(*np.subtract(f.target, b.target))) for b, f in zip(before, after, strict=True)}
    foot = plan.height + SETTINGS.header_px + 10

    plan.left = SETTINGS.edge_px
    canvas.text((plan.left, 20), "Target layout (matched)", size=26)
    _draw_plan(canvas, plan, workspace, before, colours)
    for rectangle in clashes:
        _draw_clash(canvas, plan, rectangle)
    _draw_labels(canvas, plan, before, labels, colours, {})
    canvas.text((plan.left, foot), _count(clashes), fill=WARNING if clashes else INK, size=20)

    plan.left = 2 * SETTINGS.edge_px + SETTINGS.panel_px
    canvas.text((plan.left, 20), "Optimised layout", size=26)
    _draw_plan(canvas, plan, workspace, after, colours)
    for old, new in zip(before, after, strict=True):
        canvas.arrow(plan.pixel(old.target).tolist(), plan.pixel(new.target).tolist(), INK, width=2)
    _draw_labels(canvas, plan, after, labels, colours, moved)
    canvas.text((plan.left, foot), f"{_count(collisions(after))}; {_summary(labels, moved)}", size=20)
    return canvas.picture()


def collisions(items: Sequence[TableItem]) -> list[np.ndarray]:
    """(2, 2) rectangles in which boxes overlap that are not container and content; in a container, along its axes."""
    found = []
    yaws = {f.id: f.yaw for f in items}
    for k, a in enumerate(items):
        for b in items[k + 1 :]:
            if b.id == a.inside or a.id == b.inside:
                continue
            # What lies in one container is laid out along its walls, not along the world's axes.
            if a.inside is not None and a.inside == b.inside and _apart(a, b, yaws[a.inside]):
                continue
            box_a, box_b = a.rectangle() + a.target, b.rectangle() + b.target
            lower, upper = np.maximum(box_a[0], box_b[0]), np.minimum(box_a[1], box_b[1])
            if np.all(upper - lower > 1e-6):
                found.append(np.stack([lower, upper]))
    return found


def _apart(a: TableItem, b: TableItem, yaw: float) -> bool:
    """True if the boxes along the axes of a frame turned by ``yaw`` do not overlap."""
    halves = sum(f.half_size(yaw) for f in (a, b))
    between = np.abs(rotation_2d(-yaw) @ np.subtract(a.target, b.target))
    return bool(np.any(between >= halves - 1e-6))


def _count(clashes: Sequence[np.ndarray]) -> str:
    if not clashes:
        return "no collisions"
    return "1 collision" if len(clashes) == 1 else f"{len(clashes)} collisions"


def _summary(labels: Mapping[str, str], moved: Mapping[str, float]) -> str:
    furthest = max(moved, key=lambda name: moved[name])
    if moved[furthest] < SETTINGS.shortest_move_mm:
        return "nothing moved"
    mean = sum(moved.values()) / len(moved)
    return f"moved {mean:.0f} mm on average, at most {moved[furthest]:.0f} mm ({labels[furthest]})"


class _Plan:
    """Maps the table onto one panel; ``left`` is the panel's first column."""

    def __init__(self, table: Table):
        self._lower, self._upper = table.rectangle
        self._scale = SETTINGS.panel_px / table.size[0]
        self.height = round(table.size[1] * self._scale)
        self.left = 0

    def pixel(self, points: np.ndarray | Sequence[float]) -> np.ndarray:
        """(..., 2) pixels of world points (..., 2); y upwards."""
        points = np.asarray(points, dtype=np.float64)
        u = (points[..., 0] - self._lower[0]) * self._scale + self.left
        return np.stack([u, (self._upper[1] - points[..., 1]) * self._scale + SETTINGS.header_px], axis=-1)

    def table(self) -> list[float]:
        return [*self.pixel((self._lower[0], self._upper[1])), *self.pixel((self._upper[0], self._lower[1]))]


def _draw_table(canvas: Canvas, plan: _Plan, workspace: Workspace) -> None:
    canvas.draw.rounded_rectangle(plan.table(), radius=10, fill=SETTINGS.wood, outline=SETTINGS.grey, width=2)
    u0, v1 = plan.pixel(workspace.lower)
    u1, v0 = plan.pixel(workspace.upper)
    for u in np.arange(u0, u1, 12):
        for v in (v0, v1):
            canvas.draw.line([u, v, min(u + 5, u1), v], fill=SETTINGS.grey, width=2)
    for v in np.arange(v0, v1, 12):
        for u in (u0, u1):
            canvas.draw.line([u, v, u, min(v + 5, v1)], fill=SETTINGS.grey, width=2)
    canvas.text((u0 + 8, v1 - 26), "robot side, workspace dotted", fill=SETTINGS.grey, size=16)


def _draw_plan(
    canvas: Canvas, plan: _Plan, workspace: Workspace, items: Sequence[TableItem], colours: Mapping[str, Colour]
) -> None:
    _draw_table(canvas, plan, workspace)
    for item in sorted(items, key=lambda f: -f.size[0] * f.size[1]):
        _draw_item(canvas, plan, item, colours[item.id])


def _draw_labels(
    canvas: Canvas,
    plan: _Plan,
    items: Sequence[TableItem],
    labels: Mapping[str, str],
    colours: Mapping[str, Colour],
    moved: Mapping[str, float],
) -> None:
    boxes = {f.id: _pixel_box(plan, f) for f in items}
    for box in boxes.values():
        canvas.keep_clear(box)
    for f in items:
        distance = moved.get(f.id, 0.0)
        words = f"{labels[f.id]}  {distance:.0f} mm" if distance >= SETTINGS.shortest_move_mm else labels[f.id]
        canvas.label(boxes[f.id], words, colours[f.id])


def _pixel_box(plan: _Plan, item: TableItem) -> tuple[float, float, float, float]:
    lower, upper = plan.pixel(item.rectangle() + item.target)
    return float(lower[0]), float(upper[1]), float(upper[0]), float(lower[1])


def _draw_item(canvas: Canvas, plan: _Plan, item: TableItem, colour: Colour) -> None:
    half = np.array(item.size[:2]) / 2 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    corners = plan.pixel(np.array(item.target) + (half + item.centre) @ rotation_2d(item.yaw).T)
    canvas.draw.polygon([tuple(p) for p in corners], fill=(*colour, 110), outline=(*colour, 255), width=3)
    front = (corners[0] + corners[1]) / 2
    centre = plan.pixel(item.target)
    canvas.draw.line([*(centre + 0.6 * (front - centre)), *front], fill=colour, width=3)


def _draw_clash(canvas: Canvas, plan: _Plan, rectangle: np.ndarray) -> None:
    u0, v1 = plan.pixel(rectangle[0])
    u1, v0 = plan.pixel(rectangle[1])
    canvas.draw.rectangle([u0, v0, u1, v1], fill=(*WARNING, 120), outline=(*WARNING, 255), width=2)
