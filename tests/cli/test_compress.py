"""``vcage compress INPUT`` as a user calls it: one line of JSON, an exit code, the input untouched."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import psutil
import pytest

from tests.datasets.packing.orders import act_folder, add_camera
from tests.recordings import collected
from tests.run_folders import Answer, command, digests
from vcage.base.leftovers import PARTIAL
from vcage.cli.main import main
from vcage.datasets.packing import clips as clip_module
from vcage.datasets.packing.pack import WORKING

QUICK = ("--fps", 10, "--crf", 20, "--effort", "fast", "--keyframes", 3)


@pytest.fixture
def source(tmp_path) -> Path:
    return act_folder(tmp_path / "in")


def compress(capsys, source: Path, *options: str | Path | int) -> Answer:
    return command(capsys, "compress", source, *QUICK, "--workers", 1, *options)


def test_recordings_are_compressed_and_left_as_they_were(capsys, tmp_path, source):
    before = digests(source)
    answer = compress(capsys, source, "--out", tmp_path / "out")
    assert (answer.code, answer.record["ok"]) == (0, True)
    assert answer.record["output"] == str(tmp_path / "out/compression.json")
    assert answer.record["summary"]["crf"] == {"cam_high": 20}
    assert 0.9 < answer.record["summary"]["reduction_raw"] < 1
    assert sorted(digests(tmp_path / "out")) == [
        "a.cam_high.mp4",
        "a.hdf5",
        "b.cam_high.mp4",
        "b.hdf5",
        "compression.json",
    ]
    assert digests(source) == before


def test_without_a_name_the_output_lies_beside_the_input(capsys, tmp_path, source):
    assert compress(capsys, source).record["output"] == str(tmp_path / "in-compressed/compression.json")


def test_the_same_call_again_does_nothing(capsys, tmp_path, source):
    assert compress(capsys, source, "--out", tmp_path / "out").record["summary"]["fresh"]
    before = digests(tmp_path)
    answer = compress(capsys, source, "--out", tmp_path / "out")
    assert (answer.code, answer.record["summary"]["fresh"]) == (0, False)
    assert digests(tmp_path) == before


def test_other_options_are_refused_until_forced(capsys, tmp_path, source):
    compress(capsys, source, "--out", tmp_path / "out")
    answer = compress(capsys, source, "--out", tmp_path / "out", "--gop", 2)
    assert (answer.code, answer.error["code"]) == (3, "stale_stage") and "--force" in answer.error["hint"]
    assert compress(capsys, source, "--out", tmp_path / "out", "--gop", 2, "--force").record["summary"]["fresh"]


def test_a_look_writes_nothing_and_tells_of_damage(capsys, tmp_path, source):
    (source / "b.hdf5").write_bytes(b"no HDF5")
    before = digests(tmp_path)
    answer = command(capsys, "compress", source, "--inspect")
    assert answer.code == 0
    assert answer.record["summary"]["recordings"] == 1
    assert list(answer.record["summary"]["damaged"]) == [str(source / "b.hdf5")]
    assert digests(tmp_path) == before


def test_a_dry_run_estimates_and_writes_nothing(capsys, tmp_path, source):
    before = sorted(tmp_path.rglob("*"))
    answer = compress(capsys, source, "--out", tmp_path / "out", "--dry-run")
    assert (answer.code, answer.record["summary"]["would"], answer.record["summary"]["videos"]) == (0, "write", 2)
    assert sorted(tmp_path.rglob("*")) == before


def test_a_dry_run_of_a_run_estimates_the_output(capsys, tmp_path):
    run = collected(tmp_path / "run")
    before = sorted(tmp_path.rglob("*"))
    answer = command(capsys, "compress", "--run", run.root, *QUICK[2:], "--workers", 1, "--seed", 7, "--dry-run")
    summary = answer.record["summary"]
    assert (summary["would"], summary["producer"], summary["videos"]) == ("write", "compress", 6)
    assert 0 < summary["bytes"] < summary["raw_bytes"]
    assert sorted(tmp_path.rglob("*")) == before


# --- refused -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "code", "said"),
    [
        (["--display", "cinema"], "unknown_name", "standard_fhd"),
        (["--effort", "hasty"], "usage", "default"),
        (["--pixel-format", "yuv999"], "unknown_name", "yuv420p"),
        (["--crf", "52"], "usage", "51"),
        (["--crf", "best"], "usage", "lossless"),
        (["--crf=-1"], "usage", "lossless"),
        (["--codec", "av1", "--crf", "lossless"], "usage", "--codec hevc or h264"),
        (["--max-loss", "0", "--crf", "1"], "usage", "above 0"),
        (["--max-loss", "nan"], "usage", "not between"),
        (["--gop", "0"], "usage", "positive"),
        (["--workers", "0"], "usage", "positive"),
        (["--codec", "vp9"], "usage", "hevc"),
        (["--cameras", "cam_none"], "unknown_name", "cam_high"),
        (["--to", "lerobot-v3.0"], "usage", "--task"),
        (["--run", "runs/one"], "usage", "INPUT or --run"),
        (["--keep-raw"], "usage", "only read"),
        (["--crf-of", "runs/blocks"], "usage", "--crf-of is for --run"),
    ],
)
def test_a_wrong_option_is_refused_with_the_right_one_before_any_work(capsys, tmp_path, source, options, code, said):
    answer = compress(capsys, source, "--out", tmp_path / "out", *options)
    assert (answer.code, answer.error["code"]) == (2, code)
    assert said in answer.error["message"] + answer.error["hint"]
    assert len(answer.complaints) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["in"]


def test_neither_recordings_nor_a_run_is_refused(capsys):
    assert command(capsys, "compress").code == 2


@pytest.mark.parametrize(
    "options",
    [["--out", "x"], ["--to", "videos"], ["--fps", "3"], ["--cameras", "c"], ["--skip-damaged"], ["--inspect"]],
)
def test_options_for_recordings_are_refused_for_a_run(capsys, tmp_path, options):
    answer = command(capsys, "compress", "--run", tmp_path, *options)
    assert (answer.code, answer.error["code"]) == (2, "usage") and options[0] in answer.error["message"]


def test_an_unknown_frame_rate_is_asked_for(capsys, source):
    answer = command(capsys, "compress", source)
    assert (answer.code, answer.error["hint"]) == (2, "give --fps N")


def test_a_damaged_recording_is_refused_and_left_out_on_demand(capsys, tmp_path, source):
    (source / "b.hdf5").write_bytes(b"no HDF5")
    answer = compress(capsys, source, "--out", tmp_path / "out")
    assert (answer.code, answer.error["code"]) == (3, "damaged_file") and "--skip-damaged" in answer.error["hint"]
    assert compress(capsys, source, "--out", tmp_path / "out", "--skip-damaged").code == 0


# --- broken off ----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def four(tmp_path_factory) -> Path:
    """Two recordings with two cameras each."""
    folder = act_folder(tmp_path_factory.mktemp("four") / "in")
    for name in ("a", "b"):
        add_camera(folder / f"{name}.hdf5", "cam_low")
    return folder


@pytest.fixture(scope="module")
def whole(four, tmp_path_factory) -> dict[str, str]:
    """The files of a call that nobody ended."""
    out = tmp_path_factory.mktemp("whole") / "out"
    assert main([*map(str, ("compress", four, *QUICK, "--workers", 1, "--out", out))]) == 0
    return digests(out)


@pytest.mark.slow
@pytest.mark.parametrize(("number", "code"), [(signal.SIGKILL, -signal.SIGKILL), (signal.SIGINT, 130)])
def test_work_finished_before_an_interruption_is_not_repeated(capsys, tmp_path, four, whole, monkeypatch, number, code):
    assert _ended_early(four, tmp_path / "out", number) == code
    assert not (tmp_path / "out").exists()
    work = tmp_path / f"out{WORKING}/videos"
    left = 4 - sum(PARTIAL not in file.name for file in work.glob("*.json"))
    assert left < 4

    searched = []
    search = clip_module.search_clip
    monkeypatch.setattr(clip_module, "search_clip", lambda *of: (searched.append(of), search(*of))[1])
    assert compress(capsys, four, "--out", tmp_path / "out").code == 0
    assert len(searched) == left
    assert digests(tmp_path / "out") == whole
    assert not work.exists()


def _ended_early(source: Path, out: Path, number: signal.Signals) -> int:
    """The exit code of a call that got a signal when it had finished a clip; it leaves no process, and is silent on
    what the processes left."""
    options = map(str, (source, *QUICK, "--out", out, "--workers", 2))
    call = [sys.executable, "-c", INTERRUPTIBLE, "compress", *options]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    with subprocess.Popen(
        call, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=environment
    ) as process:
        assert process.stderr is not None
        for line in process.stderr:
            if line.startswith("compress: ["):
                break
        children = psutil.Process(process.pid).children(recursive=True)
        process.send_signal(number)
        assert "leaked" not in process.stderr.read()
        code = process.wait(30)
    assert not psutil.wait_procs(children, 20)[1]
    return code


INTERRUPTIBLE = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job inherits that it is ignored
from vcage.cli.main import main
if __name__ == "__main__":
    sys.exit(main())
"""
