"""Frames of openpi's protocol."""

from __future__ import annotations

import msgpack
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from vcage.evaluation.wire import pack, unpack

DTYPES = st.one_of(arrays.integer_dtypes(), arrays.floating_dtypes(), arrays.unsigned_integer_dtypes())


@given(arrays.arrays(DTYPES, arrays.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4)))
def test_an_array_comes_back_as_it_was(array: np.ndarray) -> None:
    again = unpack(pack({"a": array}))["a"]
    assert again.dtype == array.dtype and again.shape == array.shape
    np.testing.assert_array_equal(again, array)


def test_an_array_is_a_map_with_keys_of_bytes() -> None:
    found = msgpack.unpackb(pack({"state": np.arange(3, dtype=np.float32)}), strict_map_key=False)["state"]
    assert found == {
        b"__ndarray__": True,
        b"data": np.arange(3, dtype=np.float32).tobytes(),
        b"dtype": "<f4",
        b"shape": [3],
    }


def test_text_numbers_and_scalars_come_back() -> None:
    message = {"prompt": "Put the block …", "n": 3, "x": np.float32(0.5), "list": [1, None, True]}
    assert unpack(pack(message)) == message


@pytest.mark.parametrize("value", [np.array([object()]), np.array([1j]), object()])
def test_what_the_format_does_not_carry_is_refused(value: object) -> None:
    with pytest.raises(TypeError, match="cannot be sent"):
        pack({"a": value})


@pytest.mark.parametrize("frame", [b"", b"\xc1", pack({"a": np.zeros(3)})[:-2], msgpack.packb({b"__ndarray__": True})])
def test_bytes_that_are_no_frame_are_refused(frame: bytes) -> None:
    with pytest.raises(ValueError, match="is not MessagePack with arrays"):
        unpack(frame)
