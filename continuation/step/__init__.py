"""One step: settings, start, state, the attempt, its acceptance, and the loop."""
