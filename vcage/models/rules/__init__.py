"""Deterministic stand-ins that need no key, no weights and no network: each does its real job in a simpler way.

Modules for the questions of :mod:`vcage.models.protocols`:

- ``Reasoner`` (``reasoner``): ``select_assets`` in ``selection``, ``plan_layout`` in ``layout``, ``judge_pairs`` in
  ``pairs``, ``read_goals`` in ``goals``;
- ``ImageEditor`` in ``editor``;
- ``Critic`` in ``critic``.

An instruction is one of the sentences of ``instruction.lark`` (docs/instructions.md lists the forms). ``sentence``
makes commands of it in every way that it can be read, ``nouns`` says how well a noun phrase names a kind, ``meanings``
which objects of a scene it means, ``goals`` what pronouns stand for and what is asked for.
Readings that differ are refused.
"""

from vcage.models.protocols import OFFLINE as PROVIDER

__all__ = ["PROVIDER"]
