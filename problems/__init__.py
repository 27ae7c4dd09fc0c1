"""Problems for the engine: complementarity, nonlinear, bifurcation, the paper."""
