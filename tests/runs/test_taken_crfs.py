"""CRFs taken over from another run: no search where they pass, an own one where they do not, and a record of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.recordings import CAMERAS, collected
from vcage.base.errors import MissingStage, UsageError
from vcage.base.files import RunFolder
from vcage.datasets.packing.settings import CompressionSettings
from vcage.runs.context import StageContext
from vcage.runs.taken_crfs import crfs_of
from vcage.schema.compression import Compression
from vcage.stages import compress
from vcage.stages.chain import ChainOptions
from vcage.video.choices import LOSSLESS

QUICK = CompressionSettings(effort="fast", pixel_format="yuv444p10le")


def compressed(run: RunFolder, crf_of: RunFolder | None = None, **changes: Any) -> Compression:
    options = compress.Options(
        seed=7, workers=1, crf_of=crf_of and crf_of.root, **({"keep_raw": True, "compression": QUICK} | changes)
    )
    return compress.execute(run, options, StageContext("offline")).record


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    """A run that searched."""
    run = collected(tmp_path_factory.mktemp("first"), count=1, frames=6)
    assert compressed(run).taken_crfs == []
    return run


@pytest.fixture
def second(tmp_path: Path) -> RunFolder:
    """Another one, to be compressed."""
    return collected(tmp_path / "second", count=1, frames=6, seed=3)


def with_crf(first: RunFolder, crf: int | None, folder: Path) -> RunFolder:
    """A run as another one would leave it whose episodes agreed on a CRF."""
    run, record = RunFolder(folder), Compression.read(first.compression)
    streams = [stream.model_copy(update={"crf": crf}) for stream in record.streams]
    run.compression.parent.mkdir(parents=True)
    record.model_copy(update={"streams": streams}).write(run.compression)
    return run


def test_videos_that_pass_at_the_crfs_of_another_run_are_encoded_once_and_the_record_says_so(
    first: RunFolder, second: RunFolder, tmp_path: Path
):
    other = with_crf(first, 12, tmp_path / "other")
    record = compressed(second, other)
    assert [(one.camera, one.run, one.crf, one.passed) for one in record.taken_crfs] == [
        (camera, "../other", 12, True) for camera in CAMERAS
    ]
    assert {(stream.crf, len(stream.evaluations)) for stream in record.streams} == {(12, 1)}


def test_a_crf_that_loses_too_much_here_is_searched_again_and_the_record_says_so(
    first: RunFolder, second: RunFolder, tmp_path: Path
):
    record = compressed(second, with_crf(first, 51, tmp_path / "other"))
    assert {(one.crf, one.passed) for one in record.taken_crfs} == {(51, False)}
    searched = compressed(collected(tmp_path / "searched", count=1, frames=6, seed=3))
    own = {camera.camera: camera.crf for camera in searched.cameras}
    for camera in record.cameras:
        assert camera.crf is not None and abs(camera.crf - (own[camera.camera] or 0)) <= 1
        assert max(camera.loss_max, camera.held_out_max or 0.0) < QUICK.max_loss


def test_a_run_that_was_compressed_before_says_that_another_run_has_no_effect(
    first: RunFolder, second: RunFolder, tmp_path: Path
):
    other, third = with_crf(first, 12, tmp_path / "other"), with_crf(first, 30, tmp_path / "third")
    begun = compressed(second, other)
    options = compress.Options(seed=7, workers=1, keep_raw=True, compression=QUICK, crf_of=other.root)
    again = compress.execute(second, options, StageContext("offline"))
    assert (again.record, again.notes) == (begun, ())
    late = compress.execute(second, replace(options, crf_of=third.root), StageContext("offline"))
    assert late.record == begun and "--crf-of has no effect" in late.notes[0]


def test_a_camera_that_is_lossless_in_another_run_is_searched(first: RunFolder, tmp_path: Path):
    assert set(crfs_of(first.root, QUICK)) == set(CAMERAS)
    assert crfs_of(with_crf(first, None, tmp_path / "other").root, QUICK) == {}


def test_episodes_that_join_later_go_by_the_videos_that_there_are(first: RunFolder, second: RunFolder, tmp_path: Path):
    begun = compressed(second, with_crf(first, 12, tmp_path / "other"), keep_raw=False)
    collected(second.root / "more", count=2, frames=6, seed=3)
    for name in ("episodes.json", "episode_000001.hdf5"):
        (second.root / "more/episodes" / name).replace(second.root / "episodes" / name)
    grown = compressed(second, with_crf(first, 30, tmp_path / "third"), keep_raw=False, force=True)
    assert grown.taken_crfs == begun.taken_crfs
    assert {stream.crf for stream in grown.streams} == {12}


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (CompressionSettings(effort="best", pixel_format="yuv444p10le"), "with other options: effort fast, not best"),
        (CompressionSettings(crf=20), "a CRF that a camera's episodes share and that is searched"),
        (CompressionSettings(scope="episode"), "a CRF that a camera's episodes share and that is searched"),
        (CompressionSettings(crf=LOSSLESS), "a CRF that a camera's episodes share and that is searched"),
    ],
)
def test_crfs_of_other_options_are_refused(first: RunFolder, settings: CompressionSettings, said: str):
    with pytest.raises(UsageError, match=said):
        crfs_of(first.root, settings)


def test_a_chain_refuses_a_run_that_was_not_compressed_before_it_begins(tmp_path: Path):
    with pytest.raises(MissingStage, match=r"compression\.json"):
        ChainOptions(instruction="Put two blocks on the plate", crf_of=tmp_path).require_possible()
