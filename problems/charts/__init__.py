"""Ready studies for ``continuation chart``; an entry point names each module's function `studies`."""
