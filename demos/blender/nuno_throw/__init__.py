"""Throws a cloth from the pose of one object to that of another with the program nuno."""

bl_info = {
    "name": "nuno: throw a cloth",
    "blender": (3, 4, 0),
    "version": (0, 1, 0),
    "location": "3D View > Sidebar > nuno",
    "description": "Throw a cloth so that it arrives in the pose that you modelled",
    "category": "Animation",
}

import pathlib
import shutil
import subprocess
import tempfile
import time

import bpy

from . import shapes

MATERIALS = [("", "Default", "A light cotton-like cloth")] + [
    (name, name.capitalize(), f"{name.capitalize()}, as measured") for name in ("cotton", "silk", "denim", "wool")
]


class Refusal(Exception):
    """What cannot be thrown, in words for the panel."""


def rate(scene):
    """Frames per second of the scene."""
    return scene.render.fps / scene.render.fps_base


class Throw:
    """A run of nuno for what the panel says, in the background."""

    def __init__(self, context):
        settings = context.scene.nuno_throw
        start, target, shape_key = chosen(context)
        if settings.arrival_frame <= settings.first_frame:
            raise Refusal(f"Arrival: frame {settings.arrival_frame} is not after frame {settings.first_frame}")
        self.context = context
        self.first_frame = settings.first_frame
        self.folder = tempfile.TemporaryDirectory(prefix="nuno-")
        self.files = pathlib.Path(self.folder.name)
        self.began = time.monotonic()
        try:
            self.cloth = shapes.cloth_of(context, start, target, shape_key)
            inputs = self.cloth.write(self.files)
            self.process = subprocess.Popen(
                [program(context), "throw", *map(str, inputs), *options(context.scene, self.cloth)]
                + ["--out", str(self.files / "flight.pc2")],
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
            )
        except shapes.Unusable as problem:
            self.folder.cleanup()
            raise Refusal(str(problem)) from problem
        except OSError as problem:
            self.folder.cleanup()
            raise Refusal(f"nuno did not start: {problem}") from problem

    def is_done(self):
        return self.process.poll() is not None

    def cancel(self):
        self.process.terminate()
        self.process.communicate()
        self.folder.cleanup()

    def finish(self):
        """The flight as a new object, and nuno's summary. Raises Refusal with nuno's own words."""
        words, _ = self.process.communicate()
        try:
            if self.process.returncode != 0:
                raise Refusal(words.strip().replace(self.folder.name + "/", ""))
            frames = shapes.read_pc2(self.files / "flight.pc2")
        finally:
            self.folder.cleanup()
        return self.cloth.animate(self.context, frames, self.first_frame), words


def chosen(context):
    """Start, target and shape key: of the panel, or else of the selection, in which the target is active."""
    settings = context.scene.nuno_throw
    if settings.start is not None:
        return settings.start, settings.target, settings.shape_key
    selected, active = context.selected_objects, context.view_layer.objects.active
    if len(selected) == 2 and active in selected:
        (start,) = (item for item in selected if item != active)
        return start, active, ""
    if len(selected) == 1 and selected[0].active_shape_key is not None:
        return selected[0], None, selected[0].active_shape_key.name
    raise Refusal("Start: choose the cloth as it is, or select it, and then its target")


def program(context):
    """The path of nuno: that of the preferences, or one on the PATH."""
    entry = context.preferences.addons.get(__package__)
    chosen = entry.preferences.program if entry else ""
    found = bpy.path.abspath(chosen) if chosen else shutil.which("nuno")
    if not found or not pathlib.Path(found).is_file():
        raise Refusal("The program nuno is not there: set its path in the add-on's preferences")
    return found


def options(scene, cloth):
    settings = scene.nuno_throw
    seconds = (settings.arrival_frame - settings.first_frame) / rate(scene)
    words = ["--time", repr(seconds), "--frames-per-second", repr(rate(scene))]
    if settings.material and cloth.has_material:
        words += ["--material", settings.material]
    if settings.error > 0:
        words += ["--error-limit", repr(settings.error / 100)]
    if settings.settle:
        words.append("--settle")
    return words


