"""Data sets that grow from run to run."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from tests.recordings import collected
from tests.run_folders import copied
from vcage.apps.appending import append_to
from vcage.base.errors import DamagedFile, MissingStage, StaleStage, UsageError
from vcage.base.files import RunFolder, read_json
from vcage.datasets.lerobot.formats import FORMATS
from vcage.datasets.lerobot.growing import SOURCES
from vcage.datasets.lerobot.writer import LeRobotWriter
from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.recordings.opening import open_recordings
from vcage.runs import footage
from vcage.runs.context import StageContext
from vcage.runs.footage import WORKING
from vcage.stages import compress, export

pytestmark = pytest.mark.slow

V3 = "lerobot-v3.0"


def exported(
    root: Path,
    count: int = 1,
    formats: tuple[str, ...] = (V3,),
    codec: str | None = None,
    seed: int = 200,
    **changes: Any,
) -> RunFolder:
    """A run of so many episodes, whose pictures depend on a seed, compressed at a CRF and exported; or made anew."""
    run = collected(root, count=count, frames=6, seed=seed)
    compression = CompressionSettings(**{"crf": 8, "effort": "fast", **changes})
    redone = {"seed": 7, "workers": 1, "force": True}
    compress.execute(run, compress.Options(compression=compression, keep_raw=True, **redone), StageContext())
    crf = None if codec is None else 30
    export.execute(run, export.Options(formats=formats, codec=codec, crf=crf, **redone), StageContext())
    return run


@pytest.fixture(scope="module")
def runs(tmp_path_factory) -> tuple[RunFolder, RunFolder]:
    root = tmp_path_factory.mktemp("runs")
    return exported(root / "a", 1, tuple(FORMATS), seed=0), exported(root / "b", 2, tuple(FORMATS), seed=100)


@pytest.fixture
def out(tmp_path) -> Path:
    return tmp_path / "all"


def info(out: Path, version: str = V3) -> dict[str, Any]:
    return json.loads((out / version / "meta/info.json").read_text())


def episodes(out: Path) -> int:
    return info(out)["total_episodes"]


def encoding(out: Path) -> dict[str, Any]:
    return info(out)["features"]["observation.images.cam_high"]["info"]


@pytest.mark.parametrize("version", FORMATS)
def test_the_episodes_of_two_runs_are_one_data_set(runs, out, version):
    for run in runs:
        sets = append_to(out, run)
    assert sets[version] == out / version
    assert (info(out, version)["total_episodes"], info(out, version)["total_frames"]) == (3, 18)
    assert [recording.number for recording in open_recordings(sets[version])] == [0, 1, 2]


def test_the_card_tells_the_runs_that_were_added(runs, out):
    for run in runs:
        append_to(out, run)
    rows = [json.loads(line) for line in (out / V3 / "meta/runs.jsonl").read_text().splitlines()]
    assert [(row["run"], row["episodes"]) for row in rows] == [("a", 1), ("b", 2)]
    assert "3 episodes of dual_panda" in (out / V3 / "README.md").read_text()


def test_a_run_is_added_once(runs, out):
    for _ in range(2):
        append_to(out, runs[1])
    assert episodes(out) == 2


def test_a_run_that_has_grown_adds_its_new_episodes(tmp_path, out):
    append_to(out, exported(tmp_path / "run", 1))
    append_to(out, exported(tmp_path / "run", 2))
    assert [recording.number for recording in open_recordings(out / V3)] == [0, 1]


def test_an_interrupted_addition_is_made_up_for(runs, out, monkeypatch):
    append_to(out, runs[0])
    with monkeypatch.context() as patched, pytest.raises(KeyboardInterrupt):
        patched.setattr(LeRobotWriter, "finish", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
        append_to(out, runs[1])
    assert episodes(out) == 1
    append_to(out, runs[1])
    assert episodes(out) == 3


def test_a_data_set_that_a_killed_addition_left_aside_is_added_to(runs, out):
    append_to(out, runs[0])
    (out / V3).rename(out / f"{V3}.replaced-1")
    append_to(out, runs[1])
    assert episodes(out) == 3


def test_a_data_set_that_was_deleted_is_begun_again(runs, out):
    append_to(out, runs[0])
    shutil.rmtree(out / V3)
    append_to(out, runs[0])
    assert episodes(out) == 1


def test_a_data_set_is_begun_in_an_empty_folder(runs, out):
    (out / V3).mkdir(parents=True)
    append_to(out, runs[0])
    assert episodes(out) == 1


def test_sources_that_cannot_be_read_stop_the_addition(runs, out):
    append_to(out, runs[0])
    (out / V3 / SOURCES).write_text('["0a1b"]\n')
    with pytest.raises(DamagedFile, match="is no JSON object"):
        append_to(out, runs[1])


def test_videos_come_from_the_export_without_a_second_search(tmp_path, out, monkeypatch):
    run = exported(tmp_path / "run", codec="h264")
    monkeypatch.setattr(footage, "search_data_set", lambda *_, **__: pytest.fail("encoded again"))
    append_to(out, run)
    video = f"{V3}/videos/observation.images.cam_high/chunk-000/file-000.mp4"
    assert (out / video).read_bytes() == (run.export.parent / video).read_bytes()
    assert (encoding(out)["video.codec"], encoding(out)["video.crf"]) == ("h264", 30)
    assert not (run.root / WORKING).exists()


def test_runs_compressed_to_different_degrees_form_one_data_set(runs, tmp_path, out):
    append_to(out, runs[0])
    assert encoding(out)["video.crf"] == 8
    append_to(out, exported(tmp_path / "other", crf=20, pixel_format="yuv420p", effort="default"))
    assert episodes(out) == 2
    assert not {"video.crf", "video.pix_fmt", "video.preset"} & set(encoding(out))
    assert (encoding(out)["video.codec"], encoding(out)["video.g"]) == ("hevc", 10)


def test_another_codec_is_refused_with_the_option_that_mends_it(runs, tmp_path, out):
    append_to(out, runs[0])
    with pytest.raises(UsageError, match=r"other video\.codec.*\(h264\)") as caught:
        append_to(out, exported(tmp_path / "other", codec="h264"))
    assert "--codec hevc" in caught.value.hint


def test_a_run_that_is_not_exported_leaves_the_data_set_as_it_was(runs, tmp_path, out):
    append_to(out, runs[0])
    with pytest.raises(MissingStage, match=r"export\.json"):
        append_to(out, collected(tmp_path / "raw", frames=6))
    assert episodes(out) == 1


def test_episodes_that_came_after_the_export_ask_for_another(tmp_path, out):
    run = exported(tmp_path / "run", 1)
    collected(run.root, count=2, frames=6)
    with pytest.raises(StaleStage, match="other episodes"):
        append_to(out, run)


def test_only_lerobot_data_sets_grow(tmp_path, out):
    with pytest.raises(UsageError, match="only LeRobot"):
        append_to(out, exported(tmp_path / "run", formats=("robotwin",)))


def test_states_without_videos_grow_too_and_need_no_compression(tmp_path, out):
    for name, seed in (("a", 0), ("b", 100)):
        run = collected(tmp_path / name, count=1, frames=6, seed=seed)
        export.execute(run, export.Options(formats=(V3,), no_videos=True, seed=7), StageContext())
        append_to(out, run)
        append_to(out, run)
    assert episodes(out) == 2
    assert not [name for name in info(out)["features"] if name.startswith("observation.images")]


def test_what_is_added_has_the_state_of_objects_that_the_export_has(finished, tmp_path, out):
    run = copied(finished.run, tmp_path / "run", before="compress")
    options = export.Options(formats=(V3,), no_videos=True, environment_state=True)
    export.execute(run, options, finished.context)
    append_to(out, run)
    assert episodes(out) == 1
    assert info(out)["features"] == read_json(run.root / "export" / V3 / "meta/info.json")["features"]
