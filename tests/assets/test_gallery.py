"""The contact sheet."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from vcage.assets.gallery import LABEL, compose_gallery


def test_cells_are_laid_out_in_rows(tmp_path: Path) -> None:
    views = [np.full((30, 40, 3), (200, 10, 10), dtype=np.uint8), np.full((60, 80, 3), 90, dtype=np.uint8)]
    path = compose_gallery(dict.fromkeys("abc", views), tmp_path / "sheet.png", columns=2)
    sheet = cv2.imread(str(path))[..., ::-1]
    assert sheet.shape == (2 * (30 + LABEL), 2 * 80, 3)
    np.testing.assert_array_equal(sheet[LABEL + 10, 10], (200, 10, 10))


def test_nothing_to_show_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no picture"):
        compose_gallery({}, tmp_path / "sheet.png")