class Settings(bpy.types.PropertyGroup):
    """What the panel asks for."""

    start: bpy.props.PointerProperty(name="Start", type=bpy.types.Object, description="The cloth as it is: a mesh or a curve")
    target: bpy.props.PointerProperty(
        name="Target", type=bpy.types.Object, description="The cloth as it should be; empty: the start's shape key"
    )
    shape_key: bpy.props.StringProperty(name="Shape Key", description="Of the start, in place of a target object")
    first_frame: bpy.props.IntProperty(name="Thrown at", default=1, min=0, description="Frame of the throw")
    arrival_frame: bpy.props.IntProperty(name="Arrives at", default=31, min=1, description="Frame of the arrival")
    material: bpy.props.EnumProperty(name="Material", items=MATERIALS)
    error: bpy.props.FloatProperty(
        name="Error", default=0, min=0, max=100, subtype="PERCENTAGE",
        description="Least force within this error, over the cloth's size; 0: least error",
    )
    settle: bpy.props.BoolProperty(name="Come to Rest", description="The shape is at rest at arrival")
    words: bpy.props.StringProperty(options={"SKIP_SAVE"})


class NUNO_OT_throw(bpy.types.Operator):
    """Throw the cloth; Esc ends the search"""

    bl_idname = "nuno.throw"
    bl_label = "Throw"
    bl_options = {"REGISTER", "UNDO"}

    def begin(self, context):
        try:
            self.throw = Throw(context)
        except Refusal as refusal:
            return self.refuse(context, refusal)
        return None

    def end(self, context):
        try:
            _, words = self.throw.finish()
        except Refusal as refusal:
            return self.refuse(context, refusal)
        context.scene.nuno_throw.words = words
        return {"FINISHED"}

    def refuse(self, context, refusal):
        context.scene.nuno_throw.words = str(refusal)
        self.report({"ERROR"}, str(refusal))
        return {"CANCELLED"}

    def execute(self, context):
        refused = self.begin(context)
        if refused:
            return refused
        self.throw.process.wait()
        return self.end(context)

    def invoke(self, context, _event):
        refused = self.begin(context)
        if refused:
            return refused
        self.timer = context.window_manager.event_timer_add(0.2, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self.throw.cancel()
            context.scene.nuno_throw.words = "cancelled"
            return self.leave(context, {"CANCELLED"})
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if not self.throw.is_done():
            seconds = time.monotonic() - self.throw.began
            context.workspace.status_text_set(f"nuno searches the best flight: {seconds:.0f} s; Esc cancels")
            return {"PASS_THROUGH"}
        return self.leave(context, self.end(context))

    def leave(self, context, status):
        context.window_manager.event_timer_remove(self.timer)
        context.workspace.status_text_set(None)
        return status


class NUNO_PT_throw(bpy.types.Panel):
    """The add-on in the sidebar."""

    bl_label = "Throw a cloth"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "nuno"

    def draw(self, context):
        settings = context.scene.nuno_throw
        layout = self.layout
        layout.use_property_split = True
        layout.prop(settings, "start")
        layout.prop(settings, "target")
        keys = getattr(settings.start.data, "shape_keys", None) if settings.start else None
        if settings.target is None and keys:
            layout.prop_search(settings, "shape_key", keys, "key_blocks")
        layout.prop(settings, "first_frame")
        layout.prop(settings, "arrival_frame")
        layout.prop(settings, "material")
        layout.prop(settings, "error")
        layout.prop(settings, "settle")
        layout.operator("nuno.throw", icon="PLAY")
        for line in settings.words.splitlines()[:12]:
            layout.label(text=line.strip())


class NUNO_preferences(bpy.types.AddonPreferences):
    """Where the program is."""

    bl_idname = __package__
    program: bpy.props.StringProperty(name="nuno", subtype="FILE_PATH", description="The program; empty: that on the PATH")

    def draw(self, _context):
        self.layout.prop(self, "program")


CLASSES = (Settings, NUNO_OT_throw, NUNO_PT_throw, NUNO_preferences)


def register():
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Scene.nuno_throw = bpy.props.PointerProperty(type=Settings)


def unregister():
    del bpy.types.Scene.nuno_throw
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
