"""Episodes of LeRobot data sets that never succeeded: named, and left out of rewritten data sets."""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.datasets.packing.orders import settings
from vcage.base.errors import DamagedFile
from vcage.datasets.packing.inspecting import inspect, totals
from vcage.datasets.packing.output import OutputSpec
from vcage.datasets.packing.pack import Order, pack, prepare

NEVER = "its next.success is never true"
BOTH = ("episode_000000", "episode_000001")


@pytest.fixture(params=["v2.0", "v2.1", "v3.0"])
def dataset(request, v21, v3, tmp_path) -> Path:
    return shutil.copytree(v3 if request.param == "v3.0" else v21, tmp_path / request.param)


def labelled(root: Path, labels: Sequence[Any]) -> Path:
    """The data set with these labels in the last row of its episodes, and false ones in the others."""
    info = json.loads((root / "meta/info.json").read_text())
    if root.name == "v2.0":
        info["codebase_version"] = root.name
    info["features"]["next.success"] = {"dtype": "bool", "shape": [1], "names": None}
    (root / "meta/info.json").write_text(json.dumps(info))
    for file in (root / "data").rglob("*.parquet"):
        table = pq.read_table(file)
        numbers = np.array(table["episode_index"])
        none = type(labels[0])([0]) if isinstance(labels[0], list) else type(labels[0])(0)
        values = [
            labels[number] if row == np.flatnonzero(numbers == number)[-1] else none
            for row, number in enumerate(numbers)
        ]
        pq.write_table(table.append_column("next.success", pa.array(values)), file)
    return root


def order(root: Path, target: str | None) -> Order:
    return Order(root, root.parent / "out", settings(), OutputSpec(target), ("cam_high",))


@pytest.mark.parametrize("labels", [(True, False), (1, 0), (1.0, 0.0), ([1], [0])], ids=repr)
def test_an_episode_without_success_is_left_out_of_another_version_and_named(dataset, labels):
    root = labelled(dataset, labels)
    work = prepare(order(root, "lerobot-v2.1" if root.name == "v3.0" else "lerobot-v3.0"))
    assert work.sources.failed == {BOTH[1]: NEVER}
    assert [source.name for source in work.sources.sources] == [BOTH[0]]
    assert totals(inspect(root))["failed"] == {"count": 1, "recordings": [f"{root} episode 1"]}


@pytest.mark.parametrize("stated", [True, False])
def test_the_same_version_keeps_all_episodes_and_names_the_failed_ones(dataset, stated):
    root = labelled(dataset, (True, False))
    work = prepare(order(root, f"lerobot-{root.name}" if stated else None))
    assert [source.name for source in work.sources.sources] == list(BOTH)
    assert work.sources.failures() == {BOTH[1]: NEVER}


def test_a_column_that_is_never_true_counts_as_not_recorded(dataset):
    root = labelled(dataset, (False, False))
    work = prepare(order(root, "lerobot-v2.1" if root.name == "v3.0" else "lerobot-v3.0"))
    assert [source.name for source in work.sources.sources] == list(BOTH)
    assert not work.sources.failed and not work.sources.failures()
    assert all("nobody seems to have recorded" in str(source.notes) for source in work.sources.sources)


def test_scores_are_noted_and_refused_only_where_another_version_must_know_the_failures(dataset):
    root = labelled(dataset, (1.0, 0.8))
    kept = prepare(order(root, None)).sources
    assert "next.success is 0.8, which says neither true nor false" in kept.sources[1].notes
    assert totals(inspect(root))["damaged"] == {}
    other = order(root, "lerobot-v2.1" if root.name == "v3.0" else "lerobot-v3.0")
    with pytest.raises(DamagedFile, match=r"episode 1, .*next\.success is 0\.8"):
        prepare(other)
    assert list(prepare(replace(other, skip_damaged=True)).sources.damaged) == [BOTH[1]]


def test_the_record_names_the_failed_episodes_that_were_left_out(v21, tmp_path):
    root = labelled(shutil.copytree(v21, tmp_path / "v2.1"), (False, True))
    done = pack(order(root, "lerobot-v3.0"), workers=1)
    assert done.record.failed == {BOTH[0]: NEVER}
    assert json.loads((tmp_path / "out/meta/info.json").read_text())["total_episodes"] == 1
