# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine: final pictures here, the viewport by `viewport.Viewport`.

The renderer's threads know nothing of Blender. Blender's data are read in `update` and `view_update` only, by the thread
that Blender calls; `render` looks after the renderer and hands its pictures over.
"""

import time
import traceback
from dataclasses import dataclass

import bpy
import numpy as np
import translucid

from . import mattes, settings
from .export.camera import depth_along_view, scene_camera
from .export.report import Report
from .export.scene import Exporter, build
from .process import memory_in_use
from .task import Task

# Seconds between two looks at a rendering, and between two of its pictures.
_NAP, _SHOWN_EVERY = 0.02, 0.5

_PREVIEW_SAMPLES = 32

# Blender's name, the renderer's layer, channels; and whether a view layer has it.
PASSES = (
    ("Depth", "depth", "Z", lambda layer: layer.use_pass_z),
    ("Normal", "normal", "XYZ", lambda layer: layer.use_pass_normal),
    ("Diffuse", "diffuse", "RGB", lambda layer: layer.translucid.use_diffuse),
    ("Glossy", "specular", "RGB", lambda layer: layer.translucid.use_glossy),
    ("Subsurface", "subsurface", "RGB", lambda layer: layer.translucid.use_subsurface),
    ("Emission", "emission", "RGB", lambda layer: layer.translucid.use_emission),
    ("Albedo", "albedo", "RGB", lambda layer: layer.translucid.use_albedo),
)

# Messages of the last rendering, for the panel.
last_messages = []


@dataclass
class _Frame:
    """Where a picture goes: Blender's result, its view layer, the keys of its camera, its size and region."""

    result: object
    layer: object
    camera: dict
    size: tuple
    region: tuple
    samples: int


class Cancelled(Exception):
    """The user wants no more."""


