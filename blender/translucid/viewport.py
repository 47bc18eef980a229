# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered view of a 3D viewport.

`update` reads what Blender says has changed, and a task brings the session to it. `draw` sees the view itself, since
Blender does not tell when it moves: while it does, small pictures are rendered at once, and then ever finer ones.
"""

import time
import weakref

import bpy
import gpu
import numpy as np
import translucid
from gpu_extras.presets import draw_texture_2d

from . import settings
from .export.camera import camera_keys, lens_of
from .export.report import Report
from .export.scene import Cache, Exporter
from .live import Live, Target
from .task import Task

# Seconds that a picture in motion may take, and the fewest pixels along its longer edge.
_FRAME, _FEWEST = 1 / 30, 128

# Seconds between two looks at what is rendered.
_TICK = 1 / 30

# How often a viewport that is not drawn is asked for again: one that Blender has dropped must not have it draw for ever.
_CALLS = 90

# Seconds that an edit may keep Blender waiting, so that small ones show at once.
_PATIENCE = 0.03

# By how much each picture is finer than the one before, until it is as fine as the screen.
_REFINEMENT = 4

_shown = weakref.WeakSet()


class Viewport:
    """What a region shows. Blender's engine is not kept: it may be gone between two calls."""

    def __init__(self):
        self._cache, self._live = Cache(), Live()
        self._target = self._followed = None
        self._task, self._failure = None, None
        self._model = None
        self._view = None
        self._edge, self._samples = _FEWEST, 0
        self._seconds_per_pixel = 2e-6
        self._texture, self._drawn = None, None
        self._report = Report()
        # How often it was asked for since it was drawn.
        self.calls = 0
        # When the view or the scene last changed, and when a picture of it was first drawn.
        self.changed_at = self.answered_at = None
        _shown.add(self)

    def __del__(self):
        # Blender drops its engine, and with it this, without a word.
        self.end()

    def end(self):
        """Ends what runs; a task at work is left to itself."""
        _shown.discard(self)
        if self._task is None:
            self._live.stop()

    @property
    def messages(self):
        return self._report.messages

    # --- the scene

    def update(self, depsgraph):
        scene = depsgraph.scene
        self._forget(depsgraph)
        self._report = Report()
        description = Exporter(depsgraph, self._report, self._model, cache=self._cache).describe()
        film = settings.film_keys(scene, 1, 1)
        del film["size"]
        # Points would be laid and lit anew for every edit, which may take minutes.
        samples, model = scene.translucid.preview_samples, settings.model_of(scene)
        integrator = settings.integrator_keys(scene, samples, model, method="ray-traced")
        self._target = Target(description, film, integrator, settings.threads_of(scene), scene.translucid.device)
        self._failure = None
        self._follow()
        if self._task is not None and self._task.wait(_PATIENCE):
            self._arrive()
        watch()

    def _forget(self, depsgraph):
        """Drops what has changed from what is known."""
        model = settings.model_of(depsgraph.scene)
        if model != self._model:
            self._cache.forget_materials()
            self._model = model
        for update in depsgraph.updates:
            changed = update.id
            if isinstance(changed, bpy.types.Material):
                self._cache.forget_material(changed.name_full)
            elif isinstance(changed, (bpy.types.NodeTree, bpy.types.Image)):
                self._cache.forget_materials()
                self._cache.environment = None
            elif isinstance(changed, (bpy.types.World, bpy.types.Scene)):
                self._cache.environment = None
            elif update.is_updated_geometry:
                self._cache.forget_mesh(changed.name_full)

    def _follow(self):
        """Starts a task that brings the session to the target, unless one is at work."""
        if self._task is None and self._target is not self._followed and self._failure is None:
            self._followed = target = self._target
            self.changed_at = time.perf_counter()
            # Without this object, which would keep itself after Blender has dropped it
            live = self._live
            self._task = Task(lambda: live.follow(target))

    def _arrive(self):
        """Takes what a task that is done has brought."""
        task, self._task = self._task, None
        try:
            if task.result():
                self._view = None
            for message in task.warnings:
                self._report.add("", None, message)
        except (translucid.SceneError, ValueError, RuntimeError, MemoryError) as error:
            self._failure = str(error)
            print(f"translucid: {error}")
        self._follow()

    # --- the view

    def draw(self, engine, context, depsgraph):
        self.calls = 0
        if self._task is not None and self._task.is_done:
            self._arrive()
        view = self._view_of(context)
        if self._failure is not None:
            engine.update_stats("translucid", self._failure)
        elif self._task is None and self._live.session is not None:
            self._render(view, context.scene.translucid.preview_samples)
            engine.update_stats("translucid", f"Sample {min(self._samples, self._goal)}/{self._goal}")
        else:
            engine.update_stats("translucid", "Preparing")
        self._paint(engine, depsgraph.scene, view[1])
        watch()

    _goal = 0

    def _view_of(self, context):
        """The keys of the camera, and the size of the region."""
        region, view = context.region, context.region_data
        size = (max(region.width, 1), max(region.height, 1))
        world_from_camera = np.array(view.view_matrix.inverted())
        lens = None
        if view.view_perspective == "CAMERA" and context.scene.camera is not None:
            if context.scene.camera.type == "CAMERA":
                lens = lens_of(context.scene.camera)
        elif view.view_perspective == "ORTHO":
            # Blender looks along both sides of the point that the view turns about.
            world_from_camera[:3, 3] += world_from_camera[:3, 2] * context.space_data.clip_end / 2
        return camera_keys(world_from_camera, view.window_matrix, lens), size

    def _render(self, view, samples):
        """Has the view rendered: at once and coarse where it is new, then finer behind what is shown."""
        longest = max(view[1])
        if view != self._view:
            if self._view is not None:
                self.changed_at = time.perf_counter()
            self._view, self._samples = view, 0
            self._edge = min(max(int((_FRAME / self._seconds_per_pixel) ** 0.5), _FEWEST), longest)
            self._begin(samples)
            begun = time.perf_counter()
            self._live.session.run(1)
            size = self._live.session.size
            self._seconds_per_pixel = (time.perf_counter() - begun) / (size[0] * size[1])
            self._take()
            return
        done = self._live.session.samples
        if done > self._samples:
            self._take()
        if not self._live.session.is_running and self._samples >= self._goal and self._edge < longest:
            self._edge = min(self._edge * _REFINEMENT, longest)
            self._samples = 0
            self._begin(samples)
            self._live.session.start(self._goal)
        elif not self._live.session.is_running and done < self._goal:
            self._live.session.start(self._goal)

    def _begin(self, samples):
        camera, size = self._view
        share = self._edge / max(size)
        self._goal = samples if share == 1 else 1
        self._live.look(camera, tuple(max(round(edge * share), 1) for edge in size))

    def _take(self):
        """Takes the picture as it is, as a texture."""
        self._samples = self._live.session.samples
        if self._samples == 0:
            return
        picture = self._live.picture()
        height, width = picture.shape[:2]
        pixels = gpu.types.Buffer("FLOAT", picture.size, picture.ravel())
        self._texture = gpu.types.GPUTexture((width, height), format="RGBA32F", data=pixels)
        if self.answered_at is None or self.answered_at < (self.changed_at or 0):
            self.answered_at = time.perf_counter()

    def _paint(self, engine, scene, size):
        if self._texture is None:
            return
        gpu.state.blend_set("ALPHA_PREMULT")
        engine.bind_display_space_shader(scene)
        draw_texture_2d(self._texture, (0, 0), *size)
        engine.unbind_display_space_shader()
        gpu.state.blend_set("NONE")

    @property
    def is_at_work(self):
        """Whether there is or will be something to draw."""
        if self._failure is not None:
            return False
        if self._task is not None:
            return self._task.is_done
        session = self._live.session
        if session is None or self._view is None:
            return True
        return session.samples > self._samples or (not session.is_running and not self.is_finished)

    @property
    def is_finished(self):
        """Whether the picture on the screen is the last one."""
        if self._task is not None or self._view is None:
            return False
        return self._edge >= max(self._view[1]) and self._samples >= self._goal


def watch():
    """Looks after the viewports until there are none."""
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=_TICK)


def _tick():
    if not _shown:
        return None
    waiting = [viewport for viewport in _shown if viewport.calls < _CALLS and viewport.is_at_work]
    for viewport in waiting:
        viewport.calls += 1
    if waiting:
        for window in bpy.context.window_manager.windows:
            for area in window.screen.areas:
                if area.type == "VIEW_3D" and area.spaces.active.shading.type == "RENDERED":
                    for region in area.regions:
                        if region.type == "WINDOW":
                            region.tag_redraw()
    return _TICK


def unregister():
    for viewport in list(_shown):
        viewport.end()
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
