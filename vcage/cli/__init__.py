"""The ``vcage`` command, and the entry of every script under ``skills/``."""

from vcage.cli.search_path import own_packages_first

own_packages_first()
