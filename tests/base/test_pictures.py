"""Pictures of a run folder: what is read back, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from vcage.base.errors import DamagedFile, MissingStage
from vcage.base.pictures import read_labels, read_picture, write_labels, write_picture


def test_a_picture_and_labels_come_back_as_they_were(tmp_path):
    picture = np.random.default_rng(0).integers(0, 256, (5, 7, 3), dtype=np.uint8)
    labels = np.arange(35, dtype=np.int32).reshape(5, 7) * 100
    np.testing.assert_array_equal(read_picture(write_picture(tmp_path / "a.png", picture)), picture)
    np.testing.assert_array_equal(read_labels(write_labels(tmp_path / "b.png", labels)), labels)


@pytest.mark.parametrize("data", [b"", b"no picture", b"\x89PNG\r\n\x1a\n"])
@pytest.mark.parametrize("read", [read_picture, read_labels])
def test_a_file_that_is_no_picture_is_named(read, data, tmp_path):
    path = tmp_path / "target.png"
    path.write_bytes(data)
    with pytest.raises(DamagedFile, match=r"target\.png"):
        read(path)


def test_a_missing_picture_is_named(tmp_path):
    with pytest.raises(MissingStage, match=r"target\.png"):
        read_picture(tmp_path / "target.png")


def test_a_colour_picture_is_no_label_image(tmp_path):
    with pytest.raises(DamagedFile, match="label"):
        read_labels(write_picture(tmp_path / "a.png", np.zeros((4, 4, 3), np.uint8)))
