"""How long each stage took. Kept apart from the stages' own files, which are the same for the same seed."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator

from vcage.base.errors import InputFileError
from vcage.base.files import RunFolder, read_json, recover, write_json


@contextlib.contextmanager
def timed(run: RunFolder, stage: str) -> Iterator[None]:
    """Note the wall time of the block in ``timings.json``, beside those of the other stages.

    Nothing is noted when the block fails or takes less than a tenth of a second (the stage was finished before).
    """
    start = time.perf_counter()
    yield
    seconds = time.perf_counter() - start
    if seconds > 0.1 and run.root.is_dir():
        recover(run.timings)
        write_json(run.timings, {**read_timings(run), stage: round(seconds, 2)})


def read_timings(run: RunFolder) -> dict[str, float]:
    """Seconds by stage; empty when nothing was timed or the file is damaged (it is a by-product)."""
    try:
        timings = read_json(run.timings)
    except InputFileError:
        return {}
    return timings if isinstance(timings, dict) else {}
