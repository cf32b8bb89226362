"""Policies that an evaluation can ask, by how they are named: a server, a factory, the recording, or the expert."""

from __future__ import annotations

import importlib
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import InputFileError, UsageError, VcageError


class PolicyFailed(VcageError):
    """A policy raised an error, or answered what cannot be carried out: so it will again."""

    code = "policy_failed"
    exit_code = 5


class Policy(Protocol):
    """Anything that turns an observation into actions."""

    def reset(self) -> None:
        """An episode begins."""

    def infer(self, observation: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return ``actions``, (horizon, D) or (D,), for an observation (see :mod:`vcage.evaluation.payload`)."""


def checked_actions(answer: Any, size: int, policy: str) -> NDArray[np.float64]:
    """(horizon, D) the actions of an answer.

    Args:
        answer: of a policy.
        size: D, the numbers of an action.
        policy: its name, for the error.

    Raises:
        PolicyFailed: there are none, of another shape, or with NaN.
    """
    if not isinstance(answer, Mapping) or "actions" not in answer:
        keys = sorted(map(str, answer)) if isinstance(answer, Mapping) else type(answer).__name__
        raise PolicyFailed(f"{policy} answers without 'actions', but with {keys}", hint="answer a map with actions")
    try:
        actions = np.atleast_2d(np.asarray(answer["actions"]).astype(np.float64, casting="same_kind"))
    except (TypeError, ValueError) as error:
        raise PolicyFailed(f"{policy} answers actions that are no numbers: {error}") from error
    if actions.ndim != 2 or actions.shape[1] != size or not len(actions):
        raise PolicyFailed(
            f"{policy} answers actions of the shape {actions.shape}; expected (horizon, {size})",
            hint="evaluate a policy that was trained for this robot",
        )
    if not np.isfinite(actions).all():
        raise PolicyFailed(f"{policy} answers NaN or infinity", hint="check its normalisation")
    return actions


class LocalPolicy:
    """The policy that ``MODULE:FACTORY`` makes, in this process; the current folder's modules are found too.

    Args:
        factory: its name.

    Raises:
        UsageError: it is not of that form.
    """

    def __init__(self, factory: str):
        self._name = factory
        self._module, _, self._factory = factory.partition(":")
        if not (self._module and self._factory):
            raise UsageError(
                f"{factory!r} names no policy", hint="give ws://HOST:PORT, MODULE:FACTORY, replay or expert"
            )

    @cached_property
    def _made(self) -> Any:
        """The object that the factory makes, on first use: it may be large, and the process that plans needs none."""
        with self._errors_named():
            made = _found(self._name, self._module, self._factory)()
        if not callable(getattr(made, "infer", None)):
            raise InputFileError(f"{self._name} makes a {type(made).__name__} without infer(observation)")
        return made

    def reset(self) -> None:
        """Tell the policy that an episode begins, if it has ``reset``.

        Raises:
            InputFileError: there is no such module or factory, or what it makes has no ``infer``.
            PolicyFailed: the module, the factory or the policy raises an error; ``details`` has its traceback.
        """
        if callable(reset := getattr(self._made, "reset", None)):
            with self._errors_named():
                reset()

    def infer(self, observation: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return the policy's answer.

        Raises:
            InputFileError, PolicyFailed: as :meth:`reset`.
        """
        with self._errors_named():
            return self._made.infer(observation)

    @contextmanager
    def _errors_named(self) -> Iterator[None]:
        try:
            yield
        except VcageError:
            raise
        except (Exception, SystemExit) as error:  # any: the program is a user's, and must not end this one
            found = f"{self._name} raises {type(error).__name__}: {error}"
            raise PolicyFailed(found, details={"traceback": traceback.format_exc()}) from error


def _found(factory: str, module: str, name: str) -> Callable[[], Any]:
    here = str(Path.cwd())
    sys.path.insert(0, here)
    try:
        return getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError) as error:
        raise InputFileError(f"{factory} cannot be loaded: {error}", hint="check the names, or the folder") from error
    finally:
        sys.path.remove(here)
