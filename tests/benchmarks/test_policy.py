"""The policy of the policy benchmark: frames of hands, inverse kinematics, and a training."""

from __future__ import annotations

import sys
from contextlib import nullcontext
from copy import copy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from benchmarks import policy
from benchmarks._policy.collected import Task
from benchmarks._policy.demonstrations import Demonstrations
from benchmarks._policy.features import ObjectPoses, Objects, Seen, moved_with_objects, poses_of, seen_by, targets_of
from benchmarks._policy.fitting import fit
from benchmarks._policy.grip import carried, compensated, held
from benchmarks._policy.hands import HandPoses, Hands
from benchmarks._policy.localiser import LocaliserTraining, View, missed_by, places_in_pictures, trained_localiser
from benchmarks._policy.network import Size
from benchmarks._policy.policy import Meaning, Policy, Scale
from benchmarks._policy.steps import Progress, Steps
from benchmarks._policy.training import Noise, Training, trained, turned
from vcage.base.errors import UsageError, VcageError
from vcage.base.files import RunFolder
from vcage.sim.cameras import placed
from vcage.sim.kinematics import kinematics_of
from vcage.sim.robots import load_robot

ROBOT = "dual_panda"


def names_of_state() -> tuple[str, ...]:
    arms = sorted(load_robot(ROBOT).arms.items())
    return tuple(
        n for arm, a in arms for n in (*(f"{arm}_joint_{j + 1}" for j in range(len(a.joints))), f"{arm}_gripper")
    )


def state_near_home(rng: np.random.Generator, spread_rad: float = 0.2) -> np.ndarray:
    arms = [kinematics_of(arm) for _, arm in sorted(load_robot(ROBOT).arms.items())]
    parts = []
    for arm in arms:
        joints = arm.home + rng.uniform(-spread_rad, spread_rad, len(arm.home))
        parts += [np.clip(joints, arm.lower + 0.05, arm.upper - 0.05), [rng.uniform()]]
    return np.concatenate(parts)


def demonstrations(episodes: int = 2, frames: int = 20) -> Demonstrations:
    """Arms that wander, and a block that stands."""
    rng = np.random.default_rng(3)
    names = names_of_state()
    ways = [
        np.linspace(0, 1, frames + 1)[:, None] * (state_near_home(rng) - (first := state_near_home(rng))) + first
        for _ in range(episodes)
    ]
    return Demonstrations(
        states=np.concatenate([way[:-1] for way in ways]),
        objects=np.tile([0.0, 0.1, 0.75, 1, 0, 0, 0, 1, 0], (episodes * frames, 1)),
        actions=np.concatenate([way[1:] for way in ways]),
        steps=np.zeros(episodes * frames, np.int64),
        ends=np.arange(1, episodes + 1) * frames,
        names=names,
        object_names=tuple(f"block.{n}" for n in ("x", "y", "z", "r11", "r21", "r31", "r12", "r22", "r32")),
    )


def hands_of(states: np.ndarray) -> HandPoses:
    return Hands(ROBOT, names_of_state()).poses(states)


def test_targets_lead_from_a_pose_to_the_next_poses() -> None:
    rng = np.random.default_rng(0)
    states = np.stack([state_near_home(rng) for _ in range(5)])
    now, future = hands_of(states[:1]), hands_of(states[1:])
    told = targets_of(now, HandPoses(future.position[None], future.rotation[None], future.opening[None]))
    back = poses_of(told[0], now)
    assert torch.allclose(back.position, future.position, atol=1e-5)
    assert torch.allclose(back.rotation, future.rotation, atol=1e-5)
    assert torch.equal(back.opening, future.opening)


def test_inverse_kinematics_finds_the_poses_of_a_way() -> None:
    rng = np.random.default_rng(1)
    first, last = state_near_home(rng), state_near_home(rng)
    way = hands_of(np.linspace(first, last, 12)[1:])
    found = hands_of(Hands(ROBOT, names_of_state()).states(way, first))
    assert float((found.position - way.position).norm(dim=-1).max()) < 1e-3
    assert float((found.rotation - way.rotation).abs().max()) < 5e-3
    assert torch.allclose(found.opening, way.opening, atol=1e-6)


