"""The version of the library, for what is written by it."""

__version__ = "0.2.0"
