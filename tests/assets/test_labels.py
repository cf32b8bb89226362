"""Bar codes are real EAN-13, and scanners read them off the products."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from assets.textures import labels
from vcage.base.files import resource
from vcage.objects import parametric
from vcage.objects.library import Library

PRODUCTS = ("cereal_box", "chips_tube", "chocolate_bar", "cookie_box", "energy_drink", "gum_jar", "juice_carton")


@pytest.mark.parametrize(("twelve", "check"), [("400638133393", "1"), ("978030640615", "7"), ("000000000000", "0")])
def test_the_check_digit_is_the_standards(twelve: str, check: str) -> None:
    assert labels.with_check_digit(twelve) == twelve + check


@pytest.mark.parametrize("digits", ["", "12345678901", "12345678901x", "1234567890123"])
def test_a_check_digit_needs_twelve_digits(digits: str) -> None:
    with pytest.raises(ValueError, match="expected 12 digits"):
        labels.with_check_digit(digits)


def test_a_wrong_check_digit_is_refused_with_the_right_number() -> None:
    with pytest.raises(ValueError, match="4006381333931"):
        labels.ean13_modules("4006381333930")


def test_bars_have_guards_at_both_ends_and_in_the_middle() -> None:
    bars = labels.ean13_modules("4006381333931")
    assert len(bars) == 95
    assert bars[:3].tolist() == bars[-3:].tolist() == [True, False, True]
    assert bars[45:50].tolist() == [False, True, False, True, False]


@pytest.mark.parametrize("name", ["a", "b", "c", "d"])
def test_a_reader_reads_a_drawn_code(name: str) -> None:
    code = labels.product_code(name)
    assert _read(labels.barcode(code)) == code


def test_every_product_has_a_unique_number() -> None:
    library = Library.load()
    codes = [labels.product_code(*names) for names in library.variants(PRODUCTS)]
    assert len(set(codes)) == len(codes)
    assert all(code.startswith("2") for code in codes)


@pytest.mark.slow
def test_the_bars_of_every_product_are_on_its_picture() -> None:
    without = []
    for name, variant in Library.load().variants([*PRODUCTS, "can", "milk_carton", "tea_box"]):
        pictures = [part.texture for part in parametric.build(resource("assets", "objects", name), variant).parts]
        bars = labels.ean13_modules(labels.product_code(name, variant))
        if not any(_shows(picture, bars) for picture in pictures):
            without.append(f"{name}/{variant}")
    assert without == []


def test_a_payment_code_has_three_finder_patterns() -> None:
    picture = labels.payment_code(np.random.default_rng(0), count=29, module=1)
    dark = picture[3:-3, 3:-3, 0] < 128
    finder = dark[:7, :7]
    assert finder[0].all() and finder[2:5, 2:5].all() and not finder[1, 1:6].any()
    np.testing.assert_array_equal(dark[:7, -7:], finder)
    np.testing.assert_array_equal(dark[-7:, :7], finder)


def test_a_display_lights_more_segments_for_an_eight_than_for_a_one() -> None:
    lit = [(labels.display(digit, (60, 100), (0, 0, 0), (255, 255, 255), ghost=0) < 64).sum() for digit in "18"]
    assert lit[1] > 2 * lit[0] > 0


def test_a_stamp_that_leaves_the_picture_is_refused() -> None:
    picture = np.zeros((10, 10, 3), dtype=np.uint8)
    with pytest.raises(ValueError, match="a stamp of 8 x 8 pixels leaves a picture"):
        labels.stamped(picture, picture[:8, :8], (0.1, 0.5))


def _read(picture: np.ndarray) -> str:
    """Code that OpenCV's detector reads on a picture laid on white."""
    framed = np.pad(picture, ((60, 60), (60, 60), (0, 0)), constant_values=255)
    return cv2.barcode.BarcodeDetector().detectAndDecode(np.ascontiguousarray(framed))[0]


def _shows(picture: np.ndarray, bars: np.ndarray) -> bool:
    """True if some row of the picture holds the bars, at one of the widths in use."""
    dark = (picture.max(axis=2) < 64).astype(np.uint8)
    drawn = [np.repeat(bars, module).astype(np.uint8).tobytes() for module in (2, 3, 5)]
    return any(code in row.tobytes() for row in dark for code in drawn)
