"""Flights and searches over scenes."""

from __future__ import annotations

import json
from typing import Any, Sequence, TypedDict, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._core import Result, Scene
from .scenes import Faces, Shape, throw_scene


class ComparisonRow(TypedDict):
    """What one engine made of a scene; errors in m, gains in N/m."""

    backend: str
    launch_only_error: float
    alpha: float
    error: float
    max_error: float
    centroid_error: float
    control_effort: float
    max_strain: float
    sensitivity: float
    evaluations: int
    seconds: float
    error_with_the_other_alpha: float


class ShapeDifference(TypedDict):
    """End shapes of both engines at one gain, centroids aligned, over the cloth's size."""

    at_alpha: float
    mean: float
    max: float


class Comparison(TypedDict):
    """Two engines on one scene.

    `alpha_curve` holds arrays of shape (gains,): `alpha` [N/m], E(alpha) [m] by each engine's name,
    infinite where a flight diverged, `control_effort` by name, and `sensitivity` and `max_strain`
    of the first engine.
    """

    scene: str
    rows: list[ComparisonRow]
    shape_difference: ShapeDifference
    alpha_curve: dict[str, Any]


def simulate(
    scene: Scene,
    alpha: Union[float, Sequence[float], npt.NDArray[np.float64]] = 0.0,
    *,
    backend: str = "native",
    tail: float = 0.0,
    reference_correction: npt.ArrayLike | None = None,
) -> Result:
    """Throws the cloth once.

    `alpha` is the gain of the shape control [N/m], >= 0; 0 is launch only; several are gains by
    group of modes, from the longest waves to the rest. `tail` [s] is free flight after the arrival,
    whose frames are kept as well. `reference_correction` [m] is what `optimize` with `refine` found:
    (4, particles, dimension), the `reference_correction` of its result.

    Raises InputError, and DivergedError.
    """
    gains = np.atleast_1d(np.asarray(alpha, dtype=np.float64)).tolist()
    correction = (
        None if reference_correction is None else np.asarray(reference_correction, dtype=np.float64)
    )
    return _core.simulate(scene, gains, backend, tail, correction)


def optimize(
    scene: Scene,
    *,
    backend: str = "native",
    optimizer: str | None = None,
    error_limit: float | None = None,
    effort_limit: float | None = None,
    coefficients: int = 1,
    refine: bool = False,
    robust: bool = False,
    tail: float = 0.0,
) -> Result:
    """Finds the best gain, and throws the cloth at it.

    `optimizer` is "global" (the default) or "steepest-descent". `error_limit`, over the cloth's size
    L, asks for the least control effort within it; `effort_limit` for the least error within it.
    `coefficients` are 1 to 4 gains by group of modes. `refine` then turns the motion, and the launch
    along it, until the cloth arrives on the target. `robust` prefers a gain whose answer is not
    fragile. `tail` as of `simulate`.

    Raises InputError, and DivergedError.
    """
    return _core.optimize(
        scene,
        backend,
        optimizer,
        error_limit,
        effort_limit,
        coefficients,
        refine,
        robust,
        tail,
    )


def throw(
    start: Shape,
    target: Shape | None = None,
    *,
    time: float,
    material: str | None = None,
    backend: str = "native",
    frames_per_second: float | None = None,
    settle: bool = False,
    error_limit: float | None = None,
    tail: float = 0.0,
    faces: Faces | None = None,
) -> Result:
    """Throws a mesh or a drawn line so that it arrives as another shape of itself.

    `start` and `target` are files, as of `nuno throw`, or arrays [m]: (points, 2) of a line, or with
    `faces` (vertices, 3) of a mesh. `time` is the arrival time [s], `material` one of `materials()`
    for a mesh, `frames_per_second` [1/s] that of the animation (24). With `settle` the cloth comes
    to rest on the target. `error_limit` and `tail` as of `optimize`.

    The cloth follows a damped motion from the first shape to the second, at the gain of least error.
    Raises InputError, and DivergedError.
    """
    scene = throw_scene(
        start,
        target,
        time=time,
        material=material,
        frames_per_second=frames_per_second,
        settle=settle,
        faces=faces,
    )
    return optimize(scene, backend=backend, error_limit=error_limit, tail=tail)


def compare(scene: Scene) -> Comparison:
    """Puts the two engines that fly such a cloth side by side, as `nuno compare` does.

    Raises DivergedError where a flight that is needed diverged.
    """
    comparison: Comparison = json.loads(_core.compare_json(scene))["scenes"][0]
    comparison["alpha_curve"] = arrays_of(comparison["alpha_curve"])
    return comparison


def optimization_of(result: Result) -> dict[str, Any]:
    """How the gain of a result was searched, as a result file says it; empty where none was."""
    text = result.optimization_json
    return dict(json.loads(text)) if text else {}


def arrays_of(curve: dict[str, Any]) -> dict[str, Any]:
    return {
        name: arrays_of(values)
        if isinstance(values, dict)
        else np.array([np.inf if value is None else value for value in values])
        for name, values in curve.items()
    }
