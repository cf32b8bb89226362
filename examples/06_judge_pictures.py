"""Judge pictures: ask the critic whether a sub-task of a run was done, from a view before and one after it.

    python examples/06_judge_pictures.py [RUN] [BEFORE AFTER]

RUN (default: runs/blocks, which examples/02_chain.py makes) has the scene and its sub-tasks. BEFORE and AFTER are
pictures of its top camera; without them the program takes what the critic saw of the first sub-task, in both orders.
"""

import sys
from pathlib import Path

import vcage

run = vcage.RunFolder(sys.argv[1] if len(sys.argv) > 1 else "runs/blocks")
context = vcage.StageContext("offline")  # or "gemini", "openai", "anthropic", "ollama": who judges

collected = vcage.Episodes.read(run.episodes)
episode = collected.episodes[0]
subtask, verdict = episode.subtasks[0], episode.verdicts[0]
print(f"while collecting, the critic said of {subtask}: {verdict.reason}")

before, after = (run.episodes.parent / name for name in verdict.pictures if name.endswith("-top.png"))
if len(sys.argv) > 3:
    before, after = Path(sys.argv[2]), Path(sys.argv[3])

for first, second in ((before, after), (after, before)):
    found = vcage.judge_pair(run, context, subtask, first, second).verdict
    print(f"{first.name} → {second.name}: {'done' if found.accepted else 'not done'}, {found.reason}")
