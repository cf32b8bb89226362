"""The training of a policy on demonstrations."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import torch
from torch import nn
from torch.nn.functional import binary_cross_entropy_with_logits

from benchmarks._policy.demonstrations import Demonstrations
from benchmarks._policy.features import ObjectPoses, Seen, aimed, targets_of
from benchmarks._policy.fitting import fit
from benchmarks._policy.grip import carried, compensated, held
from benchmarks._policy.hands import HandPoses
from benchmarks._policy.network import Size, loss_of
from benchmarks._policy.policy import Meaning, Policy, Scale
from benchmarks._policy.steps import Progress


@dataclass(frozen=True)
class Noise:
    """Displacement of hands and objects in training: targets stay, so that the policy learns to come back to the way.

    Args:
        position_m, rotation_rad, opening: standard deviations of hands.
        object_m: of the positions of objects.
        grip_m: of the place of an object in the hand that holds it: the hand makes up for it.
        other_m: of those that the sub-task under way is not about: they tell little about it.
        spread: of the logarithm of a factor by which a frame's noise is larger or smaller.
        share: of the frames that get any.
        random_opening: share of the frames in which a gripper is open at random: so a grasp that missed is tried again.
    """

    position_m: float = 0.006
    rotation_rad: float = 0.025
    opening: float = 0.04
    object_m: float = 0.0
    grip_m: float = 0.004
    other_m: float = 0.03
    spread: float = 0.5
    share: float = 0.8
    random_opening: float = 0.05

    def added(self, hands: HandPoses) -> HandPoses:
        """Displaced hands."""
        factor = self._factor(hands)
        turn = torch.randn_like(hands.position) * self.rotation_rad * factor
        x, y, z, none = *turn.unbind(-1), torch.zeros_like(hands.opening)
        skew = torch.stack([none, -z, y, z, none, -x, -y, x, none], dim=-1).unflatten(-1, (3, 3))
        return HandPoses(
            hands.position + torch.randn_like(hands.position) * self.position_m * factor,
            hands.rotation @ torch.linalg.matrix_exp(skew),
            torch.where(
                torch.rand_like(hands.opening) < self.random_opening,
                torch.rand_like(hands.opening),
                (hands.opening + torch.randn_like(hands.opening) * self.opening).clip(0, 1),
            ),
        )

    def slips(self, hands: HandPoses) -> torch.Tensor:
        """(N, A, 3) shifts of an object in each hand, in its frame."""
        return torch.randn_like(hands.position) * self.grip_m * self._factor(hands)

    def _factor(self, hands: HandPoses) -> torch.Tensor:
        some = hands.opening.new_zeros(len(hands.opening), 1, 1)
        return (torch.rand_like(some) < self.share) * torch.exp(torch.randn_like(some) * self.spread)

    def moved(self, objects: ObjectPoses) -> ObjectPoses:
        """Displaced objects."""
        return replace(objects, position=objects.position + torch.randn_like(objects.position) * self.object_m)

    def blurred(self, objects: ObjectPoses, others: torch.Tensor) -> ObjectPoses:
        """Objects of which the others (N, O) are displaced."""
        blur = torch.randn_like(objects.position) * self.other_m * others[..., None]
        return replace(objects, position=objects.position + blur)


@dataclass(frozen=True)
class Training:
    """Settings of a training.

    Args:
        steps: of the descent.
        batch: frames of a step.
        rate: highest learning rate; it falls to none along a cosine.
        decay: of the weights.
        seed: of weights, noise and order.
        noise: on the hands.
        size: of the network.
        presses: opening by which a gripper stays above its target where it presses on something, 0 closed to 1 open.
        gripper_change: of the target of a gripper from one frame to the next, from which on it opens or closes: an aim.
        aim_noise_m: standard deviation of the aims that the policy is led by: the objects tell them better.
        press_frames: frames in which a gripper without anything between its fingers reaches its target.
        progress_noise_m: standard deviation of objects in learning which sub-tasks are done: a policy puts them less
            exactly than demonstrations do.
        progress_turns: share of frames in which a moved object is turned at random in learning this: what has fallen
            over may be in its place, too.
        progress_share: steps to learn which sub-tasks are done, as a share of those of the policy.
        device: of torch.
    """

    steps: int = 10_000
    batch: int = 256
    rate: float = 1e-3
    decay: float = 1e-3
    seed: int = 0
    noise: Noise = field(default_factory=Noise)
    size: Size = field(default_factory=Size)
    presses: float = 0.05
    press_frames: int = 5
    gripper_change: float = 0.3
    aim_noise_m: float = 0.005
    progress_noise_m: float = 0.02
    progress_turns: float = 0.3
    progress_share: float = 0.15
    device: str = "cpu"


class Batches:
    """Inputs and targets of frames.

    Args:
        demonstrations: all frames.
        meaning: of their numbers.
        training: its noise, and the length of its chunks.

    Attributes:
        progress: tells the sub-task of each frame, as it will where the policy acts; None if there is but one.
    """

    def __init__(self, demonstrations: Demonstrations, meaning: Meaning, training: Training):
        self._noise, hands = training.noise, meaning.hands()
        self._progress_noise = replace(training.noise, object_m=max(training.noise.object_m, training.progress_noise_m))
        self._progress_turns = training.progress_turns
        measured, future = hands.poses(demonstrations.states), hands.poses(demonstrations.actions)
        later = demonstrations.next_frames(training.press_frames + 1)[:, -1]
        stopped = measured.opening[torch.from_numpy(later)]
        presses = future.opening < stopped - training.presses
        released = np.arange(len(later)) > demonstrations.releases(presses.any(dim=1).numpy())
        opening = future.opening.numpy()
        switches = np.abs(np.diff(opening, axis=0, prepend=opening[:1])).max(axis=1) > training.gripper_change
        switches[demonstrations.ends[:-1]] = False  # the first frame of an episode follows none of it
        device = self._device = training.device
        self._aim = torch.from_numpy(demonstrations.next_of(switches)).to(device)
        self._hands, self._future = measured.to(device), future.to(device)
        self._objects = meaning.seen_objects().poses(demonstrations.objects).to(device)
        closed = (measured.opening < stopped + training.presses).to(device) & presses.to(device)
        following = torch.from_numpy(demonstrations.next_frames(2)[:, 1]).to(device)
        self._sequence = meaning.sequence()
        moved = self._sequence.moved(torch.from_numpy(demonstrations.steps).to(device))
        self._held = held(self._hands, self._objects, following, moved[:, None] & closed[..., None])
        self._next = torch.from_numpy(demonstrations.next_frames(training.size.chunk)).to(device)
        self._next_step = torch.from_numpy(demonstrations.steps + released).to(device)
        self.progress: Progress | None = None

    def __len__(self) -> int:
        """Number of frames."""
        return len(self._next)

    def drawn(self, count: int) -> torch.Tensor:
        """(N,) some frames at random."""
        return torch.randint(len(self), (count,), device=self._device)

    def __getitem__(self, frames: torch.Tensor) -> tuple[Seen, torch.Tensor, torch.Tensor]:
        """N views of the hands with fresh noise, their (N, A, :data:`TARGET`) aims and (N, K, A, …) targets."""
        hands, objects, slips = self._noisy(frames, self._noise)
        step = self._sequence.next_of(self.progress, hands, objects)
        seen = self._sequence.seen(hands, self._noise.blurred(objects, self._sequence.others(step)), step)
        aims = targets_of(hands, compensated(self._future[self._aim[frames][:, None]], slips))[:, 0]
        return seen, aims, targets_of(hands, compensated(self._future[self._next[frames]], slips))

    def relations(self, frames: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """(N, K, R) relations of the sub-tasks with fresh noise, and (N, K) 1 where these are done.

        A sub-task is done when its object is released: so the way back of the hand belongs to the next.
        """
        hands, objects, _ = self._noisy(frames, self._progress_noise)
        objects = turned(objects, self._sequence.only_moved().to(self._device), self._progress_turns)
        done = self._next_step[frames][:, None] > torch.arange(len(self._sequence), device=self._device)
        return self._sequence.relations(hands, objects), done.float()

    def _noisy(self, frames: torch.Tensor, noise: Noise) -> tuple[HandPoses, ObjectPoses, torch.Tensor]:
        """Hands and objects with fresh noise, and the (N, A, 3) shifts of what the hands hold, in their frames."""
        before, holds = self._hands[frames], self._held[frames]
        after = noise.added(before)
        slips = noise.slips(before) * holds.any(dim=2)[..., None]
        return after, noise.moved(carried(self._objects[frames], holds, before, after, slips)), slips


def turned(objects: ObjectPoses, which: torch.Tensor, share: float) -> ObjectPoses:
    """Objects of which some are turned at random.

    Args:
        objects: N times.
        which: (O,) bool, those that may be turned.
        share: of the frames in which each of them is turned.
    """
    count, number, axes, _ = objects.axes.shape
    if not axes:
        return objects
    turns = torch.linalg.qr(torch.randn(count, number, 3, 3, device=objects.axes.device)).Q
    turns = turns * torch.linalg.det(turns)[..., None, None]
    some = which & (torch.rand(count, number, device=which.device) < share)
    return replace(objects, axes=torch.where(some[..., None, None], turns[..., :2, :], objects.axes))


def trained(demonstrations: Demonstrations, meaning: Meaning, training: Training) -> Policy:
    """Train a policy on states."""
    torch.manual_seed(training.seed)
    batches = Batches(demonstrations, meaning, training)
    spent = {}
    if len(meaning.steps) > 1:
        batches.progress, spent["progress"] = _progress(batches, training)
    seen, aims, targets = batches[torch.arange(len(batches), device=training.device)]
    scale, aim_scale = Scale.of(aimed(seen, aims), targets), Scale.of(seen.features, aims[:, None])
    policy = Policy(meaning, scale, aim_scale, training.size, batches.progress).to(training.device)

    def loss() -> torch.Tensor:
        seen, aims, targets = batches[batches.drawn(training.batch)]
        given, scores = policy.aims(seen)
        aiming = loss_of((aim_scale.targets(given), scores), aim_scale.targets(aims))
        blurred = torch.cat([aims[..., :3] + training.aim_noise_m * torch.randn_like(aims[..., :3]), aims[..., 3:]], -1)
        chunks, scores = policy.chunks(seen, blurred)
        return aiming + loss_of((scale.targets(chunks), scores), scale.targets(targets))

    spent["policy"] = fit(
        nn.ModuleList([policy.network, policy.aiming]),
        loss,
        name="policy",
        steps=training.steps,
        rate=training.rate,
        decay=training.decay,
    )
    policy.cpu_s = spent
    return policy.to("cpu")


def _progress(batches: Batches, training: Training) -> tuple[Progress, float]:
    """Train the part that tells which sub-tasks are done; the seconds of CPU time that it took."""
    relations, _ = batches.relations(torch.arange(len(batches), device=training.device))
    progress = Progress(relations.shape[-1]).to(training.device)
    progress.scaled_by(relations)

    def loss() -> torch.Tensor:
        told, done = batches.relations(batches.drawn(training.batch))
        return binary_cross_entropy_with_logits(progress(told), done)

    steps = round(training.progress_share * training.steps)
    spent = fit(progress, loss, name="progress", steps=steps, rate=training.rate, decay=training.decay)
    return progress, spent
