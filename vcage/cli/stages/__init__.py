"""The nine stages as commands: arguments in, one call of :mod:`vcage.stages`, one JSON line out."""
