"""Shapes of Blender's objects as nuno reads them, and nuno's flights as Blender's objects.

All in world space. nuno has y up and Blender z: (x, y, z) there is (x, -z, y) here.
"""

import struct

import bpy
import numpy


class Unusable(Exception):
    """What is no cloth, in words."""


def to_nuno(points):
    return numpy.stack([points[:, 0], points[:, 2], -points[:, 1]], axis=1)


def to_blender(points):
    return numpy.stack([points[..., 0], -points[..., 2], points[..., 1]], axis=-1)


def coordinates(vertices):
    """Of a mesh's vertices or a shape key's points [N, 3]."""
    flat = numpy.empty(3 * len(vertices))
    vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3)


def transformed(points, matrix):
    matrix = numpy.array(matrix)
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def read_pc2(path):
    """The frames of a point cache [frames, N, 3], in nuno's axes."""
    data = path.read_bytes()
    _signature, _version, points, _start, _rate, frames = struct.unpack_from("<12siiffi", data)
    return numpy.frombuffer(data, "<f4", offset=32).reshape(frames, points, 3).astype(float)


def cloth_of(context, start, target, shape_key):
    """The cloth of a start and a target object, or of a start and one of its shape keys."""
    if start.type == "CURVE":
        if target is None or target.type != "CURVE":
            raise Unusable("Target: a curve is thrown to another curve")
        return CurveCloth(context, start, target)
    if start.type != "MESH":
        raise Unusable(f"Start: {start.name} is neither a mesh nor a curve")
    if target is not None and target.type != "MESH":
        raise Unusable(f"Target: {target.name} is not a mesh, as the start is")
    return MeshCloth(context, start, target, shape_key)


def animated(context, name, mesh, frames, first_frame):
    """A new object whose absolute shape keys are the frames [frames, N, 3], one for each of the scene's."""
    item = bpy.data.objects.new(name, mesh)
    context.scene.collection.objects.link(item)
    for number, shape in enumerate(frames):
        key = item.shape_key_add(name=f"frame {first_frame + number}", from_mix=False)
        key.data.foreach_set("co", shape.ravel())
        key.interpolation = "KEY_LINEAR"
    keys = mesh.shape_keys
    keys.use_relative = False
    for frame, block in ((first_frame, keys.key_blocks[0]), (first_frame + len(frames) - 1, keys.key_blocks[-1])):
        keys.eval_time = block.frame
        keys.keyframe_insert("eval_time", frame=frame)
    for point in keys.animation_data.action.fcurves[0].keyframe_points:
        point.interpolation = "LINEAR"
    context.scene.frame_end = max(context.scene.frame_end, first_frame + len(frames) - 1)
    for other in context.selected_objects:
        other.select_set(False)
    item.select_set(True)
    context.view_layer.objects.active = item
    return item


class MeshCloth:
    """A mesh in two poses: those that modifiers, parents and scales make of the objects."""

    has_material = True

    def __init__(self, context, start, target, shape_key):
        if target is not None:
            self.start = evaluated(context, start)
            self.target_points = coordinates(evaluated(context, target, faces_of=self.start).vertices)
        else:
            keys = start.data.shape_keys
            if keys is None or shape_key not in keys.key_blocks:
                raise Unusable("Target: choose an object, or a shape key of the start")
            if start.modifiers:
                raise Unusable("Target: a shape key of an object with modifiers is no pose; apply them first")
            self.start = without_shape_keys(start.data)
            self.start.vertices.foreach_set("co", coordinates(keys.reference_key.data).ravel())
            self.start.transform(start.matrix_world)
            self.target_points = transformed(coordinates(keys.key_blocks[shape_key].data), start.matrix_world)
        self.name = f"{start.name} thrown"

    def write(self, folder):
        """The two poses as OBJ files, in nuno's axes."""
        faces = "".join(
            "f " + " ".join(str(vertex + 1) for vertex in face.vertices) + "\n" for face in self.start.polygons
        )
        paths = []
        for name, points in (("start", coordinates(self.start.vertices)), ("target", self.target_points)):
            paths.append(folder / f"{name}.obj")
            lines = "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in to_nuno(points).tolist())
            paths[-1].write_text(lines + faces, encoding="utf-8")
        return paths

    def animate(self, context, frames, first_frame):
        return animated(context, self.name, self.start, to_blender(frames), first_frame)


