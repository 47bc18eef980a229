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
from .export.scene import Cache, Exporter, build
from .live import Live
from .task import Task

# Seconds that a picture in motion may take, and the fewest pixels along its longer edge.
_FRAME, _FEWEST = 1 / 30, 128

# Seconds between two looks at what is rendered.
_TICK = 1 / 30

# Seconds that an edit may keep Blender waiting, so that small ones show at once.
_PATIENCE = 0.03

# How much coarser the pictures before the full one are.
_COARSEST = 16

_shown = weakref.WeakSet()


class Viewport:
    """What a region shows. Blender's engine comes along with each call: it may be gone between them."""

    def __init__(self):
        self._cache, self._wanted = Cache(), None
        self._task = None
        self._live = None
        self._failure = None
        self._view = None
        self._coarseness = _COARSEST
        self._seconds_per_pixel = 1e-6
        self._texture, self._texture_key = None, None
        self._report = Report()
        # The time at which the view on the screen was asked for and drawn.
        self.moved_at = self.drawn_at = None
        _shown.add(self)
        _watch()

    def end(self):
        """Ends what runs; what a task is at it leaves."""
        _shown.discard(self)
        if self._live is not None:
            self._live.stop()

    @property
    def messages(self):
        return self._report.messages

    # --- the scene

    def update(self, context, depsgraph):
        scene = depsgraph.scene
        if self._wanted is not None:
            self._forget(depsgraph)
        self._report = Report()
        exporter = Exporter(depsgraph, self._report, settings.model_of(scene), cache=self._cache)
        description = exporter.describe()
        integrator = settings.integrator_keys(scene, scene.translucid.preview_samples)
        film = settings.film_keys(scene, 64, 64)
        del film["size"]
        self._wanted = (description, film, integrator, settings.threads_of(scene))
        self._failure = None
        self._follow()
        if self._task is not None and self._task.wait(_PATIENCE):
            self._arrive()

    def _forget(self, depsgraph):
        """Drops what has changed from what is known."""
        for update in depsgraph.updates:
            changed = update.id
            if isinstance(changed, bpy.types.Object):
                if update.is_updated_geometry:
                    self._cache.forget_mesh(changed.name_full)
            elif isinstance(changed, bpy.types.Material):
                self._cache.forget_material(changed.name_full)
            elif isinstance(changed, (bpy.types.NodeTree, bpy.types.Image)):
                self._cache.forget_materials()
                self._cache.environment = None
            elif isinstance(changed, (bpy.types.World, bpy.types.Scene)):
                self._cache.environment = None
                if settings.model_of(depsgraph.scene) != self._model:
                    self._cache.forget_materials()
            elif isinstance(changed, bpy.types.ID) and update.is_updated_geometry:
                self._cache.forget_mesh(changed.name_full)
        self._model = settings.model_of(depsgraph.scene)

    _model = None
