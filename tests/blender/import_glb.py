"""Plays a .glb in Blender and compares every vertex at every frame with the result of the same flight.

blender -b --factory-startup --python-exit-code 1 -P import_glb.py -- FLIGHT.glb RESULT.json
"""

import json
import sys

import bpy
import numpy

# Debian 12's importer says numpy.bool, a name that numpy 1.24 no longer has.
if not hasattr(numpy, "bool"):
    numpy.bool = bool

LARGEST_GAP = 1e-5  # of the cloth's size


def imported(path):
    """The only mesh of the file, as an object of an otherwise empty scene."""
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=path)
    meshes = [item for item in bpy.context.scene.objects if item.type == "MESH"]
    assert len(meshes) == 1, f"{len(meshes)} meshes"
    return meshes[0]


def positions_at(item, time):
    """The vertices [N, 3] as Blender shows them `time` seconds after the first frame, y up again."""
    scene = bpy.context.scene
    frame = time * scene.render.fps / scene.render.fps_base
    scene.frame_set(int(frame), subframe=frame - int(frame))
    shown = item.evaluated_get(bpy.context.evaluated_depsgraph_get())
    corners = numpy.array([shown.matrix_world @ vertex.co for vertex in shown.data.vertices])
    return numpy.stack([corners[:, 0], corners[:, 2], -corners[:, 1]], axis=1)


def main():
    flight, result = sys.argv[sys.argv.index("--") + 1 :]
    with open(result, encoding="utf-8") as file:
        result = json.load(file)
    item = imported(flight)
    times = result["frames"]["times"]
    frames = result["frames"]["positions"]
    worst = 0.0
    for time, expected in zip(times, frames):
        found = positions_at(item, time)
        # Behind the mesh's own vertices stand the twins of those on a seam of the texture.
        assert len(found) >= len(expected), f"{len(found)} vertices of {len(expected)}"
        gap = numpy.linalg.norm(found[: len(expected)] - numpy.array(expected), axis=1).max()
        worst = max(worst, gap / result["size"])
    assert frames[-1] == result["final"]
    moved = numpy.linalg.norm(positions_at(item, times[-1]) - positions_at(item, 0), axis=1).min()
    assert moved > result["size"], f"it stands still: {moved} m"
    keys = {
        round(key.co[0] * bpy.context.scene.render.fps_base / bpy.context.scene.render.fps, 6)
        for curve in item.data.shape_keys.animation_data.action.fcurves
        for key in curve.keyframe_points
    }
    end = bpy.context.scene.frame_end / bpy.context.scene.render.fps
    print(f"{len(times)} frames, {len(frames[0])} vertices: the worst is {worst:.2e} of L off")
    assert abs(max(keys) - times[-1]) < 1e-4, f"the last key is at {max(keys)} s"
    assert end >= times[-1] - 1e-4, f"the animation ends at {end} s"
    assert worst <= LARGEST_GAP, f"{worst} is not <= {LARGEST_GAP}"


main()
