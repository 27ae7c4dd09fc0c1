"""A homotopy as the engine sees it: evaluations counted, derivatives from wherever they come."""
