"""A run as a Gymnasium environment: the scenes that its data came from, for a policy to act in.

Each reset draws a layout and a look as collecting does, from random streams that collecting never uses.
"""

from __future__ import annotations

import gc
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import MissingStage, UnknownName, UsageError
from vcage.base.files import RunFolder
from vcage.base.memory import forget
from vcage.episodes.beginnings import Beginnings
from vcage.evaluation.acting import Acting
from vcage.evaluation.attained import Task
from vcage.evaluation.environment_options import EnvironmentOptions
from vcage.evaluation.episode_start import EpisodeStart
from vcage.evaluation.expert import expert_episode
from vcage.evaluation.factors import OtherLook, widened
from vcage.evaluation.observation import names_of_joints, observation_space
from vcage.runs.accepted import accepted_episodes
from vcage.runs.context import StageContext
from vcage.runs.inputs import state_layout
from vcage.schema.episodes import Episodes
from vcage.schema.randomisation import Randomisation
from vcage.schema.scene import Scene
from vcage.sim.robots import load_randomisation
from vcage.tasks.loop import EpisodeRun

Observation = dict[str, Any]
Info = dict[str, Any]


PATIENCE = 2.0
"""An episode may take so many times as long as the longest demonstration."""


class RunEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """The task of a run, in newly drawn layouts and looks.

    Observations: ``pixels`` (camera → (H, W, 3) uint8), ``agent_pos`` ((D,) joints in radians and gripper openings, 0
    closed to 1 open), ``environment_state`` on demand (:class:`~vcage.datasets.environment_state.StateLayout`), and
    ``instruction``. Actions: (D,) absolute targets of the same joints and grippers, reached at the next step along a
    straight line, :attr:`fps` times a second of simulated time. Grippers are clipped to 0 … 1 and joints to their
    limits. The reward is 1 at the step where the task is done, which ends the episode, and 0 before.

    ``info`` has ``success`` and ``is_success``, ``goals`` (goal → truth), ``touched``, ``lifted``, ``brushed`` and
    ``collisions`` (:class:`~vcage.evaluation.attained.Attained`), ``seconds`` of simulated time, and ``start`` (where
    it came from).

    ``reset(seed=n)`` draws the n-th start of the evaluation; the same seed gives the same episode, whatever happened
    before. ``reset(options={"episode": k})`` begins as the k-th recorded episode did.

    Example:
        >>> import gymnasium, vcage
        >>> env = gymnasium.make("vcage/Run-v0", run="runs/blocks")
        >>> observation, info = env.reset(seed=0)

    Attributes:
        joint_names: of the D numbers of ``agent_pos`` and of an action.
        state_layout: order of the numbers of ``environment_state``.
        scene_seed: seed of the run's scene.

    Args:
        run: folder of a run with a layout and sub-tasks.
        options: see :class:`EnvironmentOptions`.
        context: the library, shared by environments of one process.

    Raises:
        MissingStage: the run lacks a stage, or a recorded length for ``max_steps``.
        UnknownName: a camera or a chain that is none.
        NoRenderer: pictures are wanted and nothing here can draw.
    """

    def __init__(self, run: str | Path, options: EnvironmentOptions | None = None, context: StageContext | None = None):
        self.options = options or EnvironmentOptions()
        self._run, self._context = RunFolder(Path(run)), context or StageContext("offline")
        collected = Episodes.read(self._run.episodes) if self._run.episodes.exists() else None
        asked = collected.provenance.options if collected is not None else {}
        self.fps = int(asked.get("fps", 10))
        self.metadata = {"render_modes": ["rgb_array"], "render_fps": self.fps}
        self.render_mode = "rgb_array" if self.options.pictures else None
        ranges, varied, self._other_look = self._drawing(asked)
        chains = Beginnings.of_run(self._run, ranges, self._context, varied=varied)
        if self.options.chain not in range(len(chains)):
            raise UnknownName("chain", str(self.options.chain), map(str, range(len(chains))))
        self._beginnings = chains[self.options.chain]
        self._robot, self._scene = self._beginnings.robot, Scene.read(self._run.layout)
        self.joint_names = names_of_joints(self._robot)
        self.cameras = self._chosen_cameras() if self.options.pictures else []
        self.task_description = self._beginnings.chain.text
        self._max_episode_steps = self.options.max_steps or self._longest()
        self.state_layout = state_layout(self._run, self._context)
        self._observed_state = self.state_layout if self.options.environment_state else None
        self._task = Task.of(self._beginnings.subtasks, self._beginnings.goals)
        words = [self.task_description, *self._beginnings.chain.wordings]
        self.observation_space = observation_space(self._robot, self.cameras, self._observed_state, words)
        self._lower, self._upper = self._limits()
        self.action_space = gymnasium.spaces.Box(self._lower, self._upper, dtype=np.float32)
        self.scene_seed = int(self._scene.provenance.seed)
        self._episode: Acting | None = None

    # --- Gymnasium ------------------------------------------------------------------------------------

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, Info]:
        """Begin an episode; see the class for seeds and recorded starts.

        Raises:
            InfeasibleScene: the objects of this seed do not stay where they are put.
            UnknownName: there is no recorded episode of that number, or no such option.
        """
        super().reset(seed=seed)
        self.close()
        for name in (options or {}).keys() - {"episode"}:
            raise UnknownName("option of reset", name, ["episode"])
        recorded = (options or {}).get("episode")
        if recorded is None:
            number = int(self.np_random.integers(2**31)) if seed is None else seed
            start = EpisodeStart.drawn_by(self._beginnings, self.scene_seed, number, self._other_look)
        else:
            start = EpisodeStart.recorded(self._run, int(recorded), self._context)
        self._episode = Acting(start, self._task, self.fps, self.cameras, self._observed_state)
        return self._episode.observation(), self._episode.info()

    def step(self, action: NDArray[np.float32]) -> tuple[Observation, float, bool, bool, Info]:
        """Carry an action out.

        Args:
            action: (D,) targets.

        Raises:
            UsageError: the action has another shape, or NaN; or no episode has begun.
        """
        done, late, info = self.act(action)
        return self.observe(), float(done), done, late, info

    def act(self, action: NDArray[np.float32]) -> tuple[bool, bool, Info]:
        """Carry an action out without a look, for policies that are not asked after each; raises as :meth:`step`.

        Returns:
            ``terminated``, ``truncated`` and ``info`` of :meth:`step`.
        """
        episode = self._begun()
        episode.carry_out(self._checked(action))
        done, over = episode.attained.success, episode.actions >= self._max_episode_steps
        return done, over and not done, episode.info()

    def observe(self) -> Observation:
        """Return the observation of now.

        Raises:
            UsageError: no episode has begun.
        """
        return self._begun().observation()

    def render(self) -> NDArray[np.uint8] | None:  # pyrefly: ignore[bad-override]
        """(H, W, 3) the picture of the first camera, of now; None without pictures."""
        if self._episode is None or not self.cameras:
            return None
        return self.observe()["pixels"][self.cameras[0]]

    def expert(self) -> EpisodeRun:
        """Let the scripts that collected the data do the task from the drawn start of this episode, in another world.

        Raises:
            UsageError: no episode has begun, or its start was recorded.
        """
        if self._episode is None or not self._episode.start.grasps:
            raise UsageError("the expert needs a drawn start", hint="call reset with a seed first")
        return expert_episode(self._episode.start, self._beginnings, self.fps)

    def close(self) -> None:
        """Forget the episode and its worlds."""
        if self._episode is None:
            return
        self._episode = None
        forget()
        if self.cameras:
            gc.collect()  # worlds contain reference cycles, and Python does not count the memory of a driver

    def _begun(self) -> Acting:
        if self._episode is None:
            raise UsageError("no episode has begun", hint="call reset first")
        return self._episode

    # --- checks ---------------------------------------------------------------------------------------

    def _checked(self, action: NDArray[np.float32]) -> NDArray[np.float64]:
        wanted = self._lower.shape
        try:
            given = np.asarray(action).astype(np.float64, casting="same_kind")
        except (TypeError, ValueError) as error:
            raise UsageError(
                f"the action is no array of numbers: {error}", hint=f"{wanted} of float32 is one"
            ) from error
        if given.shape != wanted:
            raise UsageError(
                f"the action has the shape {given.shape}, {self._robot.name} takes {wanted}",
                hint=f"the numbers of an action are {', '.join(self.joint_names)}",
            )
        if not np.isfinite(given).all():
            which = ", ".join(self.joint_names[i] for i in np.flatnonzero(~np.isfinite(given)))
            raise UsageError(f"the action holds NaN or infinity for {which}", hint="check what the policy was given")
        return np.clip(given, self._lower, self._upper)

    def _drawing(self, collected: Mapping[str, Any]) -> tuple[Randomisation, bool, OtherLook | None]:
        """The ranges of starts, true if layouts are drawn, and the other look where one factor of it is varied.

        Args:
            collected: options of the collection.
        """
        ranges, vary = _ranges(self.options.randomise, collected), self.options.vary
        varied = (self.options.layout or collected.get("layout", "varied")) == "varied"
        if vary is None:
            return ranges, varied, None
        if other := OtherLook.of(ranges, vary):
            return ranges, varied, other
        return widened(ranges, vary), varied != (vary == "layout"), None

    def _chosen_cameras(self) -> list[str]:
        for name in self.options.cameras:
            if name not in self._robot.cameras:
                raise UnknownName("camera", name, self._robot.cameras)
        return list(self.options.cameras or self._robot.cameras)

    def _limits(self) -> NDArray[np.float32]:
        """(2, D) lowest and highest targets."""
        arms = [self._context.kinematics(self._robot.name)[name] for name in sorted(self._robot.arms)]
        lower = np.concatenate([np.append(arm.lower, 0.0) for arm in arms])
        upper = np.concatenate([np.append(arm.upper, 1.0) for arm in arms])
        return np.stack([lower, upper]).astype(np.float32)

    def _longest(self) -> int:
        frames = [e.frames for e in accepted_episodes(self._run) if e.chain == self.options.chain]
        if not frames:
            raise MissingStage(
                f"{self._run.root} has no accepted episode of this task, so nothing says how long one may take",
                hint="collect some, or give --max-steps (in Python: max_steps=N)",
                maker="collect",
            )
        return int(np.ceil(PATIENCE * max(frames)))


def make_env(
    run: str | Path, context: StageContext | None = None, render_mode: str | None = None, **options: Any
) -> RunEnv:
    """Make the environment of a run.

    Example:
        >>> env = vcage.make_env("runs/blocks", pictures=False, environment_state=True)

    Args:
        run: folder of the run.
        context: the library, shared by environments of one process.
        render_mode: ``rgb_array`` or None, as Gymnasium asks for it; :meth:`RunEnv.render` needs pictures in any case.
        options: fields of :class:`EnvironmentOptions`.

    Raises:
        MissingStage, UnknownName, NoRenderer: see :class:`RunEnv`.
        UsageError: that render mode or option does not exist, or an option has another type.
    """
    if render_mode not in (None, "rgb_array"):
        raise UsageError(f"there is no render mode {render_mode!r}", hint="give 'rgb_array', or leave it out")
    return RunEnv(run, EnvironmentOptions.of(options), context)


def _ranges(name: str | None, collected: Mapping[str, Any]) -> Randomisation:
    """The ranges of that name, else those of the collection, else the default ones."""
    if name is None and "randomise" in collected:
        return Randomisation.model_validate(
            {"schema": Randomisation.SCHEMA, "description": "", **collected["randomise"]}
        )
    return load_randomisation(name or "light")
