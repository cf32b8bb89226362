"""Deterministic stand-ins that need no key, no weights and no network: each does its real job in a simpler way.

Which module answers what is asked in :mod:`vcage.models.protocols`:

- ``Reasoner`` (``reasoner``): ``select_assets`` in ``selection`` (and ``refusals``), ``plan_layout`` in
  ``layout``, ``judge_pairs`` in ``pairs``, ``read_goals`` in ``goals`` (over ``naming``);
- ``ImageEditor`` in ``editor``;
- ``Critic`` in ``critic``.

An instruction is read from the bottom up: ``tokens`` by the ``lexicon``, noun ``phrases``, and ``instruction``, which
reads clauses and resolves pronouns. ``catalogue_match`` says which entries of the catalogue a phrase may mean,
``naming``, strictly, which objects of a scene it does.
"""

from vcage.models.protocols import OFFLINE as PROVIDER

__all__ = ["PROVIDER"]
