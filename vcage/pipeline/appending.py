"""Episodes of several runs in one growing data set."""

from __future__ import annotations

import logging
from pathlib import Path

from vcage.dataset.lerobot.formats import FORMATS, open_writer
from vcage.errors import UsageError
from vcage.files import RunFolder, read_json, sha256_file, write_json
from vcage.pipeline.export import find_footage, lerobot_episodes
from vcage.pipeline.settings import Settings
from vcage.progress import Progress, silent

log = logging.getLogger(__name__)

ADDED = "added.json"
"""In the folder of the data sets: format → SHA-256 of the ``episodes.json`` of every run whose episodes it holds."""


def append_to(root: Path, run: RunFolder, settings: Settings, progress: Progress = silent) -> dict[str, Path]:
    """Add the accepted episodes of a run to the LeRobot data sets in a folder, one for each format.

    A data set that is not there yet is begun. Each is whole at any time, and a run that was added before is left out,
    so an interrupted call can be repeated.

    Args:
        root: folder of the data sets, ``<root>/lerobot-v3.0`` and so on.
        run: the run, compressed.
        settings: which formats, and which codec.
        progress: told of every episode.

    Returns:
        Format → its data set.

    Raises:
        UsageError: no LeRobot format is asked for; or the episodes do not fit those that are there: names what differs.
        MissingStage: the run is not compressed.
        DamagedFile: an episode, a video or the data set cannot be read.
        OutputFolderError, DiskFull: the folder cannot be written.
    """
    formats = [name for name in settings.export.formats if name in FORMATS]
    if not formats:
        raise UsageError("only LeRobot data sets can be added to", hint=f"give --formats {' '.join(FORMATS)}")
    own = sha256_file(run.episodes)
    added: dict[str, list[str]] = read_json(root / ADDED) if (root / ADDED).exists() else {}
    footage = find_footage(run, settings, progress)
    for name in formats:
        if own in added.get(name, []):
            log.info("%s holds the episodes of %s already", root / name, run)
            continue
        with open_writer(name, root / name, footage.facts, append=(root / name).exists()) as writer:
            for episode in lerobot_episodes(run, footage, progress):
                writer.add(episode)
        added[name] = [*added.get(name, []), own]
        write_json(root / ADDED, added)
    return {name: root / name for name in formats}
