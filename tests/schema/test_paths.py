"""A path in a file of a run that could lead out of it is refused with file and field, also where it was sealed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.run_folders import Finished
from vcage.base.errors import InputFileError
from vcage.base.files import read_json, write_json
from vcage.episodes.store import read_log
from vcage.runs.edits import SEAL, edits
from vcage.schema.base import Document
from vcage.schema.compression import Compression
from vcage.schema.episodes import Episodes, Renders, Verdicts
from vcage.schema.exchange import Exchange
from vcage.schema.export import Export
from vcage.schema.matches import Matches
from vcage.schema.plan import Plan
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtasks

KEY = "a key"
"""In place of a key that is itself a path."""

FIELDS: list[tuple[type[Document], str, str]] = [
    (Scene, "place/scene.json", "pictures.source"),
    (Scene, "optimize/scene.json", "pictures.background"),
    (Plan, "inpaint/plan.json", "target"),
    (Matches, "match/matches.json", "overlay"),
    (Subtasks, "subtasks/subtasks.json", "kept.0.script"),
    (Episodes, "episodes/episodes.json", "episodes.0.file"),
    (Episodes, "episodes/episodes.json", "episodes.0.verdicts.0.pictures.0"),
    (Verdicts, "verify/verdicts.json", f"episodes.{KEY}.0.pictures.0"),
    (Compression, "compress/compression.json", "streams.0.episode"),
    (Compression, "compress/compression.json", "streams.0.file"),
    (Compression, "compress/compression.json", f"packed.{KEY}"),
    (Export, "export/export.json", "datasets.0.path"),
]
VALUES = {
    "absolute": "/etc/passwd",
    "up": "../../../etc/passwd",
    "NUL": "a\0b",
    "long": "x" * 300,
    "device": "/dev/zero",
}


def put(data: Any, field: str, value: str) -> None:
    """Set a field of JSON; a path that is a key takes the value's place."""
    *around, last = field.split(".")
    for part in around:
        data = next(iter(data.values())) if part == KEY else data[int(part) if part.isdecimal() else part]
    if last == KEY:
        data[value] = data.pop(next(iter(data)))
    else:
        data[int(last) if last.isdecimal() else last] = value


@pytest.mark.parametrize("value", VALUES.values(), ids=VALUES)
@pytest.mark.parametrize(("kind", "file", "field"), FIELDS, ids=[f"{file} {field}" for _, file, field in FIELDS])
def test_a_path_that_leads_out_is_refused_by_its_field(kind, file, field, value, finished: Finished, tmp_path: Path):
    data = read_json(finished.run.root / file)
    if file.startswith("optimize"):
        data["pictures"]["background"] = "place/background.png"
    kind.parse(data, tmp_path)
    put(data, field, value)
    path = write_json(tmp_path / Path(file).name, data)
    with pytest.raises(InputFileError) as told:
        kind.read(path)
    assert told.value.exit_code == 3 and told.value.message.startswith(f"{path}: field ")
    assert field.partition(f".{KEY}")[0] in told.value.message


@pytest.mark.parametrize("value", VALUES.values(), ids=VALUES)
def test_so_is_one_in_the_log_of_attempts(value, finished: Finished, tmp_path: Path):
    attempt = json.loads((finished.run.root / "episodes" / "log.jsonl").read_text().splitlines()[0])
    attempt["verdict"]["pictures"][0] = value
    (tmp_path / "log.jsonl").write_text(json.dumps(attempt))
    with pytest.raises(InputFileError, match=r"log\.jsonl, line 1: field verdict\.pictures\.0"):
        read_log(tmp_path)


@pytest.mark.parametrize("value", VALUES.values(), ids=VALUES)
def test_so_is_one_in_a_seal(value, finished: Finished, tmp_path: Path):
    path = write_json(tmp_path / "plan.json", {})
    write_json(tmp_path / SEAL, {"record": {}, "files": {value: "0" * 64}})
    with pytest.raises(InputFileError, match=r"\.written\.json: field files\."):
        edits(path)


@pytest.mark.parametrize("value", [*VALUES.values(), "pictures/x.png"])
def test_an_exchange_names_pictures_of_its_own_folder_alone(value):
    with pytest.raises(ValueError, match="picture"):
        Exchange.model_validate({**dict.fromkeys(Exchange.model_fields, ""), "picture": value})


@pytest.mark.parametrize("value", VALUES.values(), ids=VALUES)
def test_so_does_the_list_of_renders(value, finished: Finished, tmp_path: Path):
    one = {"episode": 0, "look": 0, "ranges": "full", "seed": 0, "file": value, "frames": 1}
    data = {"schema": Renders.SCHEMA, "provenance": {"producer": "render", "seed": 0}, "renders": [one]}
    with pytest.raises(InputFileError, match=r"field renders\.0\.file"):
        Renders.parse(data, tmp_path / "renders.json")


def test_a_compression_that_packed_unread_data_is_refused(finished: Finished, tmp_path: Path):
    data = read_json(finished.run.compression) | {"packed": {"episodes/other.hdf5": "0" * 64}}
    with pytest.raises(InputFileError, match="among the inputs"):
        Compression.parse(data, tmp_path)
