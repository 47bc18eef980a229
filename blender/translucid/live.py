# SPDX-License-Identifier: GPL-3.0-or-later
"""A session that follows a description: what has changed is edited, all else stays prepared. Knows nothing of Blender."""

from dataclasses import dataclass, field

import numpy as np
import translucid

from .export.scene import Description, build, meshes_of


@dataclass
class Target:
    """What a session is to show."""

    description: Description = field(repr=False)
    film: dict
    integrator: dict
    threads: int | None
    device: str = "cpu"


class Live:
    """A session and what it shows.

    `follow` may take long and belongs into a task; nothing else may be called meanwhile.
    """

    def __init__(self):
        self.session = None
        self._target = None
        self._camera = self._size = None

    def follow(self, target):
        """Brings the session to a target, and says whether anything has changed."""
        edits = edits_between(self._target, target) if self._target is not None else None
        # What fails halfway is made anew the next time.
        self._target = None
        if edits is not None:
            for name, arguments in edits:
                getattr(self.session, name)(**arguments)
        else:
            self._make(target)
        self._target = target
        return edits != []

    def _make(self, target):
        # Two scenes at once would need twice the memory.
        self.stop()
        self.session = None
        film = {**target.film, "size": list(self._size or (64, 64))}
        camera = self._camera or {"position": [0, 0, 1], "target": [0, 0, 0]}
        scene = build(target.description, camera, film, target.integrator, movable=True)
        self.session = translucid.Session(scene, threads=target.threads, device=target.device)

    def look(self, camera, size):
        """Takes a view; the picture begins anew if it is another one."""
        if size != self._size:
            self.session.set_film(size=list(size))
        if camera != self._camera:
            self.session.set_camera(**camera)
        self._camera, self._size = camera, size

    def stop(self):
        if self.session is not None:
            self.session.cancel()

    def picture(self):
        """RGBA, the lowest row first, as a display's texture has it."""
        radiance, alpha = self.session.snapshot("radiance"), self.session.snapshot("alpha")
        return np.ascontiguousarray(np.concatenate([radiance, alpha], axis=2)[::-1])


def edits_between(old, new):
    """Calls of a session's methods that lead from one target to another; None where it must be made anew."""
    a, b = old.description, new.description
    kept = {name for name, body in b.bodies.items() if name in a.bodies and _is_kept(a, b, name, body)}
    if (old.threads, old.device) != (new.threads, new.device) or not kept and (a.bodies or b.bodies):
        return None
    edits = [] if same(old.film, new.film) else [("set_film", new.film)]
    for name, material in b.materials.items():
        before = a.materials.get(name)
        if before is None:
            edits.append(("add_material", {"name": name, **material.keys}))
        elif material is not before and not same(material.keys, before.keys):
            edits.append(("edit_material", {"name": name, **reset(before.keys, material.keys)}))
    for name in a.bodies.keys() - kept:
        edits += [("remove_object", {"name": own}) for own in _names(a, name)]
    for name, body in b.bodies.items():
        if name not in kept:
            edits += [("add_mesh", keys) for keys in meshes_of(name, body, b.materials, movable=True)]
        elif not np.array_equal(body.places, a.bodies[name].places):
            matrix = body.places[0].ravel().tolist()
            edits += [("edit_object", {"name": own, "matrix": matrix}) for own in _names(b, name)]
    edits += [("remove_material", {"name": name}) for name in a.materials.keys() - b.materials.keys()]
    if not same(a.lights, b.lights):
        edits.append(("set_lights", {"lights": b.lights}))
    if not same(a.environment, b.environment):
        edits.append(("set_environment", b.environment))
    if not same(old.integrator, new.integrator):
        edits.append(("set_integrator", new.integrator))
    return edits


def _is_kept(a, b, name, body):
    """Whether a body has the meshes that it had, at its place or moved."""
    before = a.bodies[name]
    if body.parts is not before.parts or body.owners != before.owners:
        return False
    if len(body.parts) > 1:
        # Whether its parts share light below their surfaces is a matter of their materials.
        names = [material for material, _ in body.parts]
        if any(a.materials[m].scatters for m in names) != any(b.materials[m].scatters for m in names):
            return False
    if np.array_equal(body.places, before.places):
        return True
    can_move = lambda d, of: all(keys.get("movable") for keys in meshes_of(name, of, d.materials, movable=True))
    return can_move(a, before) and can_move(b, body)


def _names(description, name):
    return [keys["name"] for keys in meshes_of(name, description.bodies[name], description.materials)]


# What the renderer takes where a material says nothing of a key.
_DEFAULTS = {
    "specular_color": [1.0, 1.0, 1.0],
    "specular_roughness": 0.3,
    "specular_ior": 1.5,
    "specular_weight": 1.0,
    "transmission_color": [1.0, 1.0, 1.0],
    "transmission_weight": 0.0,
    "subsurface_weight": 0.0,
    "coat_weight": 0.0,
    "emission_luminance": 0.0,
    "geometry_normal": "none",
    "geometry_opacity": 1.0,
    "base_metalness": 0.0,
    "subsurface_eta": 1.0,
    "subsurface_flights": 65536,
    "subsurface_scatter_anisotropy": 0.0,
}


def reset(old, new):
    """The new keys, and the defaults of those that only the old ones have: an edit leaves what it does not name."""
    gone = {key: _DEFAULTS[key] for key in old if key not in new and key in _DEFAULTS}
    return {**gone, **new}


def same(a, b):
    """Whether keys have the same values, arrays among them."""
    if a is b:
        return True
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return isinstance(a, np.ndarray) and isinstance(b, np.ndarray) and a.dtype == b.dtype and np.array_equal(a, b)
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(same, a, b))
    return a == b
