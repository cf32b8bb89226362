"""The space of instructions, which Gymnasium's AsyncVectorEnv carries too.

Of text in shared memory Gymnasium 1.4 makes strings once, before any episode begins, and shows these for ever. Here
they are made when they are looked at.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, overload

from gymnasium.spaces import Text
from gymnasium.vector.utils import read_from_shared_memory


class Instruction(Text):
    """A sentence."""


class _SharedSentences(Sequence[str]):
    """The sentences of n environments, as they are in shared memory when one is looked at."""

    def __init__(self, space: Text, memory: Any, n: int):
        self._space, self._memory, self._n = space, memory, n

    def __len__(self) -> int:
        return self._n

    @overload
    def __getitem__(self, index: int) -> str: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[str]: ...
    def __getitem__(self, index: int | slice) -> str | Sequence[str]:
        read: Callable[..., Any] = read_from_shared_memory.dispatch(Text)
        return read(self._space, self._memory, self._n)[index]

    def __deepcopy__(self, _memo: dict[int, Any]) -> tuple[str, ...]:
        return tuple(self[:])


@read_from_shared_memory.register(Instruction)
def _read(space: Instruction, shared_memory: Any, n: int = 1) -> _SharedSentences:
    return _SharedSentences(space, shared_memory, n)