class TranslucidRenderEngine(bpy.types.RenderEngine):
    bl_idname = "TRANSLUCID"
    bl_label = "translucid"
    bl_use_preview = True
    bl_use_eevee_viewport = True
    bl_use_spherical_stereo = False

    # Blender makes engines itself, with arguments that differ by version: what they begin with is here.
    _session = None
    _viewport = None
    _description = None
    _report = None
    _error = None
    _layers = ()

    def _end(self):
        if self._session is not None:
            self._session.cancel()
            self._session = None

    def is_cancelled(self):
        """Whether the user wants no more."""
        return self.test_break()

    def _state(self, words):
        """Shows what is at work, in Blender's status line."""
        self.update_stats("", words)

    # --- final pictures

    def update_render_passes(self, scene, layer):
        self.register_pass(scene, layer, "Combined", 4, "RGBA", "COLOR")
        for name, _, channels, is_wanted in PASSES:
            if is_wanted(layer):
                kind = {"Z": "VALUE", "XYZ": "VECTOR"}.get(channels, "COLOR")
                self.register_pass(scene, layer, name, len(channels), channels, kind)
        for name in mattes.passes_of(layer):
            self.register_pass(scene, layer, name, 4, mattes.CHANNELS, "COLOR")

    def update(self, data, depsgraph):
        layer = depsgraph.view_layer.name
        if self._report is None or layer in self._layers:
            # Another picture; the layers of one share what is said.
            self._report, self._layers = Report(), ()
        self._layers = (*self._layers, layer)
        self._started = time.perf_counter()
        self._state("Exporting")
        try:
            exporter = Exporter(depsgraph, self._report, settings.model_of(depsgraph.scene), self.is_cancelled)
            self._description = exporter.describe()
        except InterruptedError:
            self._description = None
        except Exception as error:
            # Blender would print it, and show a black picture.
            traceback.print_exc()
            self._description, self._error = None, f"{type(error).__name__}: {error}"

    def render(self, depsgraph):
        scene, layer = depsgraph.scene, depsgraph.view_layer_eval
        samples = layer.samples or scene.translucid.samples
        size = (self.resolution_x, self.resolution_y) if self.is_preview else picture_size(scene)
        region = (0, 0, *size) if self.is_preview else picture_region(scene, *size)
        for name, _, channels, is_wanted in PASSES:
            if is_wanted(layer):
                self.add_pass(name, len(channels), channels, layer=layer.name)
        for name in mattes.passes_of(layer):
            self.add_pass(name, 4, mattes.CHANNELS, layer=layer.name)
        frame = _Frame(None, layer, None, size, region, min(samples, _PREVIEW_SAMPLES) if self.is_preview else samples)
        try:
            for view in _views(scene):
                if not self._render_view(depsgraph, scene, view, frame):
                    break
        finally:
            self._end()
            self._description = None

    def _render_view(self, depsgraph, scene, view, frame):
        """Renders what one eye sees, and says whether there is more to do."""
        self.active_view_set(view)
        left, top, right, bottom = frame.region
        # Blender wants a result, whatever happens.
        frame.result = self.begin_result(0, 0, right - left, bottom - top, layer=frame.layer.name, view=view)
        try:
            if self._error is not None:
                raise RuntimeError(f"the scene cannot be exported: {self._error}")
            if self._description is not None:
                self._render(depsgraph, scene, frame)
            return not self.is_cancelled()
        except Cancelled:
            return False
        except (translucid.SceneError, ValueError, RuntimeError, MemoryError) as error:
            # Shown by Blender, and raised by bpy.ops.render.render.
            self.report({"ERROR"}, f"translucid: {error}")
            return False
        finally:
            self.end_result(frame.result, cancel=False)

    def _render(self, depsgraph, scene, frame):
        frame.camera = self._camera(scene, depsgraph, *frame.size)
        self._session = session = self._prepared(scene, frame)
        session.start(frame.samples)
        self._watch(session, scene, frame.samples, lambda: self._show(frame, session, False))
        for matte in mattes.mattes_of(frame.layer, self._description):
            self._add_matte(frame, session, matte)
        self._show(frame, session, self._is_denoised(scene))

    def _add_matte(self, frame, session, matte):
        """Hands a Cryptomatte over, and the notes by which files name what is in it."""
        if self.is_cancelled():
            return
        self._state("Cryptomatte")
        task = Task(lambda: list(matte.values(session)))
        while not task.wait(_NAP):
            if self.is_cancelled():
                return
        for name, values in task.result():
            _hand_over(frame.result.layers[0].passes[name], values)
        for key, text in matte.notes().items():
            self.get_result().stamp_data_add_field(key, text)

    def _is_denoised(self, scene):
        return scene.translucid.use_denoising and not self.is_preview

    def _prepared(self, scene, frame):
        """A session, which another thread makes."""
        description = self._description
        film, model = settings.film_keys(scene, *frame.size), settings.model_of(scene)
        integrator = settings.integrator_keys(scene, frame.samples, model, is_denoised=self._is_denoised(scene))
        threads, device = settings.threads_of(scene), scene.translucid.device
        self._state("Preparing")

        def prepare():
            return translucid.Session(
                build(description, frame.camera, film, integrator), threads=threads, device=device, region=frame.region
            )

        task = Task(prepare)
        while not task.wait(_NAP):
            if self.is_cancelled():
                raise Cancelled
        session = task.result()
        for message in (*task.warnings, *session.notes):
            self._report.add("", None, message)
        self._say()
        return session

    def _camera(self, scene, depsgraph, width, height):
        owner = self.camera_override or scene.camera
        if owner is None:
            raise ValueError("the scene has no camera")
        if owner.type != "CAMERA":
            raise ValueError(f"the scene's camera, {owner.name}, is no camera")
        if scene.render.pixel_aspect_x != scene.render.pixel_aspect_y:
            self._report.add("scene", None, "pixels that are not square cannot be rendered; they are square")
        if scene.render.use_motion_blur:
            self._report.add("scene", None, "motion blur cannot be rendered; all is as at the frame")
        owner = owner.evaluated_get(depsgraph)
        eye = self.camera_model_matrix(owner), self.camera_shift_x(owner) - owner.data.shift_x
        return scene_camera(owner, depsgraph, width, height, self._report, eye)

    def _say(self):
        if self.is_preview:
            return
        for message in self._report.unsaid():
            self.report({"WARNING"}, f"translucid: {message}")
        last_messages[:] = self._report.messages

    def _watch(self, session, scene, samples, show):
        """Waits for the samples, the user or the time limit."""
        limit = scene.translucid.time_limit
        shown = begun = time.perf_counter()
        while session.is_running:
            now = time.perf_counter()
            if self.is_cancelled():
                session.cancel()
                return
            done = session.samples
            if limit > 0 and now - begun >= limit and done > 0:
                session.cancel()
                return
            share = done / samples if limit == 0 else max(done / samples, min((now - begun) / limit, 1))
            self.update_progress(share)
            used, peak = memory_in_use()
            self.update_memory_stats(memory_used=used, memory_peak=peak)
            self._state(f"Time {now - self._started:.1f} s | Memory {used:.0f} M | Sample {done}/{samples}")
            if not bpy.app.background and now - shown >= _SHOWN_EVERY:
                show()
                shown = time.perf_counter()
            time.sleep(_NAP)
        session.wait()
        self.update_progress(1.0)

    def _show(self, frame, session, denoise):
        """Hands the layers over: Blender's first row is the lowest."""
        radiance = session.snapshot("radiance")
        if denoise and not self.is_cancelled():
            radiance = self._denoised(session, radiance)
        passes = frame.result.layers[0].passes
        picture = np.concatenate([radiance, session.snapshot("alpha")], axis=2)
        _hand_over(passes["Combined"], picture)
        for name, ours, _, is_wanted in PASSES:
            taken = passes.get(name)
            if taken is None or not is_wanted(frame.layer):
                continue
            values = session.snapshot(ours)
            if ours == "depth":
                values = depth_along_view(values, frame.camera, frame.size, frame.region)[..., None]
            _hand_over(taken, values)
        self.update_result(frame.result)

    def _denoised(self, session, radiance):
        self._state("Denoising")
        task = Task(lambda: session.snapshot("denoised"))
        while not task.wait(_NAP):
            if self.is_cancelled():
                return radiance
        try:
            return task.result()
        except RuntimeError as error:
            self.report({"WARNING"}, f"translucid: not denoised: {error}")
            return radiance

    # --- the viewport

    def view_update(self, context, depsgraph):
        if self._viewport is None:
            # Drawing needs a display, which Blender in the background has not.
            from .viewport import Viewport

            self._viewport = Viewport()
        self._viewport.update(depsgraph)

    def view_draw(self, context, depsgraph):
        if self._viewport is None:
            self.view_update(context, depsgraph)
        self._viewport.draw(self, context, depsgraph)


