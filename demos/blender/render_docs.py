"""Renders the pictures of docs/packages.md from nuno's own exports.

blender -b --factory-startup -P demos/blender/render_docs.py -- build/nuno docs
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import bpy
import numpy
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

numpy.bool = bool  # Blender 3.4's importer of glTF asks a later numpy for it

NUNO, DOCS = map(Path, sys.argv[sys.argv.index("--") + 1 :])
SHEETS = Path(__file__).parent.parent / "scenes" / "sheets"
WORK = Path(tempfile.mkdtemp(prefix="nuno-docs-"))

FIRST, LAST = (0.30, 0.42, 0.55), (0.50, 0.03, 0.03)  # colours at launch and at arrival
AFTER = (0.85, 0.42, 0.06)


def nuno(*arguments):
    subprocess.run([NUNO, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)


def begin():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 48
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y = 720, 330
    scene.render.image_settings.file_format = "WEBP"
    scene.render.image_settings.quality = 85
    scene.view_settings.view_transform = "Standard"
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    sky = scene.world.node_tree.nodes["Background"].inputs
    sky["Color"].default_value, sky["Strength"].default_value = (0.9, 0.94, 1, 1), 0.45
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy, sun.angle = 1.6, 0.1
    lamp = bpy.data.objects.new("sun", sun)
    lamp.rotation_euler = (0.6, 0.25, 0.4)
    scene.collection.objects.link(lamp)


def plain(color):
    material = bpy.data.materials.new("cloth")
    material.use_nodes = True
    inputs = material.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value, inputs["Roughness"].default_value = (*color, 1), 0.85
    inputs["Specular"].default_value = 0.2
    return material


def checkered(one, other, scale):
    material = plain(one)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    checker, place = nodes.new("ShaderNodeTexChecker"), nodes.new("ShaderNodeTexCoord")
    checker.inputs["Color1"].default_value = (*one, 1)
    checker.inputs["Color2"].default_value = (*other, 1)
    checker.inputs["Scale"].default_value = scale
    links.new(place.outputs["UV"], checker.inputs["Vector"])
    links.new(checker.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    return material


def imported_glb(path):
    bpy.ops.import_scene.gltf(filepath=str(path))
    (item,) = [each for each in bpy.context.scene.objects if each.type == "MESH"]
    return item


def pose(item, time, material=None):
    """A copy of the object as it is `time` seconds after the first frame."""
    scene = bpy.context.scene
    frame = time * scene.render.fps / scene.render.fps_base
    scene.frame_set(int(frame), subframe=frame % 1)
    shown = item.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = bpy.data.meshes.new_from_object(shown)
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    if material:
        mesh.materials.clear()
        mesh.materials.append(material)
    copy = bpy.data.objects.new("pose", mesh)
    copy.matrix_world = shown.matrix_world
    scene.collection.objects.link(copy)
    return copy


def on_the_way(item, arrival, count):
    """Poses from launch to arrival, from the first colour to the last."""
    shares = [k / (count - 1) for k in range(count)]
    colors = [[a + share * (b - a) for a, b in zip(FIRST, LAST)] for share in shares]
    return [pose(item, share * arrival, plain(color)) for share, color in zip(shares, colors)]


def points_of(items):
    return [item.matrix_world @ vertex.co for item in items for vertex in item.data.vertices]


def render(name, items, hidden, direction=(0.25, -1, 0.4)):
    """The objects on a floor below them, all of them in the picture."""
    scene = bpy.context.scene
    bpy.context.view_layer.update()
    points = points_of(items)
    low = Vector(map(min, zip(*points)))
    middle = (low + Vector(map(max, zip(*points)))) / 2
    bpy.ops.mesh.primitive_plane_add(size=200, location=(middle.x, middle.y, low.z - 0.25))
    bpy.context.object.data.materials.append(plain((0.5, 0.5, 0.48)))
    hidden.hide_render = True
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    toward = Vector(direction).normalized()
    camera.rotation_euler = toward.to_track_quat("Z", "Y").to_euler()
    distance = 1.0
    while True:
        camera.location = middle + distance * toward
        bpy.context.view_layer.update()
        seen = [world_to_camera_view(scene, camera, point) for point in points]
        if all(0.04 < at.x < 0.96 and 0.08 < at.y < 0.92 and at.z > 0 for at in seen):
            break
        distance *= 1.02
    scene.render.filepath = str(DOCS.resolve() / f"{name}.webp")
    bpy.ops.render.render(write_still=True)


def drawn_line():
    """Drawings in: two paths of an SVG, thrown as a ribbon."""
    begin()
    drawing = WORK / "shot.svg"
    drawing.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="5000mm" height="2000mm" viewBox="0 0 5000 2000">'
        '<path id="initial" d="M 300,1000 h 1200"/>'
        '<path id="target" d="M 3600,700 c 200,-350 500,-200 400,100 s 150,500 400,150"/></svg>'
    )
    nuno("throw", drawing, "--time", 1, "--out", WORK / "ribbon.glb", "--ribbon-width", 0.35)
    ribbon = imported_glb(WORK / "ribbon.glb")
    render("blender-ribbon", on_the_way(ribbon, 1, 7), ribbon)


def shape_key():
    """Meshes in, and out again as an animated .glb."""
    begin()
    nuno("optimize", SHEETS / "square-to-s.json", "--out", WORK / "square.glb")
    square = imported_glb(WORK / "square.glb")
    render("blender-sheet", on_the_way(square, 1.2, 6), square)


def mesh_cache():
    """A cache on an object of one's own: its modifiers and material stay."""
    begin()
    nuno("optimize", SHEETS / "napkin-over-an-edge.json", "--out", WORK / "napkin.pc2")
    bpy.ops.import_scene.obj(filepath=str(SHEETS / "napkin-over-an-edge-start.obj"), split_mode="OFF")
    (napkin,) = bpy.context.selected_objects
    places = napkin.data.uv_layers.new().data
    for loop in napkin.data.loops:
        at = napkin.data.vertices[loop.vertex_index].co
        places[loop.index].uv = (2 * at.x, 2 * at.z)
    napkin.data.materials.clear()
    napkin.data.materials.append(checkered((0.9, 0.88, 0.84), LAST, 12))
    cache = napkin.modifiers.new("cache", "MESH_CACHE")
    cache.cache_format, cache.filepath, cache.frame_start = "PC2", str(WORK / "napkin.pc2"), 1
    napkin.modifiers.new("smooth", "SUBSURF").render_levels = 2
    napkin.modifiers["smooth"].levels = 2
    napkin.modifiers.new("hem", "SOLIDIFY").thickness = 0.006
    bpy.context.scene.render.fps = 60  # the scene file's
    start = 1 / 60  # frame 1
    poses = [pose(napkin, start + 1.5 * share) for share in (0.95, 0.975, 1)]
    render("blender-mesh-cache", poses, napkin, (0.6, -1, 0.5))


def tail():
    """Free flight after the arrival."""
    begin()
    nuno("optimize", SHEETS / "flag-to-half-pipe.json", "--tail", 0.3, "--out", WORK / "flag.glb")
    flag = imported_glb(WORK / "flag.glb")
    poses = [pose(flag, 1.2 - before, plain(FIRST)) for before in (0.3, 0.15)]
    poses += [pose(flag, 1.2, plain(LAST))]
    poses += [pose(flag, 1.2 + after, plain(AFTER)) for after in (0.15, 0.3)]
    render("blender-tail", poses, flag)


for picture in (drawn_line, shape_key, mesh_cache, tail):
    picture()
