"""Episodes of several runs in one growing data set."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from vcage.base.errors import DamagedFile, StaleStage, UsageError
from vcage.base.files import RunFolder, read_json, sha256_file, write_json
from vcage.base.hold import held
from vcage.base.inside import name_complaint
from vcage.base.leftovers import recover
from vcage.base.progress import Progress, silent
from vcage.datasets.lerobot.features import CAMERA, ENCODER
from vcage.datasets.lerobot.formats import FORMATS, open_writer
from vcage.datasets.lerobot.meta import INFO, appendable_info, data_set_info
from vcage.datasets.lerobot.places import placed
from vcage.datasets.lerobot.repack import VIDEO_PATHS
from vcage.runs.accepted import acceptance_files
from vcage.runs.raw_pictures import EpisodeFile, accepted_files
from vcage.schema.export import Export
from vcage.stages.export import Footage, lerobot_episodes

logger = logging.getLogger(__name__)

ADDED = "added.json"
"""File in the folder of the data sets: format → SHA-256 of an episode's file → its number in the data set.

It is written before the data set, so it may name episodes beyond its end, which were never added.
"""


def append_to(root: Path, run: RunFolder, progress: Progress = silent) -> dict[str, Path]:
    """Add the episodes of a run to the LeRobot data sets in a folder, one for each format that the run was exported to.

    A missing data set is created. Each is whole at any time, and an episode already in it is left
    out: an interrupted call can be repeated, and a run that has grown adds what is new. The videos are those of the
    export.

    Example:
        >>> append_to(Path("datasets/all"), RunFolder("runs/blocks"))

    Args:
        root: folder of the data sets, ``<root>/lerobot-v3.0`` and so on.
        run: the run, exported.
        progress: called for every episode.

    Returns:
        Format → its data set.

    Raises:
        UsageError: the run was not exported to a LeRobot format; or the episodes do not fit the present ones: names
            what differs.
        MissingStage, StaleStage: the run is not exported, or has other episodes since.
        DamagedFile: an episode, a video or the data set cannot be read.
        FolderInUse: another process adds to them.
        OutputFolderError, DiskFull: the folder cannot be written.
    """
    export = Export.read(run.export)
    if any(export.provenance.inputs.get(run.relative(path)) != sha256_file(path) for path in acceptance_files(run)):
        raise StaleStage(f"{run.export} was made of other episodes")
    sets = {one.format: run.file(one.path) for one in export.datasets if one.format in FORMATS}
    if not sets:
        raise UsageError("only LeRobot data sets can be added to", hint=f"give --formats {' '.join(FORMATS)}")
    episodes = {export.provenance.inputs[file.name]: file for file in accepted_files(run)}
    RunFolder(root).make()
    with held(root):
        for name, exported in sets.items():
            footage = _footage_of(exported, [file.name for file in episodes.values()])
            if not _append(root, name, episodes, footage, progress):
                logger.info("%s holds the episodes of %s already", root / name, run)
    return {name: root / name for name in sets}


def _append(root: Path, name: str, episodes: Mapping[str, EpisodeFile], footage: Footage, progress: Progress) -> bool:
    """Add the episodes, by the SHA-256 of their files, that a data set lacks; True if there were any."""
    recover(root / name)
    count = appendable_info(root / name, {})["total_episodes"] if (root / name / INFO).is_file() else 0
    added = _read_added(root / ADDED)
    stored = {digest: number for digest, number in added.get(name, {}).items() if number < count}
    new = {digest: file for digest, file in episodes.items() if digest not in stored}
    if not new:
        return False
    coming = {digest: number for number, digest in enumerate(new, start=count)}
    with open_writer(name, root / name, footage.facts, append=count > 0) as writer:
        for episode in lerobot_episodes(list(new.values()), footage, progress):
            writer.add(episode)
        write_json(root / ADDED, {**added, name: {**stored, **coming}})
    return True


def _read_added(path: Path) -> dict[str, dict[str, int]]:
    if not path.exists():
        return {}
    try:
        return TypeAdapter(dict[str, dict[str, int]]).validate_python(read_json(path))
    except ValidationError as error:
        raise DamagedFile(
            f"{path} does not list the episodes of the data sets", hint="begin new ones in another folder"
        ) from error


def _footage_of(exported: Path, files: Sequence[str]) -> Footage:
    """Return the videos of a data set that the export wrote of these episodes, in this order.

    Raises:
        DamagedFile: it is not as the export wrote it; names the field.
    """
    info = data_set_info(exported)
    cameras = {key: feature for key, feature in info["features"].items() if feature["dtype"] == "video"}
    pattern, size = VIDEO_PATHS[info["codebase_version"]], info["chunks_size"]
    if cameras and info["video_path"] != pattern:
        raise _not_exported(exported, "video_path", info["video_path"], repr(pattern))
    if not isinstance(size, int):
        raise _not_exported(exported, "chunks_size", size, "a whole number")
    videos, facts = {}, {}
    for key, feature in cameras.items():
        camera, encoding = key.removeprefix(CAMERA), feature.get("info")
        if name_complaint(camera) or not isinstance(encoding, dict):
            raise _not_exported(exported, f"features.{key}", encoding, "a camera's name, and info on its videos")
        facts[camera] = {fact: encoding.get(fact) for fact in ENCODER}
        for number, file in enumerate(files):
            chunk, index = divmod(number, size)
            place = {"episode_chunk": chunk, "episode_index": number, "chunk_index": chunk, "file_index": index}
            videos[file, camera] = placed(exported, "video_path", pattern, video_key=key, **place)
    return Footage(videos, facts)


def _not_exported(exported: Path, field: str, found: object, expected: str) -> DamagedFile:
    message = f"{exported / INFO}: field {field}: {str(found)[:80]!r}; expected {expected}, as export wrote it"
    return DamagedFile(message, hint="fix it", maker="export", details={"path": str(exported / INFO), "field": field})
