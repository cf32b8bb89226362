from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.apps.viewer.conftest import FRAMES, ReadBack
from tests.datasets.recordings.layouts import robotwin
from tests.run_folders import command
from vcage.apps.viewer import show
from vcage.apps.viewer.show import view
from vcage.base.errors import ConfigurationError, DamagedFile, OutputFolderError, UsageError


def test_the_command_writes_a_file_and_lists_its_contents(episode_file, tmp_path, capsys):
    answer = command(capsys, "view", episode_file, "--save", tmp_path / "look.rrd")
    assert (answer.code, answer.record["output"]) == (0, str(tmp_path / "look.rrd"))
    summary = answer.record["summary"]
    assert (summary["episode"], summary["of"], summary["frames"], summary["subtasks"]) == (0, 1, FRAMES, 2)
    assert len(ReadBack(tmp_path / "look.rrd").rows("/world/cameras/cam_high", "Blob")) == FRAMES


def test_without_pictures_everything_else_is_logged(episode_file, tmp_path, capsys):
    answer = command(capsys, "view", episode_file, "--pictures", "none", "--save", tmp_path / "look.rrd")
    seen = ReadBack(tmp_path / "look.rrd")
    assert answer.record["summary"]["cameras"] == []
    assert "Blob" not in seen.components["/world/cameras/cam_high"]
    assert "PinholeProjection" in seen.components["/world/cameras/cam_high"]


def test_a_recording_of_others_has_no_compressed_videos(tmp_path):
    with pytest.raises(UsageError, match="compressed"):
        view(robotwin(tmp_path / "a.hdf5"), save=tmp_path / "look.rrd", footage="compressed")


def test_a_name_that_the_viewer_would_not_open_is_refused(episode_file, tmp_path):
    with pytest.raises(UsageError, match=r"look\.mp4"):
        view(episode_file, save=tmp_path / "look.mp4")


def test_a_folder_that_cannot_be_written_is_named(episode_file):
    with pytest.raises(OutputFolderError, match="/proc/no"):
        view(episode_file, save=Path("/proc/no/look.rrd"))


@pytest.fixture
def damaged_file(episode_file, tmp_path_factory) -> Path:
    """An episode whose pictures are damaged in the middle."""
    damaged = tmp_path_factory.mktemp("damaged") / "damaged.hdf5"
    data = bytearray(episode_file.read_bytes())
    middle = len(data) // 2
    data[middle : middle + 20000] = bytes(20000)
    damaged.write_bytes(data)
    return damaged


def test_a_file_that_was_there_stays_when_the_episode_is_damaged(damaged_file, tmp_path):
    (tmp_path / "look.rrd").write_bytes(b"before")
    with pytest.raises(DamagedFile, match=r"damaged\.hdf5"):
        view(damaged_file, save=tmp_path / "look.rrd")
    assert (tmp_path / "look.rrd").read_bytes() == b"before"
    assert [path.name for path in tmp_path.iterdir()] == ["look.rrd"]


LIMITED = """
import resource, signal, sys
from pathlib import Path
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # a write beyond the limit is then refused
from vcage.apps.viewer.show import view
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, resource.RLIM_INFINITY))
view(Path(sys.argv[1]), save=Path(sys.argv[2]))
"""


@pytest.mark.slow
def test_a_full_disk_is_an_error_and_leaves_no_half_file(episode_file, tmp_path):
    program = [sys.executable, "-c", LIMITED, episode_file, tmp_path / "look.rrd"]
    done = subprocess.run(program, capture_output=True, text=True, check=False, env={"PYTHONPATH": ":".join(sys.path)})
    assert done.returncode == 1 and "DiskFull" in done.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("where", ["file", "viewer"])
def test_a_stream_is_closed_also_when_the_episode_is_damaged(damaged_file, tmp_path, viewer, monkeypatch, where):
    closed = []
    close = show.rr.RecordingStream.disconnect
    monkeypatch.setattr(show.rr.RecordingStream, "disconnect", lambda stream: (closed.append(stream), close(stream)))
    with pytest.raises(DamagedFile):
        view(damaged_file, save=tmp_path / "look.rrd" if where == "file" else None)
    assert len(closed) == 1


def test_without_a_screen_the_way_out_is_a_file(episode_file, monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    with pytest.raises(ConfigurationError) as caught:
        view(episode_file)
    assert "--save" in caught.value.hint


def test_the_viewer_is_not_opened_on_videos_that_it_cannot_decode(episode_file, monkeypatch):
    monkeypatch.setenv("DISPLAY", ":0")
    with pytest.raises(UsageError) as caught:
        view(episode_file, footage="compressed")
    assert "--save" in caught.value.hint


@pytest.fixture
def viewer(tmp_path, monkeypatch) -> Iterator[socket.socket]:
    """A socket that listens like a viewer, and the file of the received bytes."""
    listening = socket.create_server(("127.0.0.1", 0))
    monkeypatch.setattr(show, "PORT", listening.getsockname()[1])
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(show.rr.RecordingStream, "spawn", lambda stream, port: stream.save(tmp_path / "sent.rrd"))
    with listening:
        yield listening


def test_with_a_screen_the_viewer_gets_the_same_recording(episode_file, tmp_path, viewer):
    done = view(episode_file)
    assert done.contents.frames == FRAMES
    assert len(ReadBack(tmp_path / "sent.rrd").rows("/marks/subtask", "Scalar")) == FRAMES


def test_a_viewer_that_ended_meanwhile_is_an_error(episode_file, viewer):
    viewer.close()
    with pytest.raises(ConfigurationError) as caught:
        view(episode_file)
    assert "--save" in caught.value.hint


def test_a_viewer_that_does_not_start_is_no_bug(episode_file, monkeypatch):
    def spawn(stream, port):
        raise RuntimeError("no executable")

    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(show.rr.RecordingStream, "spawn", spawn)
    path = os.environ["PATH"]
    with pytest.raises(ConfigurationError, match="no executable") as caught:
        view(episode_file)
    assert "--save" in caught.value.hint and os.environ["PATH"] == path


def test_the_layout_is_sent_along(episode_file, tmp_path, monkeypatch):
    sent = []
    monkeypatch.setattr(show.rr.RecordingStream, "send_blueprint", lambda _, layout: sent.append(layout))
    view(episode_file, save=tmp_path / "look.rrd", footage="none")
    assert len(sent) == 1


def test_without_rerun_the_hint_names_the_extra(tmp_path):
    hidden = "import sys; sys.modules['rerun'] = None; from vcage.cli.main import main; sys.exit(main(sys.argv[1:]))"
    arguments = [sys.executable, "-c", hidden, "view", str(tmp_path), "--save", "look.rrd"]
    done = subprocess.run(arguments, capture_output=True, text=True, cwd=Path(__file__).parents[3], check=False)
    assert done.returncode == 4 and "missing_dependency" in done.stdout and "pip install 'vcage[view]'" in done.stdout
