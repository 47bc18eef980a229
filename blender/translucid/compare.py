# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare: the picture with two models, and their difference."""

import bpy
import numpy as np
import translucid

from . import settings
from .engine import picture_region, picture_size
from .export.camera import scene_camera
from .export.report import Report
from .export.scene import Cache, Exporter, build
from .export.value import LUMINANCE
from .task import Task


class _Comparison:
    """Renders descriptions one after the other, on a thread of its own."""

    def __init__(self, jobs, samples, threads):
        self._jobs, self._samples, self._threads = jobs, samples, threads
        self.session, self.is_cancelled, self.done = None, False, 0

    def run(self):
        pictures = []
        for description, camera, film, integrator, region in self._jobs:
            if self.is_cancelled:
                return None
            scene = build(description, camera, film, integrator)
            self.session = translucid.Session(scene, threads=self._threads, region=region)
            self.session.run(self._samples)
            pictures.append(self.session.snapshot())
            self.done += 1
        return None if self.is_cancelled else pictures

    @property
    def share(self):
        now = self.session.samples / self._samples if self.session is not None and self.done < 2 else 0
        return min((self.done + now) / 2, 1.0)

    def cancel(self):
        self.is_cancelled = True
        if self.session is not None:
            self.session.cancel()


class TRANSLUCID_OT_compare(bpy.types.Operator):
    """Render the camera's picture, or its region, with the scene's model and with another, and show the difference"""

    bl_idname = "translucid.compare"
    bl_label = "Compare Models"

    @classmethod
    def poll(cls, context):
        return context.scene.camera is not None

    def execute(self, context):
        self._begin(context)
        self._task.wait(None)
        return self._finish(context)

    def invoke(self, context, event):
        self._begin(context)
        manager = context.window_manager
        manager.progress_begin(0, 100)
        self._timer = manager.event_timer_add(0.1, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self._comparison.cancel()
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        context.window_manager.progress_update(100 * self._comparison.share)
        if not self._task.is_done:
            return {"RUNNING_MODAL"}
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        return self._finish(context)

    def _begin(self, context):
        scene, depsgraph = context.scene, context.evaluated_depsgraph_get()
        width, height = picture_size(scene)
        region = picture_region(scene, width, height)
        report, cache = Report(), Cache()
        camera = scene_camera(scene.camera.evaluated_get(depsgraph), depsgraph, width, height, report)
        samples = scene.translucid.compare_samples
        film = settings.film_keys(scene, width, height)
        other = scene.translucid.compare_model
        self._names = [scene.translucid.model, other]
        jobs = []
        for model in (settings.model_of(scene), None if other == "NODE" else other):
            cache.forget_materials()
            integrator = settings.integrator_keys(scene, samples, model)
            jobs.append((Exporter(depsgraph, report, model, cache=cache).describe(), camera, film, integrator, region))
        self._comparison = _Comparison(jobs, samples, settings.threads_of(scene))
        self._task = Task(self._comparison.run)

    def _finish(self, context):
        try:
            pictures = self._task.result()
        except (translucid.SceneError, ValueError, RuntimeError, MemoryError) as error:
            self.report({"ERROR"}, f"translucid: {error}")
            return {"CANCELLED"}
        if pictures is None:
            return {"CANCELLED"}
        a, b = pictures
        titles = ["As the nodes say" if name == "NODE" else name for name in self._names]
        show(f"translucid: {titles[0]}", a)
        show(f"translucid: {titles[1]}" + (" again" if titles[0] == titles[1] else ""), b)
        image = show("translucid: difference", difference(a, b))
        for area in context.screen.areas if context.screen else ():
            if area.type == "IMAGE_EDITOR":
                area.spaces.active.image = image
        change = 100 * (b.mean(axis=(0, 1)) / np.maximum(a.mean(axis=(0, 1)), 1e-12) - 1)
        self.report({"INFO"}, f"{titles[1]} beside {titles[0]}: red {change[0]:+.1f} %, green {change[1]:+.1f} %, blue {change[2]:+.1f} %")
        return {"FINISHED"}


def difference(a, b):
    """Red where the second picture has more light, blue where it has less; 1 is the mean luminance of the first."""
    change = (b - a) @ LUMINANCE / max(float((a @ LUMINANCE).mean()), 1e-12)
    return np.stack([np.maximum(change, 0), np.zeros_like(change), np.maximum(-change, 0)], axis=-1)


def show(name, picture):
    """Puts a linear picture into an image of Blender's."""
    height, width = picture.shape[:2]
    image = bpy.data.images.get(name)
    if image is None or tuple(image.size) != (width, height):
        if image is not None:
            bpy.data.images.remove(image)
        image = bpy.data.images.new(name, width, height, float_buffer=True)
    pixels = np.ones((height, width, 4), dtype=np.float32)
    pixels[..., :3] = picture[::-1]
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    return image


def register():
    bpy.utils.register_class(TRANSLUCID_OT_compare)


def unregister():
    bpy.utils.unregister_class(TRANSLUCID_OT_compare)
