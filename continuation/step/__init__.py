"""One step: settings, start, state, attempt, acceptance and loop."""
