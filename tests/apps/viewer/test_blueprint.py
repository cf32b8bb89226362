from __future__ import annotations

from collections.abc import Iterator

from vcage.apps.viewer.blueprint import Contents, blueprint
from vcage.apps.viewer.motion import Plot
from vcage.apps.viewer.rerun_log import rrb

PLOTS = [Plot("Left arm, rad", ["/joints/left_joint_1"], legend=False), Plot("Marks", ["/marks/truth"], (0, 2))]


def views(part: rrb.Blueprint | rrb.Container | rrb.View) -> Iterator[rrb.View]:
    if isinstance(part, rrb.Blueprint):
        part = part.root_container
    if isinstance(part, rrb.View):
        yield part
    else:
        for inner in part.contents:
            yield from views(inner)


def test_an_episode_shows_its_scene_cameras_words_and_curves():
    cameras = {name: f"/world/cameras/{name}" for name in ("cam_high", "cam_left_wrist")}
    names = [view.name for view in views(blueprint(Contents(9, cameras, PLOTS, scene=True, segments=2)))]
    words = ["Sub-task", "Episode", "Verdicts"]
    assert names == ["Scene", "cam_high", "cam_left_wrist", *words, "Left arm, rad", "Marks"]


def test_missing_columns_take_no_room():
    assert [view.name for view in views(blueprint(Contents(9, {}, [])))] == ["Episode"]


def test_a_plot_shows_its_entities_and_their_children():
    view = next(view for view in views(blueprint(Contents(9, {}, PLOTS))) if view.name == "Left arm, rad")
    assert view.contents == ["/joints/left_joint_1/**"]
