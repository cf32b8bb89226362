"""Layout of an episode in the viewer: 3D scene and cameras above, texts beside them, curves below."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from vcage.apps.viewer.marks import LOG, NOW
from vcage.apps.viewer.motion import Plot
from vcage.apps.viewer.rerun_log import rrb
from vcage.apps.viewer.scene import WORLD

SUMMARY = "about"
"""Entity of the text about the episode."""


@dataclass(frozen=True)
class Contents:
    """Contents of a Rerun recording.

    Args:
        frames: how many.
        cameras: name → entity of its pictures.
        plots: curves.
        scene: True if there is a 3D scene.
        segments: how many sub-tasks there are.
    """

    frames: int
    cameras: dict[str, str]
    plots: Sequence[Plot]
    scene: bool = False
    segments: int = 0


def blueprint(contents: Contents) -> rrb.Blueprint:
    """Return the initial layout of the viewer; missing parts take no room."""
    seen: list[rrb.Container | rrb.View] = []
    if contents.scene:
        seen.append(rrb.Spatial3DView(origin=WORLD, name="Scene"))
    if contents.cameras:
        seen.append(_cameras(contents.cameras))
    above = rrb.Horizontal(*seen, _words(contents), column_shares=[3] * len(seen) + [2])
    rows = [above, rrb.Grid(*map(_curves, contents.plots))] if contents.plots else [above]
    return rrb.Blueprint(
        rrb.Vertical(*rows, row_shares=[3, 2][: len(rows)]),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed"),
    )


def _cameras(entities: Mapping[str, str]) -> rrb.Container:
    views = [rrb.Spatial2DView(origin=path, name=name) for name, path in entities.items()]
    return rrb.Grid(*views, grid_columns=math.ceil(math.sqrt(len(views))))


def _words(contents: Contents) -> rrb.Container | rrb.View:
    about = rrb.TextDocumentView(origin=SUMMARY, name="Episode")
    if not contents.segments:
        return about
    now = rrb.TextDocumentView(origin=NOW, name="Sub-task")
    return rrb.Vertical(now, rrb.Tabs(about, rrb.TextLogView(origin=LOG, name="Verdicts")))


def _curves(plot: Plot) -> rrb.View:
    return rrb.TimeSeriesView(
        name=plot.name,
        contents=[f"{path}/**" for path in plot.entities],
        plot_legend=rrb.PlotLegend(visible=plot.legend),
        axis_y=None if plot.bounds is None else rrb.ScalarAxis(range=plot.bounds),
    )
