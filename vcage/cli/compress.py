"""``vcage compress``, the stage on a run or recordings of others; and ``vcage decompress``, which undoes it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import OmitArgPrefixes, Positional, arg

from vcage.base.commands import vcage_command
from vcage.base.errors import UsageError
from vcage.base.files import RunFolder
from vcage.base.options import FOLDER, UNSAID, Flag, between, choice, several
from vcage.cli.arguments import Command
from vcage.cli.going_on import not_dry
from vcage.cli.output import Result
from vcage.cli.progress import progress
from vcage.cli.stage import StageCommand, execute_stage
from vcage.datasets.packing.estimating import estimate, estimate_clips
from vcage.datasets.packing.inspecting import FRAMES, as_lines, as_text, inspect, show_frames, totals
from vcage.datasets.packing.output import TARGETS, OutputSpec, omitted
from vcage.datasets.packing.pack import Order, pack
from vcage.datasets.packing.unpacking import unpack_all
from vcage.datasets.recordings.colours import AUTO, CHOICES, as_json
from vcage.runs.raw_pictures import accepted_files, clips_of
from vcage.stages import compress


@dataclass(frozen=True, kw_only=True)
class Recordings:
    """Options of recordings, which mean nothing with ``--run``."""

    out: Annotated[Path | None, FOLDER, UNSAID] = None
    """the folder to write"""
    to: Annotated[str | None, choice(TARGETS), UNSAID] = None
    """output layout (default: that of the recordings)"""
    fps: Annotated[float | None, between(0.1, 1000), UNSAID] = None
    """frames per second, where recordings do not say"""
    task: Annotated[str | None, arg(metavar="TEXT"), UNSAID] = None
    """for LeRobot: the task of the robot, where the recording has none"""
    robot: Annotated[str | None, arg(metavar="NAME"), UNSAID] = None
    """for LeRobot: the robot's type, where nothing says"""
    cameras: Annotated[tuple[str, ...], several("NAME ..."), UNSAID] = ()
    """only these; in a LeRobot data set that stays one, others keep their videos (default: all)"""
    colours: Annotated[str | None, choice(CHOICES), UNSAID] = None
    """order of red and blue as stored; auto: as the layout has it, unless file or pictures differ (default: auto)"""
    skip_damaged: Flag = False
    """leave out damaged recordings instead of refusing"""
    inspect: Flag = False
    """describe the recordings without writing anything"""


