"""Joints and grippers, measured and commanded, as curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vcage.apps.viewer.rerun_log import Clock, RerunLog, entity, rr
from vcage.base.drawing import Colour
from vcage.datasets.episode import EpisodeData
from vcage.datasets.recordings.recording import Recording

COLOURS = ((0, 114, 178), (213, 94, 0), (0, 158, 115), (204, 121, 167), (230, 159, 0), (86, 180, 233), (150, 150, 150))
"""Told apart by the colour-blind too (Okabe and Ito, https://jfly.uni-koeln.de/color/); again from the first on."""

PALE = 0.5
"""How far the colour of a command lies between that of its joint and white."""


@dataclass(frozen=True)
class Plot:
    """Curves shown together.

    Args:
        name: title.
        entities: paths of the curves, each with all below it.
        bounds: lower and upper end of the axis; from the visible data when not given.
        legend: True if there is room for the names of all curves.
    """

    name: str
    entities: list[str]
    bounds: tuple[float, float] | None = None
    legend: bool = True


def log_joints(log: RerunLog, clock: Clock, episode: EpisodeData) -> list[Plot]:
    """Every number of an episode's state, measured, commanded and its velocity, by its name.

    Args:
        log: where it is written.
        clock: when the episode's frames are.
        episode: whose numbers.
    """
    arms: dict[str, list[str]] = {}
    grippers, velocities = [], []
    for column, name in enumerate(episode.state_names):
        colour = _colour(column)
        where = _log_joint(log, clock, name, colour, episode.qpos[:, column], episode.targets[:, column])
        together = grippers if column in episode.grippers else arms.setdefault(name.partition("_")[0], [])
        together.append(where)
        velocities.append(entity("velocities", name))
        _curve(log, velocities[-1], clock, episode.qvel[:, column], name, colour)
    plots = [Plot(f"{arm.capitalize()} arm, rad", entities, legend=False) for arm, entities in arms.items()]
    plots += [Plot("Grippers, 0 closed to 1 open", grippers)] if grippers else []
    return [*plots, Plot("Velocities, 1/s", velocities, legend=False)]


def log_motion(log: RerunLog, clock: Clock, recording: Recording) -> list[Plot]:
    """Log the robot's state and commands of another project's recording, by name, in its own units.

    Args:
        log: where it is written.
        clock: when the recording's frames are.
        recording: whose numbers.
    """
    motion, state = recording.motion, recording.state
    values = {} if state is None else dict(zip(recording.state_names, state.T, strict=True))
    names_of_action = recording.action_names
    commands = {} if motion is None else dict(zip(names_of_action, motion.values.T, strict=True))
    driven = [] if motion is None else [names_of_action[column] for column in motion.grippers]
    names = list(dict.fromkeys([*values, *commands]))
    paths = {
        name: _log_joint(log, clock, name, _colour(column), values.get(name), commands.get(name))
        for column, name in enumerate(names)
    }
    grippers = [path for name, path in paths.items() if name in driven]
    others = [path for name, path in paths.items() if name not in driven]
    plots = [Plot("Robot", others, legend=False), Plot("Grippers", grippers)]
    return [plot for plot in plots if plot.entities]


def log_parts(log: RerunLog, clock: Clock, episode: EpisodeData) -> list[Plot]:
    """Positions of the objects' moving parts.

    Args:
        log: where it is written.
        clock: when the episode's frames are.
        episode: whose numbers.
    """
    entities = []
    for name, joints in episode.object_joints.items():
        for column in range(joints.shape[1]):
            where = entity("moving_parts", name, str(column))
            _curve(log, where, clock, joints[:, column], f"{name} {column}", _colour(len(entities)))
            entities.append(where)
    return [Plot("Moving parts, m or rad", entities)] if entities else []


def _log_joint(
    log: RerunLog,
    clock: Clock,
    name: str,
    colour: Colour,
    measured: NDArray[np.float64] | None,
    commanded: NDArray[np.float64] | None,
) -> str:
    """One number (T,) of the robot, as far as it is known both ways; returns its entity."""
    where = entity("joints", name)
    if commanded is not None:
        _curve(log, f"{where}/commanded", clock, commanded, f"{name} commanded", _pale(colour))
    if measured is not None:
        _curve(log, f"{where}/measured", clock, measured, name, colour)
    return where


def _curve(log: RerunLog, where: str, clock: Clock, values: NDArray[np.float64], name: str, colour: Colour) -> None:
    log.always(where, rr.SeriesLines(names=name, colors=[colour], widths=1.5))
    log.numbers(where, clock, values)


def _colour(number: int) -> Colour:
    return COLOURS[number % len(COLOURS)]


def _pale(colour: Colour) -> Colour:
    red, green, blue = (round(level + (255 - level) * PALE) for level in colour)
    return red, green, blue
