"""Add a verb of one's own, "lift": one arm holds an object above the table for a moment, and puts it down.

    python examples/04_verb.py [RUN]

RUN (default: runs/lift) gets an episode of it. In a project the goal and the sub-task are a file each, and their names
stand in two lists: docs/adding-a-verb.md shows them, and explains what each field is for.
"""

import sys

import vcage
from vcage.goals import KINDS
from vcage.goals.kind import GoalKind, Shown, too_short
from vcage.stages import collect, inpaint_plan, match, optimize, search_subtasks, select_place
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.templates.set_down import SetDown

LIFTED_S, HEIGHT_M = 0.4, 0.03


def is_lifted(goal, state, notes):
    """True while one arm alone holds the object high enough."""
    holders = state.touching(goal.subject)
    high = state.thing(goal.subject).lowest - state.table_height >= HEIGHT_M
    return high and len(holders) == 1 and holders <= {*state.arms}


class Lift(SetDown):
    """Set an object down, with a pause while it is up."""

    def calls(self, subtask):
        pick, *others = super().calls(subtask)
        return [pick, "task.wait(0.5)", *others]


KINDS["lifted"] = GoalKind(
    word="lifted",
    event=True,  # it is done, and not a state that lasts
    happens=is_lifted,
    complaint=lambda goal, state: too_short(goal, state, LIFTED_S),
    meaning=lambda limits: f"Lifted: one arm alone held it {HEIGHT_M} m above the table for {LIFTED_S} s.",
    evidence="lifted",  # how the critic without a model judges it
    shown=Shown(moment=True),
    plain="{thing} was lifted",
    says="lift lifted raise",
    claims="lift lifted raise",
    commands="Lift {0}.|Lift {0} up.|Raise {0}.|Raise {0} above the table.|Please lift {0}.|Could you lift {0}?"
    "|Get {0} lifted.|Have {0} lifted.|Let {0} be lifted.|{1} must be lifted.",
)
TEMPLATES["lift"] = Lift(
    "lift", lambda thing, asked: [g for g in asked if (g.relation, g.subject) == ("lifted", thing.id)]
)

run = vcage.RunFolder(sys.argv[1] if len(sys.argv) > 1 else "runs/lift")
options = vcage.ChainOptions(goals=("block lifted",), models="offline", episodes=1, fps=5, workers=1)
for stage in (select_place, inpaint_plan, match, optimize, search_subtasks, collect):
    result = vcage.run_stage(stage, run, options)
(episode,) = result.record.episodes
print(f"{episode.subtasks[0]}: {'accepted' if episode.accepted else 'rejected'}, {episode.verdicts[0].reason}")
