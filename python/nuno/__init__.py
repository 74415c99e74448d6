"""Throws a cloth so that it arrives at the place, in the shape and at the moment that were drawn.

A chain is a cloth in the plane, drawn as a line; a sheet is a mesh in space, in two poses. Lengths
are in metres, times in seconds, gains in N/m; y is up. Arrays have particles in rows, x, y (and z)
in columns. What is wrong with an input is an InputError, a ValueError, in the words of the program
`nuno`; a flight that diverges is a DivergedError. Ctrl-C ends any work, and other threads of Python
run meanwhile.
"""

from ._core import (
    Backend,
    DivergedError,
    InputError,
    OutputError,
    Result,
    Scene,
    Simulation,
    __version__,
    materials,
    verdict,
)
from .batches import Shot, batch, write_summary
from .scenes import make_scene, read_scene, throw_scene
from .searches import (
    Comparison,
    compare,
    optimization_of,
    optimize,
    simulate,
    throw,
)

__all__ = [
    "Backend",
    "Comparison",
    "DivergedError",
    "InputError",
    "OutputError",
    "Result",
    "Scene",
    "Shot",
    "Simulation",
    "__version__",
    "batch",
    "compare",
    "make_scene",
    "materials",
    "optimization_of",
    "optimize",
    "read_scene",
    "simulate",
    "throw",
    "throw_scene",
    "verdict",
    "write_summary",
]
