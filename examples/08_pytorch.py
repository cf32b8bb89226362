"""Load an exported data set in PyTorch: LeRobot v2.1, whose episodes are a table and a video per camera each.

    python examples/08_pytorch.py [DATASET]

DATASET (default: runs/blocks/export/lerobot-v2.1, which examples/02_chain.py makes) needs neither V-CAGE nor lerobot to
be read. With lerobot 0.4 or later, LeRobotDataset("blocks", root="runs/blocks/export/lerobot-v3.0") does the same.
"""

import json
import sys
from pathlib import Path

import av
import numpy as np
import pyarrow.parquet as parquet
import torch
from torch.utils.data import ConcatDataset, DataLoader, Dataset


class Episode(Dataset):
    """The frames of one episode: state, action, task and one camera's picture, (3, H, W) from 0 to 1."""

    def __init__(self, root: Path, number: int, camera: str, tasks: dict[int, str]):
        info = json.loads((root / "meta/info.json").read_text())
        where = {"episode_chunk": number // info["chunks_size"], "episode_index": number, "video_key": camera}
        table = parquet.read_table(root / info["data_path"].format(**where))
        self.state = torch.tensor(np.stack(table["observation.state"].to_numpy()))
        self.action = torch.tensor(np.stack(table["action"].to_numpy()))
        self.task = [tasks[number] for number in table["task_index"].to_pylist()]
        with av.open(str(root / info["video_path"].format(**where))) as video:
            self.pictures = [frame.to_ndarray(format="rgb24") for frame in video.decode(video=0)]

    def __len__(self) -> int:
        return len(self.action)

    def __getitem__(self, index: int) -> dict[str, torch.Tensor | str]:
        picture = torch.from_numpy(self.pictures[index]).permute(2, 0, 1) / 255
        return {"picture": picture, "state": self.state[index], "action": self.action[index], "task": self.task[index]}


root = Path(sys.argv[1] if len(sys.argv) > 1 else "runs/blocks/export/lerobot-v2.1")
lines = [json.loads(line) for line in (root / "meta/tasks.jsonl").read_text().splitlines()]
tasks = {line["task_index"]: line["task"] for line in lines}
count = json.loads((root / "meta/info.json").read_text())["total_episodes"]
frames = ConcatDataset([Episode(root, index, "observation.images.cam_high", tasks) for index in range(count)])

batch = next(iter(DataLoader(frames, batch_size=4, shuffle=True)))
print(f"{len(frames)} frames of {count} episodes")
for name in ("picture", "state", "action"):
    print(name, tuple(batch[name].shape))
print("task:", batch["task"][0])
