"""The nine stages as commands: arguments in, one call of :mod:`vcage.pipeline`, one JSON line out."""