@dataclass(frozen=True, kw_only=True)
class Compress(Command):
    """Compress the videos of a run's episodes, or of any recordings, without visible loss.

    Searches the highest CRF whose loss stays under a threshold in JOD (ColorVideoVDP), through the real loop of
    encoding and decoding, on keyframes; then looks at one in ten of the other frames.

    With --run: reads episodes/ of a run; writes compress/*.mp4 and compress/compression.json. The episodes' files then
    refer to the videos in place of raw pictures, which only --keep-raw keeps: without them nothing is compressed again.
    With INPUT: an HDF5 file or a folder of them (this project's, RoboTwin's, ACT's, robomimic's, LIBERO's, Isaac Lab's,
    ManiSkill's), a LeRobot data set, or a folder of pictures, which are only read. Writes a new folder: HDF5 with its
    videos beside it and everything else as it was (`vcage decompress` puts the pictures back), a LeRobot data set, or
    videos; and compression.json. An interrupted call goes on when started again.

    RoboTwin swaps red and blue in its JPEGs, the other layouts do not; where pictures do not show the order, a note
    says so, frames.png (--inspect and --dry-run name one too) shows both, and --colours decides. Depth, labels and
    pictures of more than 8 bits are never encoded: they stay unchanged in HDF5, and are left out of all else;
    `other_streams` of the summary names them.

    A file of demonstrations stays one file, and each of them is a recording: FILE.demo_0, FILE.demo_1, … and so an
    episode of a LeRobot data set, unless it is marked as failed. One left out with --skip-damaged stays in the
    file unchanged. The frame rate is the control_freq of the environment, if recorded; the last of every 7
    numbers of a robomimic command is taken for a gripper's. The summary names the parts that a LeRobot data set lacks
    (left_out) and demonstrations that failed (failed).

    Times that leave the row of a picture in doubt are refused.

    examples:
      vcage compress --run runs/stationery
      vcage compress --run runs/stationery --max-loss 0.05 --effort best --keep-raw
      vcage compress robotwin/ --inspect
      vcage compress robotwin/ --fps 16.67 --out small --dry-run
      vcage compress robotwin/ --fps 16.67 --out small
      vcage compress act/ --fps 50 --to lerobot-v3.0 --task "open the jar" --out jar
      vcage compress robomimic/lift.hdf5 --out lift
    """

    input: Annotated[Path | None, FOLDER, Positional, arg(metavar="INPUT"), UNSAID] = None
    """recordings: a file or a folder"""
    run: Annotated[Path | None, FOLDER, UNSAID] = None
    """the run folder whose episodes are compressed"""
    recordings: Annotated[Recordings, OmitArgPrefixes, arg(name="recordings")] = field(default_factory=Recordings)
    """these mean nothing with --run"""
    stage: Annotated[compress.Options, OmitArgPrefixes, arg(name="")] = field(default_factory=compress.Options)
    dry_run: Flag = False
    """say what would be done, and do nothing"""

    def execute(self) -> Result:
        """Compress a run or recordings, or look at them."""
        if (self.run is None) == (self.input is None):
            help_of_it = vcage_command("compress", "--help")
            raise UsageError("give either INPUT or --run DIR", hint="see", command=help_of_it)
        if self.run is not None:
            return self._compress_run(self.run)
        assert self.input is not None  # as there is no run
        if self.stage.keep_raw:
            raise UsageError("--keep-raw is for --run", hint="leave it out: INPUT is only read")
        if self.stage.crf_of:
            raise UsageError("--crf-of is for --run", hint="leave it out, or give the CRF with --crf")
        return self._inspect(self.input) if self.recordings.inspect else self._compress(self.input)

    def _inspect(self, recordings: Path) -> Result:
        found = inspect(recordings, self.recordings.colours or AUTO)
        shown = show_frames(recordings, [one.recording for one in found if one.recording is not None])
        return Result(text=as_lines(found), summary={**totals(found), "frames_picture": as_text(shown)})

    def _compress(self, recordings: Path) -> Result:
        order, workers = self._order(recordings), self.stage.workers
        if self.dry_run:
            with progress("estimate") as show:
                return Result(summary=estimate(order, workers=workers, progress=show), next=not_dry())
        with progress("compress") as show:
            done = pack(order, workers=workers, force=self.stage.force, progress=show)
        record, shown = done.record, done.path.with_name(FRAMES)
        summary = {
            "fresh": done.fresh,
            **compress.summary(record),
            "reduction_stored": record.reduction_stored,
            "colours": as_json(record.colours),
            "other_streams": as_json(record.other_streams),
            "frames_picture": str(shown) if shown.is_file() else None,
            "notes": record.notes,
            **omitted(record.left_out, record.failed),
        }
        return Result(output=done.path, schema=record.SCHEMA, summary=summary)

    def _compress_run(self, run: Path) -> Result:
        for name, given in vars(self.recordings).items():
            if given:
                raise UsageError(f"--{name.replace('_', '-')} is for INPUT, not for --run")
        done = execute_stage("compress", StageCommand(run=run, stage=self.stage, dry_run=self.dry_run))
        if not self.dry_run:
            return done
        clips = clips_of(accepted_files(RunFolder(run)))
        if not clips:  # all were compressed before
            return done
        with progress("estimate") as show:
            expected = estimate_clips(clips, self.stage.compression, workers=self.stage.workers, progress=show)
        return replace(done, summary={**done.summary, **expected})

    def _order(self, recordings: Path) -> Order:
        asked = self.recordings
        beside = recordings.resolve().with_name(f"{recordings.resolve().stem}-compressed")
        return Order(
            recordings,
            beside if asked.out is None else asked.out,
            self.stage.compression,
            OutputSpec(asked.to, asked.fps, asked.task, asked.robot),
            asked.cameras,
            asked.skip_damaged,
            asked.colours or AUTO,
        )


@dataclass(frozen=True, kw_only=True)
class Decompress(Command):
    """Put the pictures of compressed recordings back: HDF5 in its old layout, as many frames, in order.

    INPUT is an output of `vcage compress`: an HDF5 file with videos beside it, or a folder of them. Arrays of pixels
    come back as arrays, encoded pictures as PNG in the same kind of data set, so that they lose nothing more and every
    reader of the layout sees the same as before; where the file keeps their lengths, it keeps those of the PNGs then.
    The pictures come from the videos: losses of compression remain.

    examples:
      vcage decompress small --out restored
      vcage decompress small/episode0.hdf5 --out restored --storage raw
    """

    input: Annotated[Path, FOLDER, Positional, arg(metavar="INPUT")]
    """a compressed HDF5 file, or a folder of them"""
    out: Annotated[Path, FOLDER]
    """the folder to write; it must be new"""
    storage: Literal["same", "raw"] = "same"
    """pictures as they were stored before, or all as arrays of RGB"""
    force: Flag = False
    """replace the output of an earlier call"""

    def execute(self) -> Result:
        """Put the pictures back."""
        with progress("decompress") as show:
            files = unpack_all(self.input, self.out, storage=self.storage, force=self.force, progress=show)
        return Result(output=self.out, summary={"files": [str(file) for file in files]})
