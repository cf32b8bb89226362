"""Add a verb of one's own, "heft": one arm holds an object up for two seconds, and puts it down.

    python examples/04_verb.py [RUN]

RUN (default: runs/heft) gets an episode of it. In a project the goal and the sub-task are a file each, and their names
stand in two lists: docs/adding-a-verb.md shows them, and explains what each field is for.
"""

import sys

import vcage
from vcage.goals import KINDS
from vcage.goals.hands import in_one_hand
from vcage.goals.kind import GoalKind, Shown, too_short
from vcage.stages import collect, inpaint_plan, match, optimize, search_subtasks, select_place
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.templates.set_down import SetDown

HEFTED_S = 1.5


class Heft(SetDown):
    """Set an object down, with a long pause while it is up."""

    def calls(self, subtask):
        pick, *others = super().calls(subtask)
        return [pick, "task.wait(2.0)", *others]


KINDS["hefted"] = GoalKind(
    word="hefted",
    event=True,  # it is done, and not a state that lasts
    happens=lambda goal, state, notes: in_one_hand(goal, state),
    complaint=lambda goal, state: too_short(goal, state, HEFTED_S),
    meaning=lambda limits: f"Hefted: one arm alone held it {limits.lifted_m} m above the table for {HEFTED_S} s.",
    evidence="lifted",  # how the critic without a model judges it
    shown=Shown(customer=True, moment=True, in_the_air=True),
    plain="{thing} was hefted",
    says="heft hefted",
    claims="heft hefted",
    commands="Heft {0}.|Heft {0} in one hand.|Please heft {0}.|Could you heft {0}?|Hold {0} up to feel its weight."
    "|Feel the weight of {0}.|Get {0} hefted.|Have {0} hefted.|Let {0} be hefted.|{1} must be hefted.",
)
TEMPLATES["heft"] = Heft(
    "heft", lambda thing, asked: [g for g in asked if (g.relation, g.subject) == ("hefted", thing.id)]
)

run = vcage.RunFolder(sys.argv[1] if len(sys.argv) > 1 else "runs/heft")
options = vcage.ChainOptions(goals=("block hefted",), models="offline", episodes=1, fps=5, workers=1)
for stage in (select_place, inpaint_plan, match, optimize, search_subtasks, collect):
    result = vcage.run_stage(stage, run, options)
(episode,) = result.record.episodes
print(f"{episode.subtasks[0]}: {'accepted' if episode.accepted else 'rejected'}, {episode.verdicts[0].reason}")
