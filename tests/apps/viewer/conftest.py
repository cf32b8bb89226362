"""Rerun recordings read back, and an episode whose scene is known."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
import rerun.dataframe as rd

from tests.example_scenes import block_and_plate, robot, scene_of
from tests.recordings import episode, written

FRAMES = 12


class ReadBack:
    """A ``.rrd`` file, read with Rerun's own reader."""

    def __init__(self, path: Path):
        self._recording = rd.load_recording(path)
        columns = [(c.entity_path, c.component_name) for c in self._recording.schema().component_columns()]
        self.components = {
            entity: {name.split(".")[-1] for other, name in columns if other == entity} for entity, _ in columns
        }
        """Entity → what is said of it."""

    def under(self, parent: str) -> set[str]:
        """Names of the entities right below one."""
        inside = [entity.removeprefix(f"{parent}/") for entity in self.components if entity.startswith(f"{parent}/")]
        return {path.split("/")[0] for path in inside}

    def rows(self, entity: str, component: str, index: str = "timestep") -> dict[Any, Any]:
        """Index of a frame, or nanoseconds on the timeline ``time``, → value."""
        if index not in [column.name for column in self._recording.schema().index_columns()]:
            return {}
        table = self._recording.view(index=index, contents=entity).select().read_all()
        times = table[index].cast(pa.int64()).to_pylist()
        values = table[f"{entity}:{component}"].to_pylist()
        return {time: value[0] for time, value in zip(times, values, strict=True) if value}

    def fixed(self, entity: str, component: str) -> Any:
        """The components that hold at all times."""
        table = self._recording.view(index="timestep", contents=entity).select_static().read_all()
        return table[f"{entity}:{component}"].to_pylist()[0][0]


def meta(**changes: Any) -> dict[str, Any]:
    """The facts of an episode whose scene is a block and a plate of the library."""
    scene = scene_of(block_and_plate()).model_dump(mode="json", by_alias=True)
    return {**episode(1).meta, "scene": scene, **changes}


@pytest.fixture(scope="session")
def episode_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An episode of :data:`FRAMES` frames, whose robot has the joints of ``dual_panda``."""
    states = {"left": [*robot().arms["left"].home, 0.5], "right": [*robot().arms["right"].home, 1.0]}
    names = [f"{arm}_{n}" for arm in states for n in (*(f"joint_{i}" for i in range(1, 8)), "gripper")]
    values = np.tile([*states["left"], *states["right"]], (FRAMES, 1))
    changes = {"state_names": names, "qpos": values, "action": values + 0.01, "qvel": np.zeros_like(values)}
    return written(tmp_path_factory.mktemp("episode") / "episode.hdf5", FRAMES, meta=meta(), **changes)


@pytest.fixture(scope="session")
def other_robot_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An episode of a robot with fewer joints than its name suggests, in a scene known by names only."""
    return written(tmp_path_factory.mktemp("episode") / "episode.hdf5", 4)
