from __future__ import annotations

import numpy as np
import pytest

from tests.dataset.recordings.layouts import jpeg, room, rooms
from vcage.dataset.recordings.encoded import decode_picture, looks_swapped, storage_of
from vcage.errors import DamagedFile


def test_padding_behind_a_picture_is_ignored():
    plain = decode_picture(jpeg(room()), "it")
    assert np.array_equal(plain, decode_picture(jpeg(room()) + bytes(100), "it"))


def test_a_warm_room_looks_swapped_only_when_it_is():
    assert looks_swapped(rooms()) is False
    assert looks_swapped(rooms()[..., ::-1]) is True


def test_grey_pictures_do_not_say_whether_they_are_swapped():
    assert looks_swapped([np.full((8, 8, 3), 90, np.uint8)]) is None


@pytest.mark.parametrize("data", [b"", b"GIF89a"])
def test_what_is_no_jpeg_and_no_png_is_refused(data):
    with pytest.raises(DamagedFile, match="camera 0"):
        storage_of(data, "camera 0")
