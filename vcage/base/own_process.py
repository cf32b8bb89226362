"""A note on this process: the command line sets it, and the start of workers reads it."""

runs_a_command = False
"""The process runs a command of V-CAGE and nothing else. Until something is drawn it has no threads that a fork would
lack."""
