"""Scenes out of files, fields and arrays."""

from __future__ import annotations

import json
import os
from typing import Any, Mapping, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._core import InputError, Scene

PathLike = Union[str, "os.PathLike[str]"]
#: A file, or points: (points, 2) of a chain's line, (vertices, 3) of a sheet's mesh.
Shape = Union[PathLike, npt.ArrayLike]
#: The vertices around each face, from 0 on: 3 of a triangle, 4 of a quad.
Faces = Union[Sequence[Sequence[int]], npt.NDArray[np.integer[Any]]]


def read_scene(path: PathLike) -> Scene:
    """Reads a scene file (JSON), a chain's or a sheet's.

    Raises InputError for what breaks a rule, in the words of the program `nuno`.
    """
    return _core.scene_of_file(os.fspath(path))


def make_scene(
    fields: Mapping[str, Any] | None = None,
    /,
    *,
    faces: Faces | None = None,
    source: str = "scene",
    **more: Any,
) -> Scene:
    """Makes a scene from the fields of a scene file, given as a dict, as keywords, or both.

    `initial` and `target` are lines of a chain [m], arrays of shape (points, 2); or, with `faces`,
    poses of a sheet [m], arrays of shape (vertices, 3); or paths of two mesh files. `arrival_time`
    [s] is required; all other fields have defaults. `source` names the scene in messages.

    Raises InputError for what breaks a rule, in the words of the program `nuno`.
    """
    given = {"nuno_scene": 1, **(fields or {}), **more}
    shapes = {name: given.get(name) for name in ("initial", "target")}
    if any(shape is None or is_path(shape) for shape in shapes.values()):
        return _core.scene_of_text(to_json(given, source), source)
    for name in shapes:
        del given[name]
    points = {name: points_of(shape, f"{source}: /{name}") for name, shape in shapes.items()}
    return _core.scene_of_points(
        to_json(given, source), source, points["initial"], points["target"], faces_of(faces)
    )


def throw_scene(
    start: Shape,
    target: Shape | None = None,
    *,
    time: float,
    material: str | None = None,
    frames_per_second: float | None = None,
    settle: bool = False,
    faces: Faces | None = None,
) -> Scene:
    """Makes the scene of `throw`, which see for the parameters."""
    request = _core.ThrowRequest(time, material, frames_per_second, settle)
    if is_path(start):
        end = "" if target is None else os.fspath(target)  # type: ignore[arg-type]
        return _core.throw_files(request, os.fspath(start), end)  # type: ignore[arg-type]
    if target is None:
        raise InputError("TARGET: is missing; only a file can hold both shapes")
    return _core.throw_points(
        request,
        points_of(start, "throw: /initial"),
        points_of(target, "throw: /target"),
        faces_of(faces),
    )


def is_path(shape: object) -> bool:
    return isinstance(shape, (str, os.PathLike))


def points_of(shape: object, at: str) -> npt.NDArray[np.float64]:
    try:
        return np.asarray(shape, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"{at}: is not an array of points: {error}") from None


def faces_of(faces: Faces | None) -> list[list[int]]:
    if faces is None:
        return []
    try:
        return [[int(corner) for corner in face] for face in faces]
    except (TypeError, ValueError) as error:
        raise InputError(f"faces: are not lists of vertices: {error}") from None


def to_json(fields: Mapping[str, Any], source: str) -> str:
    def plain(value: Any) -> Any:
        if isinstance(value, (np.ndarray, np.generic)):
            return value.tolist()
        if isinstance(value, os.PathLike):
            return os.fspath(value)
        raise InputError(f"{source}: /: {value!r} has no place in a scene")

    return json.dumps(fields, default=plain)
