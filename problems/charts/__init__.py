"""The ready studies of ``continuation chart``: each module has a function `studies` that an entry point names."""
