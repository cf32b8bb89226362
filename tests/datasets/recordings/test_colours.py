"""Red and blue of scenes whose colours are known, in every layout, stored both ways."""

from __future__ import annotations

from pathlib import Path

import cv2
import h5py
import numpy as np
import pytest

from tests.datasets.packed_files import pack
from tests.datasets.recordings.layouts import act, jpeg, robomimic, robotwin, robotwin_vision, room
from vcage.base.errors import DamagedFile, UsageError
from vcage.datasets.packed import unpack
from vcage.datasets.recordings.colours import MARK, Colours, colour_orders, leaning, verdict
from vcage.datasets.recordings.opening import open_all, open_recordings

FRAMES, HEIGHT, WIDTH = 6, 48, 64
GREY, WOOD, PALE_WOOD, BROWN = (180, 180, 178), (190, 140, 90), (222, 184, 135), (139, 90, 43)
BLUE, RED, SKIN, GLOVE = (30, 60, 220), (210, 40, 40), (224, 172, 140), (60, 90, 200)


def scene(table: tuple[int, int, int], *things: tuple[int, int, int]) -> np.ndarray:
    """(T, H, W, 3) RGB: a table and small things that move on it."""
    pictures = np.empty((FRAMES, HEIGHT, WIDTH, 3), np.uint8)
    pictures[:] = table
    for index in range(FRAMES):
        for number, thing in enumerate(things):
            top = 6 + 14 * number
            pictures[index, top : top + 10, 6 + 3 * index : 18 + 3 * index] = thing
    return pictures


def act_encoded(path: Path, *, swapped: bool, pictures: np.ndarray) -> Path:
    """ACT's layout with padded JPEG in two cameras."""
    files = [jpeg(picture, swapped=swapped) for picture in pictures]
    rows = np.zeros((len(files), max(map(len, files)) + 7), np.uint8)
    for row, data in zip(rows, files, strict=True):
        row[: len(data)] = np.frombuffer(data, np.uint8)
    with h5py.File(path, "w") as file:
        file["action"] = np.zeros((len(files), 14))
        for camera in ("cam_high", "cam_left_wrist"):
            file[f"observations/images/{camera}"] = rows
    return path


LAYOUTS = {"robotwin": robotwin, "robotwin-1.0": robotwin_vision, "act": act_encoded}
CONVENTION = {"robotwin": True, "robotwin-1.0": True, "act": False}
"""Layout → whether its own writers swap red and blue."""


def read(path: Path, colours: str = "auto") -> tuple[np.ndarray, Colours]:
    """Pictures of the first camera, and how their order was settled."""
    (recording,) = open_all(path, colours).recordings
    assert recording.colours is not None
    return recording.pictures(recording.cameras[0].name), recording.colours


def near(found: np.ndarray, pictures: np.ndarray) -> bool:
    return float(np.abs(found.astype(int) - pictures).mean()) < 6


UNCLEAR = {
    "a blue thing on grey": scene(GREY, BLUE),
    "a red thing on grey": scene(GREY, RED),
    "red and blue things on grey": scene(GREY, RED, BLUE),
    "all grey": scene(GREY),
    "a blue table": scene((30, 60, 160)),
    "a red table": scene((150, 30, 30)),
    "a green table": scene((40, 140, 60), RED),
    "a hand in a blue glove": scene(GREY, SKIN, GLOVE),
    "half wood, half its counterpart": np.concatenate([scene(WOOD)[:, :24], scene(WOOD)[:, :24, :, ::-1]], axis=1),
}


@pytest.mark.parametrize("name", UNCLEAR)
@pytest.mark.parametrize("layout", LAYOUTS)
def test_an_unmarked_layout_is_read_as_its_writers_write_it_and_that_is_reported(tmp_path, layout, name):
    path = LAYOUTS[layout](tmp_path / "a.hdf5", swapped=CONVENTION[layout], pictures=UNCLEAR[name])
    found, colours = read(path)
    assert near(found, UNCLEAR[name])
    assert colours == Colours(CONVENTION[layout], "layout", sure=False)
    assert "--colours" in (colours.note or "")


@pytest.mark.parametrize("table", [WOOD, PALE_WOOD, BROWN])
@pytest.mark.parametrize("swapped", [True, False])
@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_wooden_table_shows_how_its_pictures_are_stored(tmp_path, layout, swapped, table):
    pictures = scene(table, BLUE, RED)
    found, colours = read(LAYOUTS[layout](tmp_path / "a.hdf5", swapped=swapped, pictures=pictures))
    assert near(found, pictures)
    agrees = swapped == CONVENTION[layout]
    assert (colours.sure, colours.source) == (agrees, "layout" if agrees else "pictures")


