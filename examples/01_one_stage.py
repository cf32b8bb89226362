"""Run one stage by hand: choose objects for an instruction, place them, and read what the stage wrote.

    python examples/01_one_stage.py [RUN]

RUN (default: runs/example) must be a new folder, or a run of this program, which then does nothing. `vcage inpaint-plan
--run RUN` goes on from there.
"""

import sys

import vcage
from vcage.stages import select_place

run = vcage.RunFolder(sys.argv[1] if len(sys.argv) > 1 else "runs/example")
options = select_place.Options(instruction="Put the blocks on the plate", models="offline", seed=3)
result = vcage.run_stage(select_place, run, options)
print(f"{result.path}: {'made now' if result.fresh else 'finished before'}")

scene = result.record  # the same as vcage.Scene.read(run.scene)
for thing in scene.objects:
    x, y, z = thing.pose.position
    print(f"{thing.phrase} ({thing.asset}/{thing.variant}) stands at {x:.2f}, {y:.2f}, {z:.2f} m")
for asked in scene.goals:
    print(f"goal: {asked.goal.subject} {asked.goal.relation} {asked.goal.reference}")
print(f"seen from above: {run.scene.with_name('source.png')}")
