from __future__ import annotations

import cv2
import numpy as np

from tests.models.tabletop import BLOCKS, BREADS, MARKERS, PLATE, draw, table_picture
from vcage.vision.detector import BackgroundDetector
from vcage.vision.embedder import ClassicalEmbedder
from vcage.vision.protocols import Detection

DETECTOR = BackgroundDetector()


def overlap(mask: np.ndarray, truth: np.ndarray) -> float:
    return (mask & truth).sum() / (mask | truth).sum()


def test_each_object_is_one_region_without_its_shadow() -> None:
    picture, ids = draw([PLATE, *BLOCKS])
    found = DETECTOR.detect(picture, ["x"] * 4, table_picture())
    assert len(found) == 4
    for index in range(1, 5):
        assert max(overlap(d.mask, ids == index) for d in found) > 0.8


def test_an_empty_table_has_no_objects() -> None:
    picture, _ = draw([])
    assert DETECTOR.detect(picture, [], table_picture()) == []


def test_touching_objects_are_split_when_more_are_expected() -> None:
    pair = [BREADS[1].moved(at=(0.0, 0.0)), BREADS[1].moved(id="other", at=(0.085, 0.0))]
    picture, _ = draw(pair)
    background = table_picture()
    assert len(DETECTOR.detect(picture, ["one"], background)) == 1
    assert len(DETECTOR.detect(picture, ["one", "two"], background)) == 2


def test_a_picture_of_another_brightness_and_size_shows_the_same_objects() -> None:
    picture, _ = draw([PLATE, *BLOCKS])
    larger = cv2.resize(picture, (800, 600), interpolation=cv2.INTER_CUBIC)
    brighter = np.clip(larger * 1.03 + 2, 0, 255).astype(np.uint8)
    assert len(DETECTOR.detect(brighter, ["x"] * 4, table_picture())) == 4


def test_without_a_background_objects_differ_from_the_border() -> None:
    picture, _ = draw([PLATE, *BLOCKS])
    assert len(DETECTOR.detect(picture, ["x"] * 4)) == 4


def test_features_know_an_object_again_when_it_was_turned_and_moved() -> None:
    things = [*MARKERS, *BLOCKS, *BREADS]
    turned = [t.moved(yaw=t.yaw + 1.1, at=(-t.at[0], t.at[1])) for t in things]
    before, after = (_features(layout) for layout in (things, turned))
    assert np.allclose(np.linalg.norm(before, axis=1), 1)
    assert list((before @ after.T).argmax(axis=1)) == list(range(len(things)))


def _features(things: list) -> np.ndarray:
    rows = []
    for thing in things:
        picture, ids = draw([thing])
        rows.append(ClassicalEmbedder().embed(picture, [Detection((0, 0, 1, 1), ids == 1, 1.0)])[0])
    return np.array(rows)


def test_a_region_without_a_mask_is_embedded_by_its_box() -> None:
    picture, _ = draw([PLATE])
    row = ClassicalEmbedder().embed(picture, [Detection((250, 150, 390, 290), None, 1.0)])
    assert row.shape[0] == 1 and np.isclose(np.linalg.norm(row), 1)


def test_no_regions_give_no_rows() -> None:
    assert len(ClassicalEmbedder().embed(table_picture(), [])) == 0
