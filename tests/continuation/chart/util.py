"""A method that fails."""


def boom(problem, rung):
    raise ArithmeticError("on purpose")
