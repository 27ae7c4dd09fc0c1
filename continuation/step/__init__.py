"""The tracer: settings, first point, attempts at a step, acceptance, loop."""
