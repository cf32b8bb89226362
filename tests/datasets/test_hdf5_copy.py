from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
from h5py import h5t
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from vcage.datasets.hdf5_copy import copy_file


def copied(source: Path, **replacements) -> Path:
    target = source.with_name("copy.hdf5")
    with h5py.File(source) as old, h5py.File(target, "w", track_order=True) as new:
        copy_file(old, new, replacements)
    return target


def same(left, right) -> bool:
    """Equal values of equal type, bit by bit where they are numbers."""
    if isinstance(left, h5py.Empty):
        return isinstance(right, h5py.Empty) and left.dtype == right.dtype
    left, right = np.asarray(left), np.asarray(right)
    if left.dtype != right.dtype or left.shape != right.shape:
        return False
    if left.dtype.hasobject:
        return all(np.array_equal(a, b) for a, b in zip(left.reshape(-1), right.reshape(-1), strict=True))
    return left.tobytes() == right.tobytes()


def assert_same_object(left: h5py.HLObject, right: h5py.HLObject) -> None:
    assert list(left.attrs) == list(right.attrs)
    for name in left.attrs:
        assert same(left.attrs[name], right.attrs[name]), f"{left.name}@{name}"
        assert left.attrs.get_id(name).get_type() == right.attrs.get_id(name).get_type()
    if isinstance(left, h5py.Dataset):
        assert left.id.get_type() == right.id.get_type()
        assert (left.shape, left.maxshape, left.chunks) == (right.shape, right.maxshape, right.chunks)
        assert left.id.get_create_plist() == right.id.get_create_plist()
        if left.shape is not None:
            assert same(left[()], right[()]), left.name


def assert_same_file(left: Path, right: Path) -> None:
    with h5py.File(left) as old, h5py.File(right) as new:
        names: list[str] = ["/"]
        old.visit(names.append)
        found: list[str] = ["/"]
        new.visit(found.append)
        assert names == found
        for name in names:
            assert_same_object(old[name], new[name])


@pytest.fixture
def source(tmp_path) -> Path:
    return tmp_path / "source.hdf5"


def test_data_of_all_kinds_stay_as_they_are(source):
    rng = np.random.default_rng(0)
    with h5py.File(source, "w") as file:
        numbers = rng.normal(size=(40, 6))
        file.create_dataset("chunked", data=numbers, chunks=(8, 6), maxshape=(None, 6), compression="gzip")
        file.create_dataset("checked", data=numbers.astype(">f4"), chunks=(5, 2), fletcher32=True, shuffle=True)
        file.create_dataset("lzf", data=rng.integers(0, 9, 100), compression="lzf")
        file.create_dataset("compact/deep/scalar", data=np.float16(3.5))
        file.create_dataset("strings", data=["a", "Grüße", ""], dtype=h5py.string_dtype())
        file.create_dataset("fixed", data=np.array([b"ab", b"c"], "S5"))
        file.create_dataset("lists", (3,), h5py.vlen_dtype(np.int16))[1] = np.arange(4)
        file.create_dataset("enumerated", data=[0, 1], dtype=h5py.enum_dtype({"OFF": 0, "ON": 1}))
        file.create_dataset("flags", data=[True, False])
        file.create_dataset("records", data=np.array([(1, 2.5, b"x")], [("a", "i4"), ("b", "f8"), ("c", "S3")]))
        file.create_dataset("complex", data=np.array([1 + 2j]))
        file.create_dataset("nothing", data=h5py.Empty("f4"))
        file.create_dataset("unwritten", (5, 5), "f4", fillvalue=7)
        file.create_dataset("none_yet", (0, 3), "f4", maxshape=(None, 3))
        file.create_group("empty/inside")
    assert_same_file(source, copied(source))


def test_attributes_of_files_groups_and_datasets_keep_their_types(source):
    with h5py.File(source, "w") as file:
        for one in (file, file.create_group("group"), file.create_dataset("data", data=1)):
            one.attrs["text"] = "Grüße"
            one.attrs["bytes"] = np.bytes_(b"ab")
            one.attrs["texts"] = np.array(["a", "bc"], h5py.string_dtype())
            one.attrs["number"] = np.float32(0.1)
            one.attrs["matrix"] = np.arange(6, dtype=">i2").reshape(2, 3)
            one.attrs["flag"] = True
            one.attrs["nothing"] = h5py.Empty("S1")
            one.attrs.create("lists", np.array([np.arange(2), np.arange(3)], object), dtype=h5py.vlen_dtype(np.int32))
            one.attrs["record"] = np.array((1, 2.5), [("a", "i4"), ("b", "f8")])
    assert_same_file(source, copied(source))


