"""V-CAGE: an instruction in plain language goes in, a verified robot-manipulation dataset comes out."""

__version__ = "0.1.0"
