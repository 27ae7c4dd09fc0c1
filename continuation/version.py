"""The version of the library, for whoever says which one was at work."""

__version__ = "0.1.0"
