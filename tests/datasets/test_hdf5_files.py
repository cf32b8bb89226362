"""Files are whole or not there, above all when the disk is full: then HDF5 itself crashes."""

from __future__ import annotations

import fcntl
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vcage.base.errors import DamagedFile, FileInUse, OutputFolderError
from vcage.datasets.hdf5_files import new_hdf5, open_hdf5_file
from vcage.datasets.stored_pictures import spooled


def fill(file: h5py.File) -> None:
    """All ways in which data come into a file: at once, through a cache of chunks, in lists, as attributes."""
    rng = np.random.default_rng(0)
    file["numbers"] = rng.random(3000)
    file.create_dataset("pictures", data=rng.integers(0, 255, (20, 32, 32, 3), np.uint8), chunks=(1, 32, 32, 3))
    lists = file.create_dataset("lists", (50,), h5py.vlen_dtype(np.uint8))
    for index in range(50):
        lists[index] = rng.integers(0, 255, 500, np.uint8)
    for index in range(20):
        file.create_group(f"group{index}").attrs["text"] = "long " * 500


def test_written_data_is_read_back(tmp_path):
    with new_hdf5(tmp_path / "a.hdf5") as file:
        fill(file)
    rng = np.random.default_rng(0)
    with h5py.File(tmp_path / "a.hdf5") as file:
        assert np.array_equal(file["numbers"], rng.random(3000))
        assert np.array_equal(file["pictures"], rng.integers(0, 255, (20, 32, 32, 3), np.uint8))
        assert [len(one) for one in file["lists"]] == [500] * 50
        assert file["group19"].attrs["text"] == "long " * 500


def test_the_same_content_gives_the_same_bytes(tmp_path):
    for name in ("a", "b"):
        with new_hdf5(tmp_path / name) as file:
            file.create_dataset("x", data=np.arange(3000), track_times=False)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_a_file_that_was_there_stays_when_the_next_one_fails(tmp_path):
    with new_hdf5(tmp_path / "a.hdf5") as file:
        file["x"] = 1
    with pytest.raises(ZeroDivisionError), new_hdf5(tmp_path / "a.hdf5") as file:
        file["x"] = 1 / 0
    with h5py.File(tmp_path / "a.hdf5") as file:
        assert file["x"][()] == 1
    assert [path.name for path in tmp_path.iterdir()] == ["a.hdf5"]


def test_a_place_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(OutputFolderError, match="file"), new_hdf5(tmp_path / "file/a.hdf5") as file:
        file["x"] = 1


LIMITED = """
import errno, resource, signal, sys
from pathlib import Path
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # a write beyond the limit is then refused
from tests.datasets.test_hdf5_files import fill
from vcage.datasets.hdf5_files import new_hdf5
from vcage.base.errors import DiskFull
for space in range(500, 200_000, 7_000):
    resource.setrlimit(resource.RLIMIT_FSIZE, (space, resource.RLIM_INFINITY))
    try:
        with new_hdf5(Path(sys.argv[1])) as file:
            fill(file)
    except DiskFull as error:
        assert error.__cause__.errno == errno.EFBIG, error
        assert not list(Path(sys.argv[1]).parent.iterdir())
        continue
    sys.exit("not refused")
"""


def test_wherever_a_write_is_refused_the_process_goes_on_and_nothing_is_left(tmp_path):
    program = [sys.executable, "-c", LIMITED, tmp_path / "a.hdf5"]
    done = subprocess.run(program, capture_output=True, text=True, env={"PYTHONPATH": ":".join(sys.path)})
    assert (done.returncode, done.stderr) == (0, "")


@given(pieces=st.lists(st.binary(), min_size=1))
def test_pieces_come_back_in_order_as_often_as_they_are_asked_for(tmp_path_factory, pieces):
    with spooled(iter(pieces), tmp_path_factory.getbasetemp()) as spool:
        assert (len(spool), spool.longest) == (len(pieces), max(map(len, pieces)))
        assert list(spool) == list(spool) == pieces


def test_nothing_is_left_in_the_folder(tmp_path):
    with spooled([b"piece"], tmp_path):
        assert list(tmp_path.iterdir()) == []
    assert list(tmp_path.iterdir()) == []


@pytest.fixture
def recorded(tmp_path):
    path = tmp_path / "file.hdf5"
    with h5py.File(path, "w") as file:
        file["numbers"] = np.arange(1000.0)
    return path


def test_a_file_that_its_writer_has_open_is_busy_and_not_damaged(recorded):
    with open(recorded, "rb") as handle:
        fcntl.flock(handle, fcntl.LOCK_EX)
        with pytest.raises(FileInUse, match=r"file\.hdf5 is open for writing in another process") as caught:
            open_hdf5_file(recorded)
    assert caught.value.exit_code == 6
    assert caught.value.retryable
    open_hdf5_file(recorded).close()


def as_it_is_written(path: Path, copy: Path, *, shared: bool) -> Path:
    """A copy of a file while its writer has it open, for others to read or not."""
    with h5py.File(path, "w", libver="latest") as file:
        file.create_dataset("numbers", (4,), np.float64, maxshape=(None,), chunks=(4,))
        if shared:
            file.swmr_mode = True
        file.flush()
        return Path(shutil.copy(path, copy))


def test_a_file_that_others_may_read_while_it_is_written_is_busy(tmp_path):
    copy = as_it_is_written(tmp_path / "file.hdf5", tmp_path / "copy.hdf5", shared=True)
    with pytest.raises(FileInUse, match="SWMR"):
        open_hdf5_file(copy)


def test_a_file_that_its_writer_never_closed_is_damaged_and_can_be_cleared(tmp_path):
    copy = as_it_is_written(tmp_path / "file.hdf5", tmp_path / "copy.hdf5", shared=False)
    with pytest.raises(DamagedFile, match="damaged: it was not closed by the program that wrote it") as caught:
        open_hdf5_file(copy)
    assert "h5clear -s" in caught.value.hint


@pytest.mark.parametrize("left", [0, 0.5])
def test_a_file_that_is_cut_off_is_damaged(recorded, left):
    data = recorded.read_bytes()
    recorded.write_bytes(data[: int(left * len(data))])
    with pytest.raises(DamagedFile, match=r"file\.hdf5 is damaged"):
        open_hdf5_file(recorded)


def test_a_file_that_changed_is_looked_at_again(recorded, tmp_path):
    open_hdf5_file(recorded).close()
    with h5py.File(recorded, "r+") as file:
        file["outside"] = h5py.ExternalLink("other.hdf5", "/")
    with pytest.raises(DamagedFile, match="external link"):
        open_hdf5_file(recorded)
