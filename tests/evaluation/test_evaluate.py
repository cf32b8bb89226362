"""Evaluations of policies: what is counted, what is kept, and what is refused."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.evaluation.policy_server import policy_server
from tests.run_folders import Finished, command
from vcage.base.errors import InputFileError, MissingStage, StaleStage, UsageError
from vcage.base.videos import pictures
from vcage.evaluation.comparison import compare, require_shared_seeds
from vcage.evaluation.environment import RunEnv
from vcage.evaluation.environment_options import EnvironmentOptions
from vcage.evaluation.evaluate import RECORD, Amount, actions_file, evaluate, planned
from vcage.evaluation.factors import Factor
from vcage.evaluation.filming import chosen
from vcage.evaluation.policy import PolicyFailed
from vcage.evaluation.rollouts import Order
from vcage.schema.evaluation import Evaluation, Rollout, SeedSplit
from vcage.schema.scene import Scene

BLIND = EnvironmentOptions(pictures=False, max_steps=3)


class Still:
    """A policy that keeps the arms where they are."""

    def reset(self) -> None:
        pass

    def infer(self, observation: Mapping[str, Any]) -> Mapping[str, Any]:
        return {"actions": np.stack([observation["observation/state"]] * 2)}


def order(finished: Finished, policy: str, **changes: Any) -> Order:
    return replace(Order(finished.run.root, policy, BLIND), **changes)


@pytest.mark.slow
def test_the_expert_succeeds_from_starts_that_are_drawn(finished: Finished, tmp_path: Path) -> None:
    patient = replace(BLIND, max_steps=80)
    record = evaluate(order(finished, "expert", environment=patient), Amount(episodes=1), tmp_path)
    facts = record.facts()
    assert (facts["n_success"], facts["pc_success"]) == (1, 100.0)
    assert set(facts["goals"].values()) == {1} and facts["furthest"] == {"done": 1}


@pytest.mark.slow
def test_recorded_actions_succeed_from_their_own_start(finished: Finished, capsys, tmp_path: Path) -> None:
    options = ["--policy", "replay", "--episodes", "1", "--no-pictures", "--out", tmp_path]
    done = command(capsys, "evaluate", finished.run.root, *options)
    assert (done.code, done.record["summary"]["n_success"]) == (0, 1)
    assert Evaluation.read(tmp_path / RECORD).policy == "replay"


def test_a_server_is_asked_and_its_failures_are_counted_once(finished: Finished, tmp_path: Path) -> None:
    with policy_server(Still().infer) as address:
        wanted = order(finished, address, solvable=False)
        evaluate(wanted, Amount(episodes=1), tmp_path)
        first = Evaluation.read(tmp_path / RECORD).rollouts
        record = evaluate(wanted, Amount(episodes=2), tmp_path)  # more of the same
    assert record.rollouts[:1] == first and [r.seed for r in record.rollouts] == [100_000, 100_001]
    assert record.facts()["furthest"] == {"nothing touched": 2} and record.rollouts[0].actions == 3


def test_a_factory_makes_a_policy(finished: Finished, tmp_path: Path) -> None:
    wanted = order(finished, "tests.evaluation.test_evaluate:Still", solvable=False)
    assert evaluate(wanted, Amount(episodes=1), tmp_path).successes == 0


@pytest.mark.slow
def test_what_is_finished_is_kept_when_a_policy_fails(finished: Finished, tmp_path: Path) -> None:
    answers = iter([Still().infer] * 2)

    def breaking(observation: Mapping[str, Any]) -> Mapping[str, Any]:
        return next(answers)(observation) if observation else {}

    with policy_server(breaking) as address, pytest.raises(PolicyFailed, match="StopIteration"):
        evaluate(order(finished, address, solvable=False), Amount(episodes=2), tmp_path)
    assert len(Evaluation.read(tmp_path / RECORD).rollouts) == 1


@pytest.mark.slow
def test_another_evaluation_in_the_same_folder_is_refused(finished: Finished, tmp_path: Path) -> None:
    still = order(finished, "tests.evaluation.test_evaluate:Still", solvable=False)
    evaluate(still, Amount(episodes=1), tmp_path)
    with pytest.raises(StaleStage, match="its execute is 8, not 1"):
        evaluate(replace(still, execute=1), Amount(episodes=1), tmp_path)
    assert len(evaluate(replace(still, execute=1), Amount(episodes=1), tmp_path, force=True).rollouts) == 1


@pytest.mark.slow
def test_a_named_policy_goes_on_at_another_address(finished: Finished, capsys, tmp_path: Path) -> None:
    options = ["--unproven", "--no-pictures", "--max-steps", "3", "--out", tmp_path, "--name"]
    for episodes in (1, 2):
        with policy_server(Still().infer) as address:
            still = ["--policy", address, "--episodes", str(episodes)]
            done = command(capsys, "evaluate", finished.run.root, *still, *options, "still ones")
            assert done.code == 0, done.error
    record = Evaluation.read(tmp_path / RECORD)
    assert (record.policy, len(record.rollouts)) == ("still ones", 2)
    done = command(capsys, "evaluate", finished.run.root, *still, *options, "another")
    assert "its policy is still ones, not another" in done.error["message"]
    assert "or --name 'still ones' if this is the same policy" in done.error["hint"]


def test_a_name_has_a_letter_that_a_folder_can_keep(finished: Finished, capsys) -> None:
    done = command(capsys, "evaluate", finished.run.root, "--policy", "expert", "--name", "..")
    assert done.code == 2 and "'..' is no name" in done.stderr


@pytest.mark.parametrize(
    ("policy", "kind", "complaint"),
    [
        ("no_such_module:make", InputFileError, "no_such_module"),
        ("collections:OrderedDict", InputFileError, "without infer"),
    ],
)
def test_a_policy_that_cannot_be_made_is_named(
    finished: Finished, tmp_path: Path, policy: str, kind: type[Exception], complaint: str
) -> None:
    with pytest.raises(kind, match=complaint):
        evaluate(order(finished, policy, solvable=False), Amount(episodes=1), tmp_path)


def test_more_episodes_than_were_recorded_cannot_be_replayed(finished: Finished, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="has 1 accepted episodes of this task, not 5"):
        evaluate(order(finished, "replay"), Amount(episodes=5), tmp_path)


def rollout(seed: int, success: bool = False, **changes: Any) -> Rollout:
    known = {"instruction": "Put the block on the plate.", "actions": 9, "seconds": 1.0, "collisions": []}
    goals = {"block on plate": success}
    return Rollout(
        **{"seed": seed, "success": success, "goals": goals, "touched": [], "lifted": [], **known, **changes}
    )


def evaluation(rollouts: list[Rollout], left_out: dict[int, str] | None = None, **starts: Any) -> Evaluation:
    return Evaluation(
        policy="p",
        run="r",
        task="Put the block on the plate",
        seeds=SeedSplit(scene=3, stream=2, first=100_000),
        starts={"max_steps": 80, "vary": None, **starts},
        asking={},
        rollouts=rollouts,
        left_out=left_out or {},
    )


def test_shares_have_intervals_and_failures_say_how_far_they_came() -> None:
    rollouts = [rollout(n, n < 9, touched=["block"] if n < 9 else []) for n in range(10)]
    facts = evaluation(rollouts, {17: "the expert fails"}).facts()
    assert (facts["n_episodes"], facts["n_success"], facts["left_out"]) == (10, 9, 1)
    assert facts["pc_success_ci95"] == [59.58, 98.21]  # 59.6 % to 98.2 %: lerobot's own example of 9 in 10
    assert facts["furthest"] == {"done": 9, "nothing touched": 1}


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"success": True}, "done"),
        ({"goals": {"a": True, "b": False}}, "some goals"),
        ({"touched": ["block"], "lifted": ["block"]}, "lifted"),
        ({"touched": ["block"]}, "touched"),
        ({}, "nothing touched"),
    ],
)
def test_an_episode_says_how_far_it_came(changes: dict[str, Any], word: str) -> None:
    assert rollout(1, **changes).furthest == word


def test_two_evaluations_are_compared_where_both_count() -> None:
    ours = evaluation([rollout(n, n < 9) for n in range(12)])
    theirs = evaluation([rollout(n, n in (8, 9, 10)) for n in range(2, 14)], vary="light")
    found = compare(ours, theirs, "light")
    assert (found.n_episodes, found.n_success, found.n_success_other, found.b, found.c) == (10, 7, 3, 6, 2)
    assert found.mcnemar_p == pytest.approx(2 * (1 + 8 + 28) / 2**8)  # by hand, of 8 that differ
    assert found.facts()["pc_success_other"] == 30.0


def test_what_has_other_starts_is_not_compared() -> None:
    ours = evaluation([rollout(1)])
    with pytest.raises(UsageError, match="max_steps is 80 here and 90 there"):
        compare(ours, evaluation([rollout(1)], max_steps=90), "other")
    with pytest.raises(UsageError, match="share no start"):
        compare(ours, evaluation([rollout(2)]), "other")


def test_evaluations_that_will_share_no_start_are_refused_before_they_are_made() -> None:
    other = evaluation([rollout(100_004)])
    require_shared_seeds(other, 100_000, 5)
    for first, episodes in ((100_000, 4), (100_005, 50)):
        with pytest.raises(UsageError, match="share no start") as caught:
            require_shared_seeds(other, first, episodes)
        assert caught.value.hint.endswith("--first-seed 100000")


def test_starts_that_were_left_out_have_others_in_their_place() -> None:
    other = evaluation([rollout(100_004)]).model_copy(update={"left_out": dict.fromkeys(range(100_000, 100_004), "")})
    require_shared_seeds(other, 100_000, 1)
    with pytest.raises(UsageError, match="share no start"):
        require_shared_seeds(other, 100_005, 1)


def test_videos_show_failures_of_every_kind_and_some_successes() -> None:
    lifted = [rollout(n, touched=["a"], lifted=["a"]) for n in range(6)]
    record = evaluation([*lifted, rollout(6), rollout(7, True), rollout(8, True)])
    assert [one.seed for one in chosen(record, 4)] == [0, 1, 6, 7]
    assert [one.seed for one in chosen(record, 20)] == list(range(9))
    assert chosen(record, 0) == []


@pytest.mark.slow
@pytest.mark.parametrize("factor", ["light", "camera", "colour"])
def test_a_factor_of_the_look_changes_nothing_else(finished: Finished, factor: Factor) -> None:
    plain, other = (RunEnv(finished.run.root, replace(BLIND, vary=vary), finished.context) for vary in (None, factor))
    begun = []
    for env in (plain, other):
        env.reset(seed=4)
        assert env._episode is not None
        begun.append(env._episode.start)
    looks = [start.drawn.look.model_dump() for start in begun]
    changed = {name for name in looks[0] if looks[0][name] != looks[1][name]}
    assert changed == set({"light": ["lights", "ambient"], "camera": ["cameras"], "colour": ["tints"]}[factor])
    assert begun[0].scene == begun[1].scene and begun[0].sentence == begun[1].sentence


@pytest.mark.slow
def test_factors_of_the_world_are_drawn_more_widely(finished: Finished) -> None:
    clutter = RunEnv(finished.run.root, replace(BLIND, vary="clutter"), finished.context)
    counts = []
    for seed in range(3):
        clutter.reset(seed=seed)
        assert clutter._episode is not None
        counts.append(len(clutter._episode.start.drawn.world.clutter))
    assert max(counts) > 0
    fixed = RunEnv(finished.run.root, replace(BLIND, vary="layout"), finished.context)
    fixed.reset(seed=1)
    assert fixed._episode is not None
    found = {o.id: o.pose.position for o in fixed._episode.start.scene.objects}
    optimised = {o.id: o.pose.position for o in Scene.read(finished.run.layout).objects}
    assert all(np.allclose(found[name][:2], place[:2], atol=0.05) for name, place in optimised.items())


def test_a_factor_that_is_drawn_as_widely_already_is_refused(finished: Finished) -> None:
    with pytest.raises(UsageError, match="the light as widely as 'full'"):
        RunEnv(finished.run.root, replace(BLIND, randomise="full", vary="light"), finished.context)


@pytest.mark.slow
def test_a_page_shows_videos_of_what_was_done(finished: Finished, capsys, tmp_path: Path) -> None:
    expert = ["--policy", "expert", "--episodes", "1", "--no-pictures", "--out", tmp_path / "expert"]
    assert command(capsys, "evaluate", finished.run.root, *expert, "--max-steps", "80").code == 0
    still = ["--policy", "tests.evaluation.test_evaluate:Still", "--episodes", "1", "--no-pictures", "--out", tmp_path]
    more = ["--max-steps", "80", "--against", tmp_path / "expert", "--vary", "height", "--videos", "1"]
    done = command(capsys, "evaluate", finished.run.root, *still, *more)
    assert done.code == 0, done.stderr
    compared = done.record["summary"]["compared"]
    assert [(one["n_success"], one["n_success_other"], one["c"]) for one in compared] == [(0, 0, 0), (0, 1, 1)]
    page = (tmp_path / "report.html").read_text()
    assert 'src="data:video/mp4;base64,' in page and "nothing touched" in page and "vary-height/report.html" in page
    seed = next((tmp_path / "videos").glob("*.mp4")).stem
    frames = list(pictures(tmp_path / "videos" / f"{seed}.mp4"))
    assert len(frames) == 81 and frames[0].std() > 10
    shown = list(pictures(tmp_path / "expert/videos" / f"{seed}.mp4"))
    assert np.abs(shown[-1].astype(int) - shown[0]).max() > 50


@pytest.mark.parametrize(
    ("changes", "code", "complaint"),
    [
        (["--cameras", "cam_low"], 2, "cam_low"),
        (["--task", "7"], 2, "chain"),
        (["--payload", "aloha"], 2, "needs pictures of cam_high"),
        (["--against", "nowhere"], 3, "nowhere"),
        (["--vary", "height", "light"], 2, "the factor light changes only pictures"),
        (["--cameras", "cam_high", "--no-pictures"], 2, "--no-pictures observes none"),
    ],
)
def test_an_evaluation_that_cannot_be_made_is_named(
    finished: Finished, capsys, tmp_path: Path, changes: list[str], code: int, complaint: str
) -> None:
    still = ["--policy", "tests.evaluation.test_evaluate:Still", "--unproven", "--episodes", "1", "--out", tmp_path]
    pictures = [] if "--cameras" in changes else ["--no-pictures"]
    done = command(capsys, "evaluate", finished.run.root, *still, *pictures, *changes)
    assert (done.code, complaint in done.error["message"]) == (code, True), done.error


class Breaks:
    """A policy that raises an error."""

    def infer(self, _observation: Mapping[str, Any]) -> Mapping[str, Any]:
        raise RuntimeError("no weights")


class Ends:
    """A policy that would end the process."""

    def infer(self, _observation: Mapping[str, Any]) -> Mapping[str, Any]:
        sys.exit("out of memory")


def test_an_error_of_a_policy_is_told_with_its_traceback(finished: Finished, capsys, tmp_path: Path) -> None:
    options = ["--policy", "tests.evaluation.test_evaluate:Breaks", "--no-pictures", "--out", tmp_path]
    done = command(capsys, "evaluate", finished.run.root, *options)
    assert (done.code, done.error["code"]) == (5, "policy_failed")
    assert "raises RuntimeError: no weights" in done.error["message"]
    assert "Traceback" in done.error["details"]["traceback"]
    assert "it was sent observation/state, prompt" in done.error["hint"]


def test_a_policy_that_exits_is_reported_as_failed(finished: Finished, tmp_path: Path) -> None:
    ends = order(finished, "tests.evaluation.test_evaluate:Ends", solvable=False)
    with pytest.raises(PolicyFailed, match="raises SystemExit: out of memory"):
        evaluate(ends, Amount(episodes=1), tmp_path)


def test_a_word_that_names_no_policy_is_refused_before_the_scenes_are_read(tmp_path: Path) -> None:
    for word in ("pi0", "http://127.0.0.1:8000"):
        with pytest.raises(UsageError, match=word):
            planned(Order(tmp_path / "no run", word), Amount())


@pytest.mark.slow
def test_starts_from_which_the_expert_fails_are_left_out_and_others_take_their_place(
    finished: Finished, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(env: RunEnv) -> SimpleNamespace:
        assert env._episode is not None
        return SimpleNamespace(accepted=env._episode.start.origin["seed"] % 2 == 1, reason="it slipped")

    monkeypatch.setattr(RunEnv, "expert", fails)
    record = evaluate(order(finished, "tests.evaluation.test_evaluate:Still"), Amount(episodes=2), tmp_path)
    assert [one.seed for one in record.rollouts] == [100_001, 100_003]
    assert record.left_out == {100_000: "the expert fails: it slipped", 100_002: "the expert fails: it slipped"}
    again = evaluate(order(finished, "tests.evaluation.test_evaluate:Still"), Amount(episodes=2), tmp_path)
    assert again == record == Evaluation.read(tmp_path / RECORD)


@pytest.mark.slow
def test_a_run_without_a_start_that_the_expert_solves_is_given_up(
    finished: Finished, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(RunEnv, "expert", lambda _env: SimpleNamespace(accepted=False, reason="it slipped"))
    with pytest.raises(MissingStage, match="none of 2 starts is counted; the last: the expert fails: it slipped"):
        still = order(finished, "tests.evaluation.test_evaluate:Still")
        evaluate(still, Amount(episodes=2, most_left_out=2), tmp_path)


@pytest.mark.slow
def test_processes_count_the_same_starts_with_the_same_outcome(finished: Finished, tmp_path: Path) -> None:
    still = order(finished, "tests.evaluation.test_evaluate:Still")
    one, two = (evaluate(still, Amount(episodes=3), tmp_path / str(n), workers=n) for n in (1, 2))
    assert one == two


@pytest.mark.slow
def test_the_actions_of_an_episode_give_it_again(finished: Finished, tmp_path: Path) -> None:
    patient = replace(BLIND, max_steps=80)
    done = evaluate(order(finished, "expert", environment=patient), Amount(episodes=1), tmp_path).rollouts[0]
    env = RunEnv(finished.run.root, patient, finished.context)
    env.reset(seed=done.seed)
    for action in np.load(actions_file(tmp_path, done.seed)):
        success, _, info = env.act(action)
    assert success and (info["seconds"], info["goals"]) == (done.seconds, done.goals)
