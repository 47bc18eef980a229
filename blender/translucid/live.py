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
        old, self._target = self._target, target
        if self.session is not None and old is not None:
            edits = edits_between(old, target)
            if edits is not None:
                self._target = old
                for name, arguments in edits:
                    getattr(self.session, name)(**arguments)
                self._target = target
                return bool(edits)
        # Two scenes at once would need twice the memory.
        self.stop()
        self.session = self._target = None
        size = self._size or (64, 64)
        camera = self._camera or {"position": [0, 0, 1], "target": [0, 0, 0]}
        scene = build(target.description, camera, {**target.film, "size": list(size)}, target.integrator)
        self.session = translucid.Session(scene, threads=target.threads)
        self._target = target
        return True

    def look(self, camera, size):
        """Takes a view; the picture begins anew if it is another one."""
        if size != self._size:
            self.session.set_size(size)
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
    if (old.film, old.threads) != (new.film, new.threads) or a.materials.keys() != b.materials.keys():
        return None
    edits = []
    scatterers = {name for name, material in a.materials.items() if material.scatters != b.materials[name].scatters}
    for name, material in b.materials.items():
        if material is not a.materials[name] and not same(material.keys, a.materials[name].keys):
            edits.append(("edit_material", {"name": name, **reset(a.materials[name].keys, material.keys)}))
    if a.bodies.keys() != b.bodies.keys():
        return None
    for name, body in b.bodies.items():
        before = a.bodies[name]
        if body.parts is before.parts and np.array_equal(body.places, before.places):
            continue
        parts = [(material, part.slot) for material, part in body.parts]
        is_plain = len(body.places) == 1 and len(before.places) == 1
        if not is_plain or parts != [(material, part.slot) for material, part in before.parts]:
            return None
        if scatterers.intersection(material for material, _ in body.parts):
            return None
        edits += [("edit_mesh", placed(keys)) for keys in meshes_of(name, body, b.materials)]
    if not same(a.lights, b.lights):
        edits.append(("set_lights", {"lights": b.lights}))
    if not same(a.environment, b.environment):
        edits.append(("set_environment", b.environment))
    if not same(old.integrator, new.integrator):
        edits.append(("set_integrator", new.integrator))
    return edits


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
}


def reset(old, new):
    """The new keys, and the defaults of those that only the old ones have: an edit leaves what it does not name."""
    gone = {key: _DEFAULTS[key] for key in old if key not in new and key in _DEFAULTS}
    return {**gone, **new}


def placed(keys):
    """The arguments of `Session.edit_mesh`, whose coordinates are those of the world, from those of `Scene.add_mesh`."""
    matrix = np.array(keys["matrix"]).reshape(4, 4)
    vertices = keys["vertices"] @ matrix[:3, :3].T + matrix[:3, 3]
    normals = keys["normals"]
    triangles = keys["triangles"]
    if np.linalg.det(matrix[:3, :3]) < 0:
        triangles = triangles[:, ::-1]
    if normals is not None:
        normals = normals @ np.linalg.pinv(matrix[:3, :3])
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = normals / np.where(length > 0, length, 1)
    return {
        "name": keys["name"],
        "vertices": vertices,
        "triangles": triangles,
        "normals": normals,
        "uv": keys["uv"],
        "colors": keys["colors"],
    }


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
