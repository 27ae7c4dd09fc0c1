"""The version of the library, for what is written by it."""

__version__ = "0.1.0"