@pytest.mark.parametrize("swapped", [True, False])
@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_user_decides(tmp_path, layout, swapped):
    pictures = scene(GREY, BLUE)
    path = LAYOUTS[layout](tmp_path / "a.hdf5", swapped=swapped, pictures=pictures)
    found, colours = read(path, "bgr" if swapped else "rgb")
    assert near(found, pictures)
    assert colours == Colours(swapped, "option", sure=True)


def test_few_pictures_do_not_overrule_a_layout(tmp_path):
    pictures = scene(WOOD, BLUE)[:2]
    _, colours = read(robotwin(tmp_path / "a.hdf5", swapped=False, pictures=pictures))
    assert colours == Colours(True, "layout", sure=False)


def test_one_episode_does_not_overrule_its_neighbours(tmp_path):
    for number in range(4):
        robotwin(tmp_path / f"{number}.hdf5", pictures=scene(GREY, BLUE))
    robotwin(tmp_path / "4.hdf5", swapped=False, pictures=scene(WOOD))
    found = [recording.colours for recording in open_recordings(tmp_path)]
    assert found == [Colours(True, "layout", sure=False)] * 5
    (order,) = colour_orders(found)
    assert (order.stored, order.sure, order.recordings) == ("bgr", False, 5)


def test_arrays_have_no_question_until_a_user_answers_it(tmp_path):
    path = act(tmp_path / "a.hdf5")
    with h5py.File(path) as file:
        pictures = file["observations/images/cam_high"][()]
    (recording,) = open_recordings(path)
    assert recording.colours is None and recording.notes == []
    assert np.array_equal(recording.pictures("cam_high"), pictures)
    (changed,) = open_all(path, "bgr").recordings
    assert changed.swapped("cam_high") and np.array_equal(changed.pictures("cam_high"), pictures[..., ::-1])


def test_robomimics_arrays_are_rgb(tmp_path):
    assert {recording.colours for recording in open_recordings(robomimic(tmp_path / "a.hdf5"))} == {None}


def marked(picture: np.ndarray) -> bytes:
    """A JPEG in true colours whose comment says so, as newer files of RoboTwin's have it."""
    data = jpeg(picture)
    return data[:20] + MARK + data[20:]


def test_pictures_marked_as_rgb_are_read_so_and_come_back_with_the_mark(tmp_path):
    pictures = scene(GREY, BLUE)
    path = robotwin_vision(tmp_path / "a.hdf5", pictures=pictures)
    with h5py.File(path, "r+") as file:
        for index, picture in enumerate(pictures):
            file["vision/cam_head/colors"][index] = np.frombuffer(marked(picture), np.uint8)
    found, colours = read(path)
    assert near(found, pictures) and colours == Colours(False, "file", sure=True)
    back = unpack(pack(path, tmp_path / "small/a.hdf5"), tmp_path / "back.hdf5")
    with h5py.File(back) as file:
        stored = file["vision/cam_head/colors"][0]
    assert near(cv2.imdecode(stored, cv2.IMREAD_COLOR), pictures[0])  # without a mark they take BGR for RGB
    assert near(read(back)[0], pictures)


@pytest.mark.parametrize("colours", ["auto", "rgb", "bgr"])
@pytest.mark.parametrize(("plain", "named"), [((0,), r"colors\[1\] is marked"), ((3,), r"colors\[3\] is not")])
def test_a_file_with_only_some_marked_pictures_is_refused_by_name(tmp_path, plain, named, colours):
    path = robotwin_vision(tmp_path / "a.hdf5", swapped=True)
    with h5py.File(path, "r+") as file:
        stored = file["vision/cam_head/colors"]
        for index in set(range(len(stored))) - set(plain):
            stored[index] = np.frombuffer(marked(room(index)), np.uint8)
    with pytest.raises(DamagedFile, match=named):
        _ = open_all(path, colours).recordings[0].notes


def test_the_colour_order_of_videos_is_settled(tmp_path):
    path = pack(robotwin(tmp_path / "a.hdf5"), tmp_path / "small/a.hdf5")
    with pytest.raises(UsageError, match="lie in videos"):
        _ = open_all(path, "bgr").recordings[0].notes


@pytest.mark.parametrize(
    ("votes", "found"),
    [
        ([1] * 5, True),
        ([-1] * 5, False),
        ([1] * 4, None),
        ([1] * 5 + [0] * 6, None),
        ([1] * 8 + [-1] * 2, None),
        ([1] * 19 + [-1] * 1, True),
        ([], None),
    ],
)
def test_most_pictures_must_say_something_and_nearly_all_of_them_the_same(votes, found):
    assert verdict(votes) is found


def test_white_tables_under_warm_or_cool_light_say_nothing():
    for white in ((235, 225, 205), (205, 220, 235), (140, 152, 168)):
        assert leaning(np.full((8, 8, 3), white, np.uint8)) == 0