def _views(scene):
    """The names of a picture's views: one for each eye, or one without a name."""
    render = scene.render
    return [view.name for view in render.views if view.use] if render.use_multiview else [""]


def picture_size(scene):
    """Width and height of a scene's picture in pixels."""
    render = scene.render
    share = render.resolution_percentage / 100
    return max(int(render.resolution_x * share), 1), max(int(render.resolution_y * share), 1)


def picture_region(scene, width, height):
    """The pixels to render: from the upper left to just before the lower right."""
    render = scene.render
    if not render.use_border:
        return 0, 0, width, height
    left, right = int(render.border_min_x * width), int(render.border_max_x * width)
    bottom, top = int(render.border_min_y * height), int(render.border_max_y * height)
    return left, height - top, right, height - bottom


def _hand_over(render_pass, values):
    render_pass.rect.foreach_set(np.ascontiguousarray(values[::-1], dtype=np.float32).ravel())


class TranslucidLayerSettings(bpy.types.PropertyGroup):
    use_diffuse: bpy.props.BoolProperty(name="Diffuse", description="Light that matte surfaces reflect")
    use_glossy: bpy.props.BoolProperty(name="Glossy", description="Light that interfaces reflect or refract")
    use_subsurface: bpy.props.BoolProperty(name="Subsurface", description="Light that has traveled below a surface")
    use_emission: bpy.props.BoolProperty(name="Emission", description="Light straight from emitters")
    use_albedo: bpy.props.BoolProperty(name="Albedo", description="Albedo of the first surface")


def register():
    bpy.utils.register_class(TranslucidLayerSettings)
    bpy.types.ViewLayer.translucid = bpy.props.PointerProperty(type=TranslucidLayerSettings)
    bpy.utils.register_class(TranslucidRenderEngine)


def unregister():
    bpy.utils.unregister_class(TranslucidRenderEngine)
    del bpy.types.ViewLayer.translucid
    bpy.utils.unregister_class(TranslucidLayerSettings)
