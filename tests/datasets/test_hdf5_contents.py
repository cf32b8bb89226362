from __future__ import annotations

import h5py
import numpy as np
import pytest

from vcage.base.errors import DamagedFile, OversizedFile
from vcage.datasets.hdf5_contents import Hdf5Limits, datasets_in, walk
from vcage.datasets.hdf5_files import open_hdf5_file, require_not_virtual, require_own_contents


def external_link(file, other):
    file["group/outside"] = h5py.ExternalLink(str(other), "/numbers")


def external_storage(file, other):
    file.create_dataset("group/stored", (4,), np.uint8, external=[(str(other), 0, 4)])


def virtual(file, other):
    layout = h5py.VirtualLayout((3,), np.float64)
    layout[:] = h5py.VirtualSource(str(other), "numbers", (3,))
    file.create_virtual_dataset("group/virtual", layout)


def virtual_series(file, other):
    layout = h5py.VirtualLayout((3,), np.float64)
    layout[:] = h5py.VirtualSource(".", "series", (3,))
    file.create_virtual_dataset("group/virtual", layout)


def virtual_of_virtual(file, other):
    for name, source in (("one", "other"), ("other", "one")):
        layout = h5py.VirtualLayout((3,), np.float64)
        layout[:] = h5py.VirtualSource(".", source, (3,))
        file.create_virtual_dataset(name, layout)


def soft_link_through_an_external_one(file, other):
    file["out"] = h5py.ExternalLink(str(other), "/")
    file["numbers_of_others"] = h5py.SoftLink("/out/numbers")


def dangling(file, other):
    file["group/dangling"] = h5py.SoftLink("/not/there")


def soft_loop(file, other):
    file["loop"] = h5py.SoftLink("/loop")


def not_utf8(file, other):
    file.create_group(b"\xff")


REFUSED = {
    external_link: r"/group/outside is an external link to /numbers of the file .*other\.hdf5",
    external_storage: r"/group/stored has external storage: its data lie in the file .*other\.hdf5",
    virtual: r"/group/virtual is a virtual dataset: it takes numbers from the file .*other\.hdf5",
    virtual_series: "/group/virtual is a virtual dataset of series, which is no stored dataset",
    virtual_of_virtual: "which is no stored dataset of the file",
    soft_link_through_an_external_one: "/out is an external link",
    dangling: "/group/dangling is a soft link to /not/there, where the file has nothing",
    soft_loop: "/loop is a soft link to /loop, which leads back to itself",
    not_utf8: r"holds the name b'\\xff', which is not UTF-8",
}


@pytest.mark.parametrize("spoil", REFUSED, ids=lambda spoil: spoil.__name__)
def test_a_file_that_takes_data_from_elsewhere_is_refused_by_the_path_inside_it(tmp_path, spoil):
    with h5py.File(tmp_path / "other.hdf5", "w") as other:
        other["numbers"] = np.arange(3.0)
    with h5py.File(tmp_path / "file.hdf5", "w") as file:
        spoil(file, tmp_path / "other.hdf5")
    with pytest.raises(DamagedFile, match=rf"file\.hdf5:?.*{REFUSED[spoil]}"):
        open_hdf5_file(tmp_path / "file.hdf5")


@pytest.fixture
def file(tmp_path):
    with h5py.File(tmp_path / "file.hdf5", "w") as file:
        yield file


def test_links_inside_a_file_and_cycles_of_groups_are_followed(file):
    file["real/pictures"], file["real/numbers"] = np.zeros(3), np.ones(3)
    file["images/cam_10"] = h5py.SoftLink("/real/pictures")
    file["images/cam_2"] = h5py.SoftLink("/real/numbers")
    file["real/root"] = file["/"]
    file["images/around"] = h5py.SoftLink("/images")
    require_own_contents(file)
    assert [key for key, _ in walk(file["images"])] == ["around", "cam_2", "cam_10"]
    found = datasets_in(file, "images/[^/]+")
    assert {key: one.name for key, one in found.items()} == {
        "images/cam_2": "/real/numbers",
        "images/cam_10": "/real/pictures",
    }


def test_a_dataset_with_several_names_is_listed_under_a_hard_one(file):
    file["b"] = np.zeros(3)
    file["a"] = h5py.SoftLink("/b")
    assert list(datasets_in(file)) == ["b"]


def test_a_virtual_dataset_of_the_file_itself_is_taken_unless_its_source_is_replaced(file):
    file["numbers"], file["others"] = np.arange(3.0), np.arange(3.0)
    layout = h5py.VirtualLayout((3,), np.float64)
    layout[:] = h5py.VirtualSource(file["numbers"])
    file.create_virtual_dataset("virtual", layout)
    require_own_contents(file)
    require_not_virtual(file, ["others"])
    with pytest.raises(DamagedFile, match="/virtual is a virtual dataset of the pictures /numbers"):
        require_not_virtual(file, ["numbers"])


def test_named_types_and_references_inside_the_file_are_taken(file):
    file["numbers"], file["type"] = np.arange(3.0), np.dtype("f8")
    file["reference"] = file["numbers"].ref
    file["region"] = file["numbers"].regionref[:2]
    require_own_contents(file)


@pytest.mark.parametrize("limits", [Hdf5Limits(max_links=3), Hdf5Limits(max_depth=3)])
def test_too_many_groups_are_refused(file, limits):
    file.create_group("a/b/c/d")
    with pytest.raises(OversizedFile, match="too many groups"):
        require_own_contents(file, limits)


def test_names_that_soft_links_multiply_are_counted(file):
    for level in range(8):
        for name in "xy":
            file[f"{level}/{name}"] = h5py.SoftLink(f"/{level + 1}")
    file.create_group("8")
    with pytest.raises(OversizedFile, match="soft links followed"):
        list(walk(file, Hdf5Limits(max_links=100)))
