"""A policy: a network with what its numbers mean, and its answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from benchmarks._policy.features import (
    TARGET,
    ObjectPoses,
    Objects,
    Seen,
    aimed,
    deviations,
    moved_with_objects,
    only_positions,
    poses_of,
    standardised,
)
from benchmarks._policy.hands import HandPoses, Hands
from benchmarks._policy.localiser import Localiser, View
from benchmarks._policy.network import ChunkPolicy, Size
from benchmarks._policy.steps import Progress, Steps


@dataclass(frozen=True)
class AimSettings:
    """Choice of an aim.

    Args:
        same_aim_m: aims that lie nearer than about this are the same.
        preference: logarithm of the factor by which the aim of the last look is preferred.
    """

    same_aim_m: float = 0.03
    preference: float = 3.0


SETTINGS = AimSettings()


@dataclass(frozen=True)
class Scale:
    """Mean and deviation of the numbers of inputs (F,) and targets (:data:`TARGET`,)."""

    input_mean: torch.Tensor
    input_deviation: torch.Tensor
    target_mean: torch.Tensor
    target_deviation: torch.Tensor

    @classmethod
    def of(cls, inputs: torch.Tensor, targets: torch.Tensor) -> Scale:
        """The scale of (N, F) inputs and (N, K, A, :data:`TARGET`) targets; one for all directions in space."""
        deviation = deviations(targets)
        deviation[:3], deviation[3:-1] = deviation[:3].mean(), deviation[3:-1].mean()
        return cls(inputs.mean(dim=0), deviations(inputs), targets.mean(dim=(0, 1, 2)), deviation)

    def to(self, device: str) -> Scale:
        """This scale, on a device of torch."""
        return Scale(**{name: numbers.to(device) for name, numbers in vars(self).items()})

    def inputs(self, inputs: torch.Tensor) -> torch.Tensor:
        """Inputs with mean 0 and deviation 1."""
        return standardised(inputs, self.input_mean, self.input_deviation)

    def targets(self, targets: torch.Tensor) -> torch.Tensor:
        """Targets with mean 0 and deviation 1."""
        return (targets - self.target_mean) / self.target_deviation

    def unscaled(self, targets: torch.Tensor) -> torch.Tensor:
        """The inverse of :meth:`targets`."""
        return targets * self.target_deviation + self.target_mean


@dataclass(frozen=True)
class Meaning:
    """Meaning of the numbers of a policy.

    Args:
        robot: name of the robot.
        names: of the D numbers of a state.
        object_names: of the M numbers of its objects.
        steps: ids of the objects of each sub-task in order, the moved one first.
        turned: tell the policy how these are turned, and how their parts stand; else only where they are.
    """

    robot: str
    names: tuple[str, ...]
    object_names: tuple[str, ...]
    steps: tuple[tuple[str, ...], ...]
    turned: bool = True

    def hands(self) -> Hands:
        """The hands of the robot."""
        return Hands(self.robot, self.names)

    def seen_objects(self) -> Objects:
        """The objects of the task among those of a state."""
        return Objects(self.object_names, {name for step in self.steps for name in step}, self.turned)

    def sequence(self) -> Steps:
        """The sub-tasks."""
        return Steps(self.steps, self.seen_objects().ids)


class Policy:
    """Networks that answer observations of states, or of pictures with a localiser.

    The first aims: it tells where the hands will be when a gripper opens or closes next. The second leads there. Where
    several aims are as good, the policy stays with the one that it had: each episode needs a copy of its own.

    Args:
        meaning: of its numbers.
        scale: of inputs and targets.
        aim_scale: of the inputs and targets of the network that aims.
        size: of the networks.
        progress: tells which sub-task is next; None if there is but one.
        localiser: finds the objects in pictures; without it they are observed.

    Attributes:
        cpu_s: name of each training (progress, policy, localiser) → its seconds of CPU time.
    """

    def __init__(
        self,
        meaning: Meaning,
        scale: Scale,
        aim_scale: Scale,
        size: Size,
        progress: Progress | None = None,
        localiser: Localiser | None = None,
    ):
        self.meaning, self.size, self.progress, self.localiser = meaning, size, progress, localiser
        self.scale, self.aim_scale = scale, aim_scale
        self.hands, self.objects, self.steps = meaning.hands(), meaning.seen_objects(), meaning.sequence()
        self._weights = self.steps.weights(self.objects)
        numbers = len(self.hands) * (TARGET + self._weights)
        self.network = ChunkPolicy(len(scale.input_mean), numbers, size)
        self.aiming = ChunkPolicy(len(aim_scale.input_mean), numbers, size.of_aims())
        self._begin_without_objects()
        self._aim: torch.Tensor | None = None
        self.cpu_s: dict[str, float] = {}

    def infer(self, observation: Mapping[str, Any]) -> dict[str, NDArray[np.float64]]:
        """Return ``actions`` (chunk, D), absolute targets.

        Args:
            observation: ``observation/state``, and ``observation/environment_state`` or ``observation/<camera>``.
        """
        state = np.asarray(observation["observation/state"], np.float64)
        hands = self.hands.poses(state[None])
        objects = self._objects(observation, hands)
        with torch.inference_mode():
            step = self.steps.next_of(self.progress, hands, objects)
            chunk = self.chosen(hands, self.steps.seen(hands, objects, step))
        return {"actions": self.hands.states(poses_of(chunk, hands), state)}

    def chosen(self, hands: HandPoses, seen: Seen) -> torch.Tensor:
        """(K, A, :data:`TARGET`) the next targets at one time; the aim is remembered."""
        aims, scores = self.aims(seen)
        places = poses_of(aims[0], hands).position
        score = scores[0].log_softmax(0)
        if self._aim is not None:
            away = (places - self._aim).norm(dim=-1).amax(dim=-1)
            score = score + SETTINGS.preference * torch.exp(-((away / SETTINGS.same_aim_m) ** 2))
        best = int(score.argmax())
        self._aim = places[best]
        chunks, scores = self.chunks(seen, aims[:, best])
        return chunks[0, int(scores[0].argmax())]

    def aims(self, seen: Seen) -> tuple[torch.Tensor, torch.Tensor]:
        """(N, aims, A, :data:`TARGET`) alternative aims, and the score (N, aims) of each."""
        told, scores = self.aiming(self.aim_scale.inputs(seen.features))
        return self._unscaled(self.aim_scale, told, seen)[:, :, 0], scores

    def chunks(self, seen: Seen, aims: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """(N, ways, K, A, :data:`TARGET`) alternative chunks on the way to aims (N, A, :data:`TARGET`), and the score
        (N, ways) of each."""
        told, scores = self.network(self.scale.inputs(aimed(seen, aims)))
        return self._unscaled(self.scale, told, seen), scores

    def _begin_without_objects(self) -> None:
        """Begin without weights of objects: far ones would lead the hands anywhere."""
        for network in (self.network, self.aiming):
            for numbers in (network.chunks.weight.data, network.chunks.bias.data):
                numbers.view(-1, TARGET + self._weights, *numbers.shape[1:])[:, TARGET:] = 0.0

    def _unscaled(self, scale: Scale, told: torch.Tensor, seen: Seen) -> torch.Tensor:
        """Targets in metres, moved with objects, for the numbers that a network tells."""
        told = told.unflatten(-1, (len(self.hands), TARGET + self._weights))
        return moved_with_objects(scale.unscaled(told[..., :TARGET]), told[..., TARGET:], seen)

    def _objects(self, observation: Mapping[str, Any], hands: HandPoses) -> ObjectPoses:
        if self.localiser is None:
            numbers = np.asarray(observation["observation/environment_state"], np.float64)
            return self.objects.poses(numbers[None])
        pictures = {view.camera: np.asarray(observation[f"observation/{view.camera}"]) for view in self.localiser.views}
        return only_positions(self.localiser.positions(pictures, hands))

    def to(self, device: str) -> Policy:
        """This policy, on a device of torch."""
        self.scale, self.aim_scale = self.scale.to(device), self.aim_scale.to(device)
        for part in (self.network, self.aiming, self.progress, self.localiser):
            if part is not None:
                part.to(device)
        return self

    def write(self, path: Path) -> None:
        """Write all that :meth:`read` needs."""
        kept: dict[str, Any] = {"meaning": asdict(self.meaning), "size": asdict(self.size), "cpu_s": self.cpu_s}
        kept |= {"scale": vars(self.scale), "aim_scale": vars(self.aim_scale), "aiming": self.aiming.state_dict()}
        if self.progress is not None:
            kept["progress"] = self.progress.state_dict()
        if self.localiser is not None:
            kept["localiser"] = {
                "views": list(map(asdict, self.localiser.views)),
                "weights": self.localiser.state_dict(),
            }
        torch.save({**kept, "weights": self.network.state_dict()}, path)

    @classmethod
    def read(cls, path: Path) -> Policy:
        """Read what :meth:`write` wrote."""
        kept = torch.load(path, weights_only=True)
        meaning, progress, localiser = Meaning(**kept["meaning"]), None, None
        if "progress" in kept:
            progress = Progress(len(kept["progress"]["mean"]))
            progress.load_state_dict(kept["progress"])
            progress.eval()
        if "localiser" in kept:
            localiser = Localiser(
                [View(**view) for view in kept["localiser"]["views"]], len(meaning.seen_objects().ids)
            )
            localiser.load_state_dict(kept["localiser"]["weights"])
            localiser.eval()
        scales = Scale(**kept["scale"]), Scale(**kept["aim_scale"])
        policy = cls(meaning, *scales, Size(**kept["size"]), progress, localiser)
        for network, weights in ((policy.network, "weights"), (policy.aiming, "aiming")):
            network.load_state_dict(kept[weights])
            network.eval()
        policy.cpu_s = kept["cpu_s"]
        return policy
