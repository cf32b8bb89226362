"""What keeps a run folder: the context of its stages, finished and stale work, edits, and who is at work."""