def test_an_attribute_of_a_type_that_numpy_lacks_is_copied_all_the_same(source):
    with h5py.File(source, "w") as file:
        bits = h5t.STD_B16BE
        h5py.h5a.create(file.id, b"bits", bits, h5py.h5s.create(h5py.h5s.SCALAR)).write(
            np.array(b"\x12\x34", "V2"), mtype=bits
        )
    with h5py.File(copied(source)) as file:
        read = np.empty((), "V2")
        h5py.h5a.open(file.id, b"bits").read(read, mtype=h5t.STD_B16BE)
        assert read.tobytes() == b"\x12\x34"


@settings(deadline=None, max_examples=40)
@given(
    values=arrays.arrays(
        st.one_of(arrays.floating_dtypes(), arrays.integer_dtypes(), arrays.byte_string_dtypes(min_len=1)),
        arrays.array_shapes(max_side=4),
    )
)
def test_any_array_is_copied_bit_for_bit(tmp_path_factory, values):
    source = tmp_path_factory.mktemp("any") / "source.hdf5"
    with h5py.File(source, "w") as file:
        file["data"] = values
        file.attrs["attribute"] = values
    assert_same_file(source, copied(source))


def test_links_of_every_kind_stay_links(source):
    with h5py.File(source, "w") as file:
        file["group/data"] = np.arange(3)
        file["group/again"] = file["group/data"]
        file["other"] = file["group"]
        file["group/loop"] = file["/"]
        file["soft"] = h5py.SoftLink("/group/data")
        file["dangling"] = h5py.SoftLink("/not/there")
        file["outside"] = h5py.ExternalLink("another.hdf5", "/there")
    with h5py.File(copied(source)) as file:
        assert file["group/data"] == file["group/again"] == file["other/data"]
        assert file["group/loop"] == file["/"]
        assert file.get("soft", getlink=True).path == "/group/data"
        assert file.get("dangling", getlink=True).path == "/not/there"
        outside = file.get("outside", getlink=True)
        assert (outside.filename, outside.path) == ("another.hdf5", "/there")


@pytest.mark.parametrize("tracked", [True, False])
def test_the_order_of_a_group_is_kept_where_it_has_one(source, tracked):
    with h5py.File(source, "w") as file:
        group = file.create_group("group", track_order=tracked)
        for name in "zabymx":
            group[name] = 1
            group.attrs[name] = 1
        before = list(group), list(group.attrs)
    with h5py.File(copied(source)) as file:
        assert (list(file["group"]), list(file["group"].attrs)) == before


def test_references_point_at_the_copies(source):
    with h5py.File(source, "w") as file:
        data = file.create_dataset("data", data=np.arange(10))
        file.attrs["object"] = data.ref
        file.create_dataset("objects", data=[data.ref, file["/"].ref], dtype=h5py.ref_dtype)
        file.create_dataset("regions", data=[data.regionref[2:5]], dtype=h5py.regionref_dtype)
        file.create_dataset("unset", (2,), h5py.ref_dtype)
        records = np.array([(data.ref, 3)], [("to", h5py.ref_dtype), ("number", "i4")])
        file.create_dataset("records", data=records)
    with h5py.File(copied(source)) as file:
        assert file[file.attrs["object"]] == file["data"]
        assert [file[one] for one in file["objects"]] == [file["data"], file["/"]]
        assert file["data"][file["regions"][0]].tolist() == [2, 3, 4]
        assert not any(file["unset"])
        assert file[file["records"][0]["to"]] == file["data"] and file["records"][0]["number"] == 3


def test_scales_of_dimensions_stay_attached(source):
    with h5py.File(source, "w") as file:
        file["data"], file["time"] = np.zeros((4, 2)), np.arange(4)
        file["time"].make_scale("seconds")
        file["data"].dims[0].attach_scale(file["time"])
        file["data"].dims[0].label = "t"
    with h5py.File(copied(source)) as file:
        assert file["time"].is_scale
        assert file["data"].dims[0].label == "t"
        assert file["data"].dims[0].values() == [file["time"]]
        assert len(file["data"].dims[1]) == 0


def test_a_dataset_is_replaced_under_all_its_names_and_takes_no_space(source):
    with h5py.File(source, "w") as file:
        file["big"] = np.random.default_rng(0).integers(0, 255, 1_000_000).astype(np.uint8)
        file["again"] = file["big"]
        file["region"] = file["big"].regionref[:5]
        file["rest"] = 1

    def small(old: h5py.Dataset, group: h5py.Group, name: str) -> None:
        group[name] = len(old)

    target = copied(source, big=small)
    with h5py.File(target) as file:
        assert file["big"][()] == 1_000_000 and file["again"] == file["big"]
        assert not file["region"][()]
    assert target.stat().st_size < 20_000
