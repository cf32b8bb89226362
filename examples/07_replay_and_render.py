"""Replay and re-render: simulate recorded episodes again from their files, then draw them under other looks.

    python examples/07_replay_and_render.py [RUN]

RUN (default: runs/blocks, which examples/02_chain.py makes) has accepted episodes. A replay is equal bit for bit, or
says which frame differs. Drawing simulates nothing: light, surfaces, colours and cameras change, states stay.
"""

import sys

import vcage
from vcage.episodes.rendering import Order, render_run
from vcage.sim.robots import load_randomisation

run = vcage.RunFolder(sys.argv[1] if len(sys.argv) > 1 else "runs/blocks")
context = vcage.StageContext("offline")

for episode in vcage.Episodes.read(run.episodes).episodes:
    if episode.accepted and episode.file:
        replayed = vcage.replay_episode(run.root / episode.file, context)
        print(f"{episode.file}: {'equal' if replayed.equal else replayed.states}, pictures {replayed.pictures}")

drawn = render_run(run, Order(looks=1, ranges=load_randomisation("light"), seed=0))
for render in drawn.renders:
    print(f"{run.root / render.file}: {render.frames} frames of episode {render.episode}")