def test_a_pose_out_of_reach_leaves_the_joints_within_their_limits() -> None:
    state = state_near_home(np.random.default_rng(2))
    there = hands_of(state[None])
    far = HandPoses(there.position + 3.0, there.rotation, there.opening)
    joints = Hands(ROBOT, names_of_state()).states(far, state)[0]
    first = 0
    for _, record in sorted(load_robot(ROBOT).arms.items()):
        arm = kinematics_of(record)
        part = joints[first : first + len(arm.home)]
        assert np.all(part >= arm.lower) and np.all(part <= arm.upper)
        first += len(arm.home) + 1


def test_what_a_hand_sees_does_not_depend_on_where_both_are() -> None:
    state = state_near_home(np.random.default_rng(4))
    hands = hands_of(state[None])
    objects = ObjectPoses(torch.tensor([[[0.1, 0.2, 0.75]]]), torch.eye(3)[None, None, :2], torch.zeros(1, 0))
    turn = torch.tensor([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    shift = torch.tensor([0.3, -0.2, 0.0])
    moved = HandPoses(hands.position @ turn.T + shift, turn @ hands.rotation, hands.opening)
    carried = ObjectPoses(objects.position @ turn.T + shift, objects.axes @ turn.T, objects.parts)
    there, here = seen_by(hands, objects, 1), seen_by(moved, carried, 1)
    assert torch.allclose(there.features, here.features, atol=1e-4)
    assert torch.allclose(there.places, here.places, atol=1e-5) and torch.allclose(there.axes, here.axes, atol=1e-5)


def test_a_target_moves_and_turns_with_an_object() -> None:
    hands = hands_of(state_near_home(np.random.default_rng(6))[None])
    block = ObjectPoses(torch.tensor([[[0.1, 0.2, 0.75]]]), torch.eye(3)[None, None, :2], torch.zeros(1, 0))
    seen = seen_by(hands, block, 1)
    weights = torch.zeros(1, 1, 1, 2, 7)
    weights[..., 0] = 1  # of the place; then two of axes for the position, and two for each column of the rotation
    weights[..., 1] = 2
    weights[..., 3] = weights[..., 6] = 1
    target = poses_of(moved_with_objects(torch.zeros(1, 1, 1, 2, 10), weights, seen)[0, 0], hands)
    assert torch.allclose(target.position, torch.tensor([0.12, 0.2, 0.75]).expand(1, 2, 3), atol=1e-5)
    assert torch.allclose(target.rotation, torch.eye(3).expand(1, 2, 3, 3), atol=1e-5)


def test_aims_are_the_next_marked_frames_or_the_last_of_the_episode() -> None:
    marked = np.zeros(20, bool)
    marked[[3, 12]] = True
    assert demonstrations(2, 10).next_of(marked).tolist() == [3] * 4 + [9] * 6 + [12] * 3 + [19] * 7


@pytest.mark.slow
def test_a_policy_stays_with_its_aim_where_another_is_as_good() -> None:
    data = demonstrations()
    meaning = Meaning(ROBOT, data.names, data.object_names, (("block",),))
    policy = trained(data, meaning, Training(steps=5, batch=8, size=Size(chunk=2, width=8, layers=1, aims=2)))
    left, right = torch.zeros(2, 10), torch.zeros(2, 10)
    left[:, 0], right[:, 0] = -0.1, 0.1
    scores = torch.tensor([[0.0, 1.0]])
    went = []
    policy.aims = lambda _: (torch.stack([left, right])[None], scores)  # type: ignore[method-assign]

    def chunks(_seen: Seen, aims: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        went.append(float(aims[0, 0, 0]))
        return torch.zeros(1, 1, 2, 2, 10), torch.zeros(1, 1)

    policy.chunks = chunks  # type: ignore[method-assign]
    hands, seen = (
        hands_of(data.states[:1]),
        seen_by(hands_of(data.states[:1]), policy.objects.poses(data.objects[:1]), 1),
    )
    begun = copy(policy)
    policy.chosen(hands, seen)
    scores[0, 0] = 2.0  # by less than the preference for the last aim
    policy.chosen(hands, seen)
    copy(begun).chosen(hands, seen)
    assert np.allclose(went, [0.1, 0.1, -0.1])


def test_objects_that_the_task_is_not_about_are_not_seen() -> None:
    names = [f"{o}.{n}" for o in ("block", "lemon") for n in ("x", "y", "z", "r11", "r21", "r31", "r12", "r22", "r32")]
    numbers = np.arange(18.0)[None]
    found = Objects(names, {"lemon"}).poses(numbers)
    assert found.position.tolist() == [[[9.0, 10.0, 11.0]]]
    assert found.axes.tolist() == [[[[12.0, 13.0, 14.0], [15.0, 16.0, 17.0]]]]


def test_noise_moves_a_share_of_the_hands_and_keeps_rotations() -> None:
    torch.manual_seed(0)
    hands = hands_of(np.tile(state_near_home(np.random.default_rng(5)), (2000, 1)))
    noisy = Noise(share=0.5, random_opening=0.0).added(hands)
    moved = (noisy.position - hands.position).abs().amax(dim=(1, 2)) > 0
    assert 0.45 < float(moved.float().mean()) < 0.55
    unit = noisy.rotation @ noisy.rotation.transpose(-1, -2)
    assert torch.allclose(unit, torch.eye(3).expand_as(unit), atol=1e-5)


def test_a_hand_holds_what_keeps_its_place_in_it() -> None:
    hands = hands_of(state_near_home(np.random.default_rng(7))[None].repeat(2, axis=0))
    hands = HandPoses(hands.position + torch.tensor([[[0.0]], [[0.02]]]), hands.rotation, hands.opening)
    at = hands.position[:, 0] + torch.tensor([0.0, 0.0, 0.02])
    still = at[:1].expand(2, 3)
    objects = ObjectPoses(torch.stack([at, still, at + 0.3], dim=1), torch.zeros(2, 3, 0, 3), torch.zeros(2, 0))
    may = torch.ones(2, 2, 3, dtype=torch.bool)
    found = held(hands, objects, torch.tensor([1, 1]), may)
    assert found[0].tolist() == [[True, False, False], [False, False, False]]
    assert not held(hands, objects, torch.tensor([1, 1]), ~may).any()


def test_a_share_of_the_chosen_objects_is_turned() -> None:
    torch.manual_seed(0)
    objects = ObjectPoses(torch.zeros(1000, 2, 3), torch.eye(3)[:2].expand(1000, 2, 2, 3), torch.zeros(1000, 0))
    found = turned(objects, torch.tensor([True, False]), 0.3).axes
    changed = (found != objects.axes).any(dim=(2, 3)).float().mean(dim=0)
    assert 0.25 < float(changed[0]) < 0.35 and float(changed[1]) == 0
    products = found @ found.transpose(-1, -2)
    assert torch.allclose(products, torch.eye(2).expand_as(products), atol=1e-5)


def test_what_is_put_somewhere_may_be_turned_but_no_place_may() -> None:
    steps = Steps((("block", "box"), ("box", "shelf"), ("lid",)), ("block", "box", "lid", "shelf"))
    assert steps.only_moved().tolist() == [True, False, False, False]


def test_a_held_object_moves_with_the_noise_of_its_hand_and_comes_to_the_same_place() -> None:
    torch.manual_seed(0)
    rng = np.random.default_rng(8)
    before, future = (hands_of(np.stack([state_near_home(rng) for _ in range(4)])) for _ in range(2))
    future = HandPoses(future.position[:, None], future.rotation[:, None], future.opening[:, None])
    objects = ObjectPoses(before.position + 0.02, torch.eye(3)[:2].expand(4, 2, 2, 3), torch.zeros(4, 0))
    holds = torch.tensor([[True, False], [False, False]]).expand(4, 2, 2)
    after, slips = Noise(share=1.0).added(before), 0.01 * torch.randn(4, 2, 3)
    moved = carried(objects, holds, before, after, slips)

    def brought(at: HandPoses, found: ObjectPoses, to: HandPoses) -> torch.Tensor:
        """Where the first hand brings the first object, and how turned."""
        turn = to.rotation[:, 0, 0] @ at.rotation[:, 0].transpose(-1, -2)
        vectors = torch.cat([(found.position[:, :1] - at.position[:, :1]), found.axes[:, 0]], dim=1)
        return torch.einsum("nij,nvj->nvi", turn, vectors) + to.position[:, 0, :1] * torch.tensor([[1.0], [0], [0]])

    wanted = brought(before, objects, future)
    assert torch.allclose(brought(after, moved, compensated(future, slips)), wanted, atol=1e-5)
    assert not torch.allclose(brought(after, moved, future), wanted, atol=1e-3)
    assert torch.equal(moved.position[:, 1], objects.position[:, 1])


def test_objects_that_a_sub_task_is_not_about_are_blurred() -> None:
    steps = Steps([("red", "plate"), ("green", "plate")], ["green", "plate", "red"])
    others = steps.others(torch.tensor([0, 1]))
    assert others.tolist() == [[True, False, False], [False, False, True]]
    objects = ObjectPoses(torch.zeros(2, 3, 3), torch.zeros(2, 3, 0, 3), torch.zeros(2, 0))
    moved = Noise(other_m=0.1).blurred(objects, others).position.abs().amax(dim=2) > 0
    assert torch.equal(moved, others)


def test_the_objects_of_the_next_sub_task_are_seen_first() -> None:
    steps = Steps([("red", "plate"), ("green", "plate")], ["green", "plate", "red"])
    hands = hands_of(np.tile(state_near_home(np.random.default_rng(4)), (2, 1)))
    place = {name: torch.tensor([0.1 * i, 0.0, 0.75]) for i, name in enumerate(("green", "plate", "red"))}
    objects = ObjectPoses(torch.stack(list(place.values())).expand(2, 3, 3), torch.zeros(2, 3, 0, 3), torch.zeros(2, 0))
    swapped = ObjectPoses(objects.position[:, [2, 1, 0]], objects.axes, objects.parts)
    red, green = steps.seen(hands, objects, torch.tensor([0, 1])).features
    assert red[-2:].tolist() == [1, 0] and green[-2:].tolist() == [0, 1]
    assert torch.equal(green[:-2], steps.seen(hands, swapped, torch.tensor([0, 0])).features[1, :-2])


def test_a_sub_task_is_next_until_its_object_lies_at_its_place() -> None:
    torch.manual_seed(0)
    steps = Steps([("red", "plate"), ("green", "plate")], ["green", "plate", "red"])
    hands = hands_of(np.tile(state_near_home(np.random.default_rng(4)), (400, 1)))
    position = torch.rand(400, 3, 3) * 0.2 + 0.3
    done = torch.rand(400, 2) < 0.5
    for step, place in enumerate((2, 0)):  # red, then green
        position[done[:, step], place] = position[done[:, step], 1]
    relations = steps.relations(hands, ObjectPoses(position, torch.zeros(400, 3, 0, 3), torch.zeros(400, 0)))
    progress = Progress(relations.shape[-1])
    progress.scaled_by(relations)
    optimiser = torch.optim.Adam(progress.parameters(), lr=1e-2)
    for _ in range(100):
        optimiser.zero_grad()
        torch.nn.functional.binary_cross_entropy_with_logits(progress(relations), done.float()).backward()
        optimiser.step()
    wanted = torch.where(done[:, 0], 1, 0)  # all done counts as the last
    assert float((progress.next_step(relations) == wanted).float().mean()) > 0.98


def test_the_sub_task_behind_the_last_that_is_done_is_next() -> None:
    class Told(Progress):
        def forward(self, relations: torch.Tensor) -> torch.Tensor:
            return relations[..., 0]

    logits = torch.tensor([[-1.0, -1, -1], [1, -1, -1], [1, 1, 1], [-1, 1, -1]])
    assert Told(1).next_step(logits[..., None]).tolist() == [0, 1, 2, 2]


def test_a_sub_task_ends_at_its_last_press() -> None:
    data = replace(demonstrations(episodes=2, frames=10), steps=np.repeat([0, 1, 0, 1], 5))
    presses = np.zeros(20, bool)
    presses[[3, 5, 7, 8, 18]] = True
    assert data.releases(presses).tolist() == [3] * 5 + [8] * 5 + [14] * 5 + [18] * 5  # the third presses on nothing


def test_a_number_that_never_changes_in_demonstrations_is_not_magnified() -> None:
    still, wide = torch.zeros(20, 1), torch.linspace(-1, 1, 20)[:, None]
    scale = Scale.of(torch.cat([still, wide], dim=1), torch.randn(20, 1, 2, 10))
    assert torch.allclose(scale.inputs(torch.tensor([[0.005, 0.0]])), torch.tensor([[0.5, 0.0]]), atol=1e-6)


def test_a_training_takes_so_many_steps_at_a_rate_that_falls(monkeypatch: pytest.MonkeyPatch) -> None:
    rates = []

    def stepped(optimiser: torch.optim.AdamW) -> None:
        rates.extend(group["lr"] for group in optimiser.param_groups)

    monkeypatch.setattr(torch.optim.AdamW, "step", stepped)
    network = torch.nn.Linear(2, 1)
    spent = fit(network, lambda: network(torch.ones(1, 2)).sum(), name="line", steps=1000, rate=0.1, decay=0.0)
    assert len(rates) == 1000 and max(rates) > 0.09 and rates[-1] < 1e-6 and spent > 0
    assert rates[100:] == sorted(rates[100:], reverse=True)


@pytest.mark.slow
def test_a_trained_policy_follows_its_demonstrations_and_can_be_stored(tmp_path: Path) -> None:
    data = demonstrations()
    size = Size(chunk=4, width=64, layers=2, ways=1, aims=1)
    meaning = Meaning(ROBOT, data.names, data.object_names, (("block",),))
    still = Noise(share=0.0, opening=0.0, random_opening=0.0)
    policy = trained(data, meaning, Training(steps=300, batch=32, noise=still, aim_noise_m=0.0, size=size))
    seen = {"observation/state": data.states[3], "observation/environment_state": data.objects[3]}
    told = copy(policy).infer(seen)["actions"]
    assert told.shape == (4, 16)
    assert np.abs(told - data.actions[3:7]).max() < np.abs(data.actions[3:7] - data.states[3]).max()
    policy.write(tmp_path / "weights.pt")
    read = Policy.read(tmp_path / "weights.pt")
    assert np.array_equal(read.infer(seen)["actions"], told)
    assert read.cpu_s == policy.cpu_s and read.cpu_s["policy"] > 0


def test_a_policy_of_two_sub_tasks_can_be_stored(tmp_path: Path) -> None:
    data = demonstrations()
    both = np.concatenate([data.objects, data.objects + 0.1], axis=1)
    names = (*data.object_names, *(name.replace("block", "lemon") for name in data.object_names))
    data = replace(data, steps=np.tile(np.repeat([0, 1], 10), 2), objects=both, object_names=names)
    meaning = Meaning(ROBOT, data.names, names, (("block",), ("lemon",)))
    policy = trained(data, meaning, Training(steps=20, batch=32, size=Size(chunk=4, width=16, layers=1, ways=2)))
    policy.write(tmp_path / "weights.pt")
    assert policy.cpu_s.keys() == {"progress", "policy"}
    seen = {"observation/state": data.states[3], "observation/environment_state": data.objects[3]}
    assert np.array_equal(Policy.read(tmp_path / "weights.pt").infer(seen)["actions"], policy.infer(seen)["actions"])


@pytest.mark.slow
def test_a_localiser_finds_a_square_in_pictures() -> None:
    rng = np.random.default_rng(6)
    rows, columns = rng.integers(4, 36, (2, 200))
    pictures = np.zeros((200, 40, 40, 3), np.uint8)
    for picture, row, column in zip(pictures, rows, columns, strict=True):
        picture[row - 3 : row + 3, column - 3 : column + 3] = 255
    places = torch.from_numpy(np.stack([columns, rows, 0 * rows], axis=1) / 100.0).float()[:, None]
    hands = hands_of(np.tile(state_near_home(rng), (200, 1)))
    view = View("cam_high", None, 40, 40)
    training = LocaliserTraining(steps=200, batch=16)
    where = {"cam_high": torch.from_numpy(np.stack([columns, rows], axis=1) / 20.0 - 1).float()[:, None]}
    localiser, _ = trained_localiser({"cam_high": pictures}, hands, places, [view], where, training)
    found = localiser.positions({"cam_high": pictures[7]}, hands[torch.tensor([7])])
    assert float((found[0] - places[7]).abs().max()) < 0.25 * float(places.std(dim=0).max())


def test_fixed_cameras_see_objects_where_the_file_of_the_robot_has_them() -> None:
    camera = placed(load_robot(ROBOT).cameras["cam_high"])
    points = camera.unproject([[80, 60], [240, 180]], 0.74)
    positions = torch.from_numpy(np.stack([[points[0], points[1]], [camera.pose.p - [0, 1, 0], points[1]]]))
    views = [View("cam_high", None, 120, 160), View("cam_left_wrist", 0, 60, 80)]
    found = places_in_pictures(ROBOT, views, positions)
    assert found.keys() == {"cam_high"}
    wanted = [[[-0.5, -0.5], [0.5, 0.5]], [[2.0, 2.0], [0.5, 0.5]]]
    assert np.allclose(found["cam_high"], wanted, atol=1e-5)


def test_a_point_misses_an_object_by_the_heat_that_is_elsewhere() -> None:
    share = torch.full((1, 3, 4, 5), 0.5 / 19)
    share[0, 0, 1, 3] = share[0, 1, 0, 0] = 0.5
    places = torch.tensor([[[0.5, -0.3], [0.9, 0.9]]])  # column 3 of 5 and row 1 of 4; then the last cell
    heat = share.log()
    assert float(missed_by(heat, places[:, :1])) == pytest.approx(np.log(2))
    assert float(missed_by(heat, places)) == pytest.approx((np.log(2) + np.log(38)) / 2)
    assert float(missed_by(heat, places + torch.tensor([[[0.0, 0.0], [0.2, 0.0]]]))) == pytest.approx(np.log(2))
    assert float(missed_by(heat, places + 2)) == 0.0


def test_weights_are_known_by_their_demonstrations_and_the_settings_of_their_training() -> None:
    data = demonstrations()
    known = {
        policy._made_from(data, Training()),
        policy._made_from(data, Training(aim_noise_m=0.0)),
        policy._made_from(replace(data, ends=data.ends - [1, 0]), Training()),
    }
    assert len(known) == 3 and policy._made_from(demonstrations(), Training()) in known


def test_policies_on_pictures_differ_only_in_what_finds_the_objects(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    data, size = demonstrations(), Size(chunk=2, width=8, layers=1, aims=2)
    pictures = {"cam_high": np.zeros((len(data.states), 20, 20, 3), np.uint8)}
    monkeypatch.setattr(policy, "views_of", lambda _: [View("cam_high", None, 20, 20)])
    monkeypatch.setattr(policy, "shrunk_pictures", lambda *_: pictures)
    meaning = Meaning(ROBOT, data.names, data.object_names, (("block",),), turned=False)
    bench = policy._Bench(Task("", ROBOT, tmp_path, workers=1), policy.Plan(steps=20))
    blind = bench._trained("positions", data, meaning, Training(steps=5, batch=8, size=size))
    files = {bench._localising(blind, stored, RunFolder(tmp_path), data, seed=0) for stored in ("raw", "lerobot")}
    longer = replace(bench, plan=policy.Plan(steps=30))
    files.add(longer._localising(blind, "raw", RunFolder(tmp_path), data, seed=0))
    assert len(files) == 3
    same = Policy.read(blind).network.state_dict()
    for read in map(Policy.read, files):
        assert read.localiser is not None and read.cpu_s.keys() == {"policy", "localiser"}
        assert all(torch.equal(numbers, same[name]) for name, numbers in read.network.state_dict().items())


@pytest.mark.parametrize("unproven", [False, True])
def test_layouts_in_which_the_expert_fails_are_counted_only_where_asked(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, unproven: bool
) -> None:
    asked: list[list[str]] = []
    monkeypatch.setattr(policy, "served", lambda _: nullcontext("ws://127.0.0.1:1"))
    monkeypatch.setattr(policy, "_answer", lambda command: asked.append(command) or {"summary": {"n_success": 0}})
    bench = policy._Bench(Task("", ROBOT, tmp_path, workers=1), policy.Plan(unproven=unproven))
    bench._evaluated(tmp_path / "checked.pt", RunFolder(tmp_path), "checked", 0, [])
    assert ("--unproven" in asked[0]) == unproven


def test_an_answer_is_the_last_line_of_a_command() -> None:
    said = 'print(\'so far\'); print(\'{"error": {"code": "stale_stage"}}\'); exit(3)'
    assert policy._answer([sys.executable, "-c", said])["error"]["code"] == "stale_stage"
    with pytest.raises(VcageError, match="ended with 9, and without a result"):
        policy._answer([sys.executable, "-c", "exit(9)"])


def test_a_device_that_torch_does_not_have_is_refused_before_anything_is_collected(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="--device 'gpu' is none that torch has here"):
        policy.run(quick=True, data=tmp_path, device="gpu")
    assert not list(tmp_path.iterdir())
