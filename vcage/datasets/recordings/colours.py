"""Whether red and blue are swapped in recordings that lie together, and were so made alike."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

import numpy as np

from vcage.base.errors import DamagedFile
from vcage.datasets.recordings.hdf5_layouts import Hdf5Recording
from vcage.datasets.recordings.recording import Recording

VOTERS = 20
"""Recordings that are asked when many must agree."""


def agree_on_colours(recordings: Sequence[Recording]) -> None:
    """Take recordings of one layout that lie together for made alike: what most of them look like holds for all.

    Only some are looked at. Those that say themselves whether their colours are swapped are believed.
    """
    for layout in {type(recording) for recording in recordings}:
        unsaid = [one for one in recordings if type(one) is layout and isinstance(one, Hdf5Recording)]
        some = np.unique(np.linspace(0, len(unsaid) - 1, min(len(unsaid), VOTERS)).astype(int))
        votes = [vote for index in some if (vote := _colour_vote(unsaid[index])) is not None]
        if votes:
            for recording in unsaid:
                recording.agreed = 2 * sum(votes) > len(votes)


def _colour_vote(recording: Hdf5Recording) -> bool | None:
    with suppress(DamagedFile):  # which is complained of where the recording is read
        if not recording.says_colours:
            return recording.looks_swapped()
    return None
