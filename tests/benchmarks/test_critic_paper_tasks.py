"""Both loops of the paper's tasks are counted on the same episodes."""

from __future__ import annotations

from benchmarks._critic.paper_tasks import EPISODES_PER_SCENE, Ended, TaskDraw, draws, rows
from benchmarks.tasks import TASKS


def test_the_open_loop_takes_what_came_to_its_end_and_the_closed_one_what_the_critic_accepts() -> None:
    given_up = Ended(finished=False, true=False, accepted=False)
    silent_failure = Ended(finished=True, true=False, accepted=False)
    missed = Ended(finished=True, true=True, accepted=False)
    right = Ended(finished=True, true=True, accepted=True)
    some = [given_up, silent_failure, missed, right, right]
    row = rows([(TaskDraw("PickBlocks", 0, 5, "dual_panda", "offline"), some)])[list(TASKS).index("PickBlocks")]
    assert (row["episodes"], row["finished"], row["accepted"]) == (5, 4, 2)
    assert (row["open_loop"], row["closed_loop"], row["kept"]) == (0.75, 1.0, 0.6667)
    assert row["closed_loop_low"] < 1.0


def test_a_task_of_which_nothing_came_to_its_end_has_no_shares() -> None:
    empty = rows([])[0]
    assert (empty["episodes"], empty["open_loop"], empty["closed_loop"], empty["kept"]) == (0, None, None, None)


def test_every_task_of_the_paper_has_as_many_episodes() -> None:
    asked = draws(EPISODES_PER_SCENE + 2, "aloha_agilex", "offline")
    counts = {task: sum(draw.episodes for draw in asked if draw.task == task) for task in TASKS}
    assert set(counts.values()) == {EPISODES_PER_SCENE + 2}
    assert len({(draw.task, draw.seed) for draw in asked}) == len(asked) == 2 * len(TASKS)
