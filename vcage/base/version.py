"""The version of the library, which every record and every episode is marked with."""

__version__ = "0.2.0"
