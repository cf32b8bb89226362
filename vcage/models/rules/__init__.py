"""Deterministic stand-ins that need no key, no weights and no network: each does its real job in a simpler way.

Which module answers what is asked in :mod:`vcage.models.protocols`:

- ``Reasoner`` (:mod:`reasoner`): ``select_assets`` in :mod:`selection` (and :mod:`refusals`), ``plan_layout`` in
  :mod:`layout`, ``judge_pairs`` in :mod:`pairs`, ``compose_chain`` in :mod:`chain`;
- ``ImageEditor`` in :mod:`editor`;
- ``Critic`` in :mod:`critic`.

An instruction is read from the bottom up: :mod:`words`, noun :mod:`phrases`, :mod:`clauses`, and :mod:`instruction`,
which resolves pronouns. :mod:`catalogue_match` says which entries of the catalogue a phrase means.
"""

PROVIDER = "offline"
