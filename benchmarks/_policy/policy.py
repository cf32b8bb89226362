"""A policy: a network with what its numbers mean, and its answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from benchmarks._policy.features import TARGET, ObjectPoses, Objects, only_positions, poses_of
from benchmarks._policy.hands import HandPoses, Hands
from benchmarks._policy.localiser import Localiser, View
from benchmarks._policy.network import ChunkPolicy, Size
from benchmarks._policy.steps import Progress, Steps


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
        deviation = targets.std(dim=(0, 1, 2)).clip(1e-3)
        deviation[:3], deviation[3:-1] = deviation[:3].mean(), deviation[3:-1].mean()
        return cls(inputs.mean(dim=0), inputs.std(dim=0).clip(1e-3), targets.mean(dim=(0, 1, 2)), deviation)

    def inputs(self, inputs: torch.Tensor) -> torch.Tensor:
        """Inputs with mean 0 and deviation 1."""
        return ((inputs - self.input_mean) / self.input_deviation).clip(-5, 5)

    def targets(self, targets: torch.Tensor) -> torch.Tensor:
        """Targets with mean 0 and deviation 1."""
        return (targets - self.target_mean) / self.target_deviation

    def told(self, targets: torch.Tensor) -> torch.Tensor:
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
    """A network that answers observations of states, or of pictures with a localiser.

    Args:
        meaning: of its numbers.
        scale: of inputs and targets.
        size: of the network.
        progress: tells which sub-task is next; None if there is but one.
        localiser: finds the objects in pictures; without it they are observed.
    """

    def __init__(
        self,
        meaning: Meaning,
        scale: Scale,
        size: Size,
        progress: Progress | None = None,
        localiser: Localiser | None = None,
    ):
        self.meaning, self.scale, self.size, self.progress, self.localiser = meaning, scale, size, progress, localiser
        self.hands, self.objects, self.steps = meaning.hands(), meaning.seen_objects(), meaning.sequence()
        self.network = ChunkPolicy(len(scale.input_mean), len(self.hands) * TARGET, size)

    def infer(self, observation: Mapping[str, Any]) -> dict[str, NDArray[np.float64]]:
        """Return ``actions`` (chunk, D), absolute targets.

        Args:
            observation: ``observation/state``, and ``observation/environment_state`` or ``observation/<camera>``.
        """
        state = np.asarray(observation["observation/state"], np.float64)
        hands = self.hands.poses(state[None])
        objects = self._objects(observation, hands)
        with torch.inference_mode():
            inputs = self.steps.inputs(hands, objects, self.steps.next_of(self.progress, hands, objects))
            chunks, scores = self.network(self.scale.inputs(inputs))
        chunk = chunks[0, int(scores[0].argmax())].unflatten(-1, (len(self.hands), TARGET))
        return {"actions": self.hands.states(poses_of(self.scale.told(chunk), hands), state)}

    def _objects(self, observation: Mapping[str, Any], hands: HandPoses) -> ObjectPoses:
        if self.localiser is None:
            numbers = np.asarray(observation["observation/environment_state"], np.float64)
            return self.objects.poses(numbers[None])
        pictures = {view.camera: np.asarray(observation[f"observation/{view.camera}"]) for view in self.localiser.views}
        return only_positions(self.localiser.positions(pictures, hands))

    def write(self, path: Path) -> None:
        """Write all that :meth:`read` needs."""
        kept: dict[str, Any] = {"meaning": asdict(self.meaning), "scale": vars(self.scale), "size": asdict(self.size)}
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
        policy = cls(meaning, Scale(**kept["scale"]), Size(**kept["size"]), progress, localiser)
        policy.network.load_state_dict(kept["weights"])
        policy.network.eval()
        return policy
