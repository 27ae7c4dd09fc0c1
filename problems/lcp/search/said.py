"""What is said where an attempt settled the problem, with attributes of the case in braces."""

PROVED = "A linear program gave the proof."
TRIED = "All complementary faces were tried: excluded by floats with error bounds, or decided in exact arithmetic."
FOLLOWED = "Solved by the path of the {case.followed} homotopy."
SETTLED = "Solved by active sets alone, before any path."
LEMKE_HOWSON = "By the method of Lemke and Howson{case.compiled}, before any path."
LEMKE = "By Lemke's method{case.compiled}, before any path."
SETTLED_SHIFTED = "Solved by active sets of A + shift I, before any path."
DESCENDED = "Solved by descent of the quadratic function in the box: a point that satisfies its optimality conditions."
AUGMENTED = "By the augmented Lagrangian of the program, before any path."
RESTARTED = "{case.restarted}"
BRANCHED = "The complementary faces were enumerated in groups, by {case.branching.nodes} linear programs."
DESCENDED_TO = (
    "By descent of weighted minima of x and w from vertex to vertex, in {case.descents.programs} linear programs."
)