def without_shape_keys(mesh):
    copy = mesh.copy()
    holder = bpy.data.objects.new("nuno", copy)
    holder.shape_key_clear()
    bpy.data.objects.remove(holder)
    return copy


def evaluated(context, item, faces_of=None):
    """A new mesh of what is seen of an object, in world space; with the faces of another, if given."""
    depsgraph = context.evaluated_depsgraph_get()
    seen = item.evaluated_get(depsgraph)
    mesh = bpy.data.meshes.new_from_object(seen, preserve_all_data_layers=True, depsgraph=depsgraph)
    mesh.transform(item.matrix_world)
    if faces_of is None:
        return mesh
    if len(mesh.vertices) != len(faces_of.vertices) or len(mesh.polygons) != len(faces_of.polygons):
        raise Unusable(
            f"Target: {item.name} has {len(mesh.vertices)} vertices and {len(mesh.polygons)} faces, "
            f"the start {len(faces_of.vertices)} and {len(faces_of.polygons)}: it is no pose of it"
        )
    for number, (face, other) in enumerate(zip(mesh.polygons, faces_of.polygons)):
        if tuple(face.vertices) != tuple(other.vertices):
            raise Unusable(f"Target: face {number} of {item.name} is another than the start's: it is no pose of it")
    return mesh


class CurveCloth:
    """Two curves in one upright plane, seen edge-on: a chain. It comes back as a ribbon."""

    has_material = False

    def __init__(self, context, start, target):
        shapes = [polyline(context, each) for each in (start, target)]
        points = numpy.concatenate(shapes)
        self.origin = points.mean(axis=0)
        ground = (points - self.origin)[:, :2]
        _, size, axes = numpy.linalg.svd(ground, full_matrices=False)
        if size[1] > 1e-3 * max(numpy.ptp(points, axis=0).max(), 1e-12) * len(points) ** 0.5:
            raise Unusable("Start and target do not lie in one upright plane: a curve flies in a plane")
        self.along = numpy.array([*axes[0], 0.0])
        if self.along[numpy.abs(self.along).argmax()] < 0:
            self.along = -self.along
        self.up = numpy.array([0.0, 0.0, 1.0])
        self.aside = numpy.cross(self.along, self.up)
        self.curves = [
            numpy.stack([(each - self.origin) @ self.along, each[:, 2]], axis=1) for each in shapes
        ]
        self.name = f"{start.name} thrown"

    def write(self, folder):
        paths = []
        for name, curve in zip(("start", "target"), self.curves):
            paths.append(folder / f"{name}.csv")
            paths[-1].write_text("".join(f"{x!r},{y!r}\n" for x, y in curve.tolist()), encoding="utf-8")
        return paths

    def animate(self, context, frames, first_frame):
        count = frames.shape[1] // 2
        mesh = bpy.data.meshes.new(self.name)
        quads = [(i, i + 1, count + i + 1, count + i) for i in range(count - 1)]
        base = self.origin - self.origin[2] * self.up
        shown = base + frames[..., :1] * self.along + frames[..., 1:2] * self.up + frames[..., 2:] * self.aside
        mesh.from_pydata(shown[0].tolist(), [], quads)
        return animated(context, self.name, mesh, shown, first_frame)


def polyline(context, item):
    """The points of a curve's only spline, in world space [N, 3]."""
    data = item.data.copy()
    data.bevel_depth = data.extrude = 0
    data.bevel_object = None
    bare = bpy.data.objects.new("nuno", data)
    try:
        mesh = bare.to_mesh()
        points = transformed(coordinates(mesh.vertices), item.matrix_world)
        splines = len(data.splines)
        bare.to_mesh_clear()
    finally:
        bpy.data.objects.remove(bare)
        bpy.data.curves.remove(data)
    if splines != 1 or len(points) < 2:
        raise Unusable(f"{item.name} has {splines} splines and {len(points)} points; one spline is thrown")
    return points
