"""Deterministic stand-ins that need no key, no weights and no network: each does its real job in a simpler way."""

PROVIDER = "offline"
