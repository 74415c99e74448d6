"""Reads a flight's point caches and numbered meshes in Blender and compares every vertex at every frame
with the result of the same flight.

blender -b --factory-startup --python-exit-code 1 -P read_caches.py -- START.obj FOLDER FIRST_FRAME
"""

import json
import pathlib
import sys

import bpy
import numpy

LARGEST_GAP = 1e-5  # of the cloth's size


def import_obj(path):
    """The only mesh of the file, its vertices in their order and y up as in the file."""
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.wm.obj_import(filepath=str(path), forward_axis="Y", up_axis="Z")
    return bpy.context.scene.objects[0]


def positions(item):
    """The vertices [N, 3] as Blender shows them now."""
    shown = item.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return numpy.array([shown.matrix_world @ vertex.co for vertex in shown.data.vertices])


def cached(start, cache, frames):
    """The vertices at each of the frames, as a Mesh Cache modifier plays them."""
    item = import_obj(start)
    modifier = item.modifiers.new("cache", "MESH_CACHE")
    modifier.cache_format = cache.suffix[1:].upper()
    modifier.filepath = str(cache)
    modifier.frame_start = frames[0]
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        yield positions(item)


def numbered(folder, frames):
    for frame in frames:
        yield positions(import_obj(folder / f"flight-{frame:04}.obj"))


def main():
    start, folder, first = sys.argv[sys.argv.index("--") + 1 :]
    folder = pathlib.Path(folder)
    with open(folder / "flight.json", encoding="utf-8") as file:
        result = json.load(file)
    expected = result["frames"]["positions"]
    frames = range(int(first), int(first) + len(expected))
    ways = {
        "PC2": cached(start, folder / "flight.pc2", frames),
        "MDD": cached(start, folder / "flight.mdd", frames),
        "OBJ": numbered(folder, frames),
    }
    for name, found in ways.items():
        gaps = [
            numpy.linalg.norm(shape - numpy.array(right), axis=1).max() / result["size"]
            for shape, right in zip(found, expected, strict=True)
        ]
        print(f"{name}: {len(gaps)} frames, {len(expected[0])} vertices: the worst is {max(gaps):.2e} of L off")
        assert max(gaps) <= LARGEST_GAP, f"{name}: {max(gaps)} is not <= {LARGEST_GAP}"


main()
