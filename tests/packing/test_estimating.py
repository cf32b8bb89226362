from __future__ import annotations

import pytest

from tests.packing.orders import act_folder, order, packed
from tests.runs import digests
from vcage.errors import OutputFolderError, UnknownName, UsageError
from vcage.packing.estimating import estimate


@pytest.fixture
def source(tmp_path):
    return act_folder(tmp_path / "in", *"abcd")


def test_an_estimate_writes_nothing(tmp_path, source):
    before = digests(tmp_path)
    estimate(order(source, tmp_path / "out"))
    assert digests(tmp_path) == before and [path.name for path in tmp_path.iterdir()] == ["in"]


def test_an_estimate_of_recordings_that_are_alike_is_what_comes_out(tmp_path, source):
    told = estimate(order(source, tmp_path / "out"), workers=1)
    streams = packed(source, tmp_path / "out").record.streams
    assert (told["recordings"], told["videos"], told["cameras"]["cam_high"]["crf"]) == (4, 4, [20, 20, 20])
    for what in ("bytes", "raw_bytes", "jpeg_bytes"):
        assert told[what] == pytest.approx(sum(getattr(stream, what) for stream in streams), rel=0.01)


def test_more_workers_take_less_time(tmp_path, source, monkeypatch):
    moments = iter(range(0, 10_000, 100))
    monkeypatch.setattr("time.perf_counter", lambda: float(next(moments)))
    assert estimate(order(source, tmp_path / "out"), workers=4)["seconds"] == 100


@pytest.mark.parametrize(
    ("changes", "error"),
    [
        ({"display": "cinema"}, UnknownName),
        ({"target": "lerobot-v3.0"}, UsageError),
        ({"cameras": ("no",)}, UnknownName),
    ],
)
def test_what_could_not_be_done_is_refused(tmp_path, source, changes, error):
    with pytest.raises(error):
        estimate(order(source, tmp_path / "out", **changes))


def test_an_output_among_the_recordings_is_refused(source):
    with pytest.raises(OutputFolderError, match="in one another"):
        estimate(order(source, source / "out"))
