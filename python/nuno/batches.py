"""Many shots: on threads of this machine, or on a Dask cluster."""

from __future__ import annotations

import csv
import os
import pathlib
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, Iterable, Mapping, NamedTuple, Sequence, Union

from ._core import DivergedError, InputError, OnOneCore, Result, Scene, Stop
from .scenes import PathLike, make_scene, read_scene
from .searches import optimize, optimization_of

#: A scene, its fields, a scene file, or a folder of them (*.json).
ShotInput = Union[Scene, Mapping[str, Any], PathLike]


class Shot(NamedTuple):
    """What became of one shot of a batch: a result, or why there is none."""

    name: str
    #: The flight at the best gain; None where the shot is broken or diverged.
    result: Result | None
    #: "ok", "diverged" or "broken", as `nuno batch` has it.
    status: str
    #: Why there is no result; empty where there is one.
    reason: str


def batch(
    shots: Iterable[ShotInput] | PathLike,
    *,
    client: Any = None,
    jobs: int | None = None,
    **search: Any,
) -> list[Shot]:
    """Throws many scenes, each at its best gain, and returns a Shot for each, in their order.

    `shots` are scenes, their fields as dicts, scene files, and folders of them. `client` is a
    `distributed.Client` of a Dask cluster, whose workers have `nuno` too; without one, `jobs`
    threads of this machine work, by default as many as it has cores. Each shot takes one core. `search` is what `optimize`
    takes: backend, error_limit, refine, ...

    A shot that is broken or diverges is told in its Shot and does not stop the others. A worker that
    dies costs its shots a retry on another. Results are the same bits, wherever they are made. Files
    are read here, so that workers need not see them.
    """
    listed = listed_shots(shots)
    if client is not None:
        futures = [
            (name, client.submit(throw_shot, name, scene, search, pure=False))
            for name, scene in map(loaded, listed)
        ]
        return [result_of(name, future) for name, future in futures]
    stop = Stop()

    def throw_here(name: str, scene: Scene | str) -> Shot:
        with stop:
            return throw_shot(name, scene, search)

    with ThreadPoolExecutor(jobs or os.cpu_count()) as pool:
        waiting: list[Future[Shot]] = []
        try:
            for shot in listed:
                waiting.append(pool.submit(throw_here, *loaded(shot)))
            return [each.result() for each in waiting]
        except BaseException:
            for each in waiting:
                each.cancel()
            stop.request()  # and those that fly
            raise


#: The columns of `write_summary` that are a result's numbers, as `nuno batch` has them.
columns = (
    "alpha",
    "error",
    "relative_error",
    "max_error",
    "centroid_error",
    "control_effort",
    "sensitivity",
    "steps",
    "evaluations",
)


def write_summary(path: PathLike, shots: Sequence[Shot]) -> None:
    """Writes a table of a batch (CSV), a line for each shot, with the columns of `nuno batch`."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["shot", "status", *columns, "reason"])
        for shot in shots:
            table.writerow([shot.name, shot.status, *numbers_of(shot.result), shot.reason])


def numbers_of(result: Result | None) -> list[Any]:
    if result is None:
        return [""] * len(columns)
    evaluations = optimization_of(result).get("evaluations", "")
    return [*(getattr(result, column) for column in columns[:-1]), evaluations]


def listed_shots(shots: Iterable[ShotInput] | PathLike) -> list[ShotInput]:
    given: list[ShotInput] = []
    listed: list[ShotInput] = []
    if isinstance(shots, (str, os.PathLike)):
        given.append(shots)
    else:
        given.extend(shots)
    for shot in given:
        if not isinstance(shot, (str, os.PathLike)) or not os.path.isdir(shot):
            listed.append(shot)
            continue
        inside = sorted(map(str, pathlib.Path(shot).glob("*.json")))
        if not inside:
            raise InputError(f"{os.fspath(shot)}: is a folder without a *.json")
        listed.extend(inside)
    return listed


def loaded(shot: ShotInput) -> tuple[str, Scene | str]:
    """A shot's name and scene, or why it has none."""
    name = os.fspath(shot) if isinstance(shot, (str, os.PathLike)) else "scene"
    try:
        if isinstance(shot, Scene):
            return shot.source, shot
        if isinstance(shot, Mapping):
            name = str(shot.get("name", name))
            return name, make_scene(shot, source=name)
        return name, read_scene(shot)
    except InputError as error:
        return name, str(error)


def result_of(name: str, future: Any) -> Shot:
    """What a cluster made of a shot; one that has killed every worker it met is broken."""
    try:
        shot: Shot = future.result()
        return shot
    except Exception as error:
        return Shot(name, None, "broken", f"{name}: {error}")


def throw_shot(name: str, scene: Scene | str, search: Mapping[str, Any]) -> Shot:
    """What a worker does."""
    if isinstance(scene, str):
        return Shot(name, None, "broken", scene)
    try:
        with OnOneCore():  # the others are for other shots
            return Shot(name, optimize(scene, **search), "ok", "")
    except DivergedError as error:
        return Shot(name, None, "diverged", str(error))
    except InputError as error:
        return Shot(name, None, "broken", str(error))
