"""What the tests share: the program that the module must agree with, and scenes."""

import json
import os
import pathlib
import subprocess

PROGRAM = os.environ["NUNO_PROGRAM"]
SOURCE = pathlib.Path(os.environ["NUNO_SOURCE"])
SCENES = SOURCE / "demos" / "scenes"
SHEETS = SCENES / "sheets"

RIGHT = {
    "particles": 8,
    "arrival_time": 0.5,
    "initial": [[0, 1], [1, 1]],
    "target": [[2, 1], [2.5, 1.3], [3, 1]],
}

#: A flight of minutes, on Box2D of half an hour: a chain at a step that is far too short.
LONG = {**RIGHT, "particles": 1000, "arrival_time": 100, "time_step": 2e-5}


def run(*arguments):
    """The program's result, but for what a clock says."""
    done = subprocess.run([PROGRAM, *map(str, arguments), "--out", "-"], capture_output=True)
    assert done.returncode == 0, done.stderr
    return timeless(json.loads(done.stdout))


def complaint(*arguments):
    """The one line with which the program refuses."""
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode in (2, 3), done
    return done.stderr.strip().removeprefix("nuno: ")


def timeless(value):
    if isinstance(value, dict):
        return {name: timeless(each) for name, each in value.items() if name != "seconds"}
    if isinstance(value, list):
        return [timeless(each) for each in value]
    return value
