"""The ``vcage`` command, and the entry of every script under ``skills/``."""
