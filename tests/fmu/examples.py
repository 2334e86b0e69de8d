"""Models of this repository that are exported and run in FMPy."""

EXAMPLES = [
    "examples/bouncing_ball.mol",
    "examples/equalisation.mol",
    "examples/oscillator.mol",
    "examples/stick_slip.mol",
    "examples/valve22.mol",
    "examples/valve32.mol",
    "examples/valve52.mol",
    "examples/valve53.mol",
    "tests/fmu/models.mo:Hybrid.Inputs",
    "tests/fmu/models.mo:Hybrid.Ticks",
    "tests/fmu/models.mo:Hybrid.Delayed",
    "tests/fmu/models.mo:Hybrid.Pendulum",
]
