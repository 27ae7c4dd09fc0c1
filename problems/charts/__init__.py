"""Ready studies for ``continuation chart``: functions `studies` of modules, named by entry points."""
