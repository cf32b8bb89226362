"""Localise the objects of a task in pictures.

Each camera finds points in its picture (spatial soft-argmax: S. Levine et al., "End-to-End Training of Deep Visuomotor
Policies", JMLR 2016, section 4.2), and from them tells where each object is, in the world or, if a hand carries it, in
the frame of the hand, and how far that is to be trusted. Labels are the poses of the objects in the export. From these
alone it is a matter of luck if a point finds a block of five pixels. So fixed cameras are also shown where it is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from benchmarks._policy.fitting import fit
from benchmarks._policy.hands import HandPoses
from vcage.sim.cameras import placed
from vcage.sim.robots import load_robot


@dataclass(frozen=True)
class LocaliserSettings:
    """Settings of the networks of a localiser.

    Args:
        unit_m: of their answers: objects are a few of these away from the middle.
        fixed_points: that are found in a picture of a fixed camera, beside one for each object.
        carried_points: that are found in a picture of a camera that a hand carries.
        channels: of the first layer.
        sharpness: by which a picture's heat is multiplied before points are found in it, at the beginning. With
            2, each point is the middle of the picture for hundreds of steps.
        width: of the hidden layers behind the points.
    """

    unit_m: float = 0.1
    fixed_points: int = 16
    carried_points: int = 12
    channels: int = 16
    sharpness: float = 8.0
    width: int = 128


SETTINGS = LocaliserSettings()


@dataclass(frozen=True)
class View:
    """A camera, as the localiser uses it.

    Args:
        camera: its name.
        hand: number of the hand that carries it; None for a fixed one.
        height, width: of the picture that the network gets, pixels.
    """

    camera: str
    hand: int | None
    height: int
    width: int

    def shrunk(self, picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """(H, W, 3) uint8 as (height, width, 3)."""
        return np.asarray(cv2.resize(picture, (self.width, self.height), interpolation=cv2.INTER_AREA), np.uint8)


def views_of(robot: str) -> list[View]:
    """The cameras of a robot: fixed ones at half their size, those of hands, which come near, at a quarter."""
    record = load_robot(robot)
    arms = sorted(record.arms)
    return [
        View(name, hand, camera.height // part, camera.width // part)
        for name, camera in sorted(record.cameras.items())
        for hand, part in [(None, 2) if camera.arm is None else (arms.index(camera.arm), 4)]
    ]


def places_in_pictures(robot: str, views: Sequence[View], positions: torch.Tensor) -> dict[str, torch.Tensor]:
    """Fixed camera → (F, O, 2) the places of objects in its pictures, from -1 left and above to 1 right and below.

    The camera is where the robot's file has it. Objects behind it have the place 2, which is outside.

    Args:
        robot: name of the robot.
        views: its cameras.
        positions: (F, O, 3) of the objects, in the world, metres.
    """
    cameras = {view.camera: placed(load_robot(robot).cameras[view.camera]) for view in views if view.hand is None}
    return {
        name: torch.from_numpy(
            np.nan_to_num(2 * camera.project(positions.numpy()) / [camera.width, camera.height] - 1, nan=2.0)
        ).float()
        for name, camera in cameras.items()
    }


@dataclass(frozen=True)
class LocaliserTraining:
    """Settings of the training of a localiser.

    Args:
        steps: of the descent.
        batch: moments of a step.
        rate: highest learning rate; it falls to none along a cosine.
        decay: of the weights.
        brightness: standard deviation of a change of gain and of offset, of a picture between -1 and 1.
        own: share of the loss of each camera's own answer.
        shown: share of the loss of fixed cameras' points that are not where the objects are in the picture.
        seed: of weights and order.
    """

    steps: int = 1000
    batch: int = 16
    rate: float = 2e-3
    decay: float = 1e-3
    brightness: float = 0.1
    own: float = 0.2
    shown: float = 0.03
    seed: int = 0


def _layer(before: int, after: int, kernel: int = 3, stride: int = 1, dilation: int = 1) -> nn.Sequential:
    convolution = nn.Conv2d(before, after, kernel, stride, dilation * (kernel // 2), dilation)
    return nn.Sequential(convolution, nn.BatchNorm2d(after), nn.ReLU())


class CameraNetwork(nn.Module):
    """Picture → position of each object, and the logarithm of its weight.

    Args:
        points: to find in a picture.
        objects: number of objects.
        known: further numbers that it is told.
    """

    def __init__(self, points: int, objects: int, known: int):
        super().__init__()
        channels, wide = SETTINGS.channels, 2 * SETTINGS.channels
        self.body = nn.Sequential(
            _layer(3, channels, kernel=5, stride=2),
            _layer(channels, wide, stride=2),
            _layer(wide, wide),
            _layer(wide, wide, dilation=2),
            nn.Conv2d(wide, points, 1),
        )
        self.sharpness = nn.Parameter(torch.full((points,), SETTINGS.sharpness))
        self.head = nn.Sequential(
            nn.Linear(3 * points + known, SETTINGS.width),
            nn.GELU(),
            nn.Linear(SETTINGS.width, SETTINGS.width),
            nn.GELU(),
            nn.Linear(SETTINGS.width, 4 * objects),
        )

    def forward(self, pictures: torch.Tensor, known: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        """(N, O, 3) metres, (N, O), and the logarithms (N, P, rows, columns) of the heat, which adds up to 1.

        Args:
            pictures: (N, 3, h, w).
            known: (N, known).
        """
        heat = self.body(pictures)
        rows, columns = heat.shape[2:]
        logarithms = (heat.flatten(2) * self.sharpness[:, None]).log_softmax(-1).view_as(heat)
        share = logarithms.exp()
        across = (share.sum(2) * torch.linspace(-1, 1, columns)).sum(-1)
        down = (share.sum(3) * torch.linspace(-1, 1, rows)).sum(-1)
        found = torch.cat([across, down, share.flatten(2).amax(-1), known], dim=1)
        told = self.head(found).unflatten(1, (-1, 4))
        return told[..., :3] * SETTINGS.unit_m, told[..., 3], logarithms


class Localiser(nn.Module):
    """Localises objects by all cameras of a robot.

    Args:
        views: the cameras.
        objects: number of objects.
    """

    def __init__(self, views: Sequence[View], objects: int):
        super().__init__()
        self.views = list(views)
        self.middle = nn.Parameter(torch.zeros(objects, 3), requires_grad=False)
        fixed = [view.camera for view in views if view.hand is None]
        some_carried = len(fixed) < len(views)
        points = objects + SETTINGS.fixed_points
        self.fixed = nn.ModuleDict({name: CameraNetwork(points, objects, 0) for name in fixed})
        self.carried = CameraNetwork(SETTINGS.carried_points, objects, 6) if some_carried else None

    def forward(
        self, pictures: Mapping[str, torch.Tensor], hands: HandPoses
    ) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor, dict[str, torch.Tensor]]:
        """(N, O, 3) positions in the world, metres; of each camera (N, C, O, 3), its weights (N, C, O), its heat."""
        told = [self._told(view, pictures[view.camera], hands) for view in self.views]
        positions = torch.stack([position for position, _, _ in told], dim=1)
        weights = torch.stack([weight for _, weight, _ in told], dim=1).softmax(dim=1)
        heat = {view.camera: heat for view, (_, _, heat) in zip(self.views, told, strict=True)}
        return (positions * weights[..., None]).sum(dim=1), positions, weights, heat

    def _told(
        self, view: View, pictures: torch.Tensor, hands: HandPoses
    ) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        if view.hand is None:
            away, weight, heat = self.fixed[view.camera](pictures, pictures.new_zeros(len(pictures), 0))
            return self.middle + away, weight, heat
        assert self.carried is not None
        position, rotation = hands.position[:, view.hand], hands.rotation[:, view.hand]
        number = torch.full((len(position), 1), float(view.hand))
        known = torch.cat([position[:, 2:], rotation[:, 2], hands.opening[:, view.hand, None], number], dim=1)
        away, weight, heat = self.carried(pictures, known)
        return torch.einsum("nij,noj->noi", rotation, away) + position[:, None], weight, heat

    def positions(self, pictures: Mapping[str, NDArray[np.uint8]], hands: HandPoses) -> torch.Tensor:
        """(1, O, 3) positions, for one picture (H, W, 3) uint8 of each camera."""
        seen = {view.camera: as_input(view.shrunk(pictures[view.camera])[None]) for view in self.views}
        with torch.inference_mode():
            return self(seen, hands)[0]


def as_input(pictures: NDArray[np.uint8]) -> torch.Tensor:
    """(N, h, w, 3) uint8 as (N, 3, h, w) from -1 to 1."""
    return torch.from_numpy(pictures).permute(0, 3, 1, 2).float() / 127.5 - 1


def trained_localiser(
    pictures: Mapping[str, NDArray[np.uint8]],
    hands: HandPoses,
    positions: torch.Tensor,
    views: Sequence[View],
    places: Mapping[str, torch.Tensor],
    training: LocaliserTraining,
) -> tuple[Localiser, float]:
    """Train a localiser; the seconds of CPU time that it took.

    Args:
        pictures: (F, h, w, 3) of each view's camera, shrunk.
        hands: of the F frames.
        positions: (F, O, 3) of the objects.
        views: the cameras.
        places: fixed camera → (F, O, 2) of the objects in its pictures, as of :func:`places_in_pictures`.
        training: settings.
    """
    torch.manual_seed(training.seed)
    localiser = Localiser(views, positions.shape[1])
    localiser.middle.data.copy_(positions.mean(dim=0))

    def loss() -> torch.Tensor:
        frames = torch.randint(len(positions), (training.batch,))
        seen = {name: _otherwise_lit(as_input(rows[frames.numpy()]), training) for name, rows in pictures.items()}
        found, each, weights, heat = localiser(seen, hands[frames])
        error = (found - positions[frames]).abs().mean()
        own = (weights[..., None] * (each - positions[frames][:, None]).abs()).sum(dim=1).mean()
        missed = sum(missed_by(heat[name], rows[frames]) for name, rows in places.items())
        return (error + training.own * own) / SETTINGS.unit_m + training.shown * missed

    spent = fit(localiser, loss, name="localiser", steps=training.steps, rate=training.rate, decay=training.decay)
    return localiser, spent


def missed_by(heat: torch.Tensor, places: torch.Tensor) -> torch.Tensor:
    """The mean negative logarithm of the heat where objects are: the first points each find one. 0 if none is inside.

    Args:
        heat: (N, P, rows, columns), its logarithms.
        places: (N, O, 2) in the picture, from -1 to 1; others are outside.
    """
    rows, columns = heat.shape[2:]
    cells = ((places + 1) / 2 * places.new_tensor([columns, rows])).long()
    inside = ((places >= -1) & (places < 1)).all(dim=-1)
    index = cells[..., 1] * columns + cells[..., 0]
    there = heat[:, : places.shape[1]].flatten(2).gather(2, (index * inside)[..., None])[..., 0]
    return -(there * inside).sum() / inside.sum().clip(min=1)


def _otherwise_lit(pictures: torch.Tensor, training: LocaliserTraining) -> torch.Tensor:
    gain, offset = torch.randn(2, len(pictures), 1, 1, 1) * training.brightness
    return pictures * (1 + gain) + offset
