"""One step: settings, start, attempt, acceptance, loop."""
