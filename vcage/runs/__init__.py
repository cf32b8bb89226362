"""Keeping a run folder: the context of its stages, finished and stale work, edits, and the process at work."""
