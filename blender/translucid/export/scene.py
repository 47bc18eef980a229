# SPDX-License-Identifier: GPL-3.0-or-later
"""A depsgraph as a description: meshes, materials, lamps, world; and that as a `translucid.Scene`."""

from dataclasses import dataclass, field

import numpy as np
import translucid

from .light import light_keys
from .material import default_material, material_of
from .mesh import FARTHEST, arrays_of, has_area, is_open, mended
from .world import environment_keys

# Kinds of objects that have surfaces.
_SURFACES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}

# Kinds that show nothing in a rendering.
_SILENT = {"EMPTY", "ARMATURE", "LATTICE", "SPEAKER", "CAMERA", "LIGHT_PROBE", "LIGHT"}

_KINDS = {"CURVES": "hair curves", "POINTCLOUD": "point clouds", "VOLUME": "volumes", "GREASEPENCIL": "grease pencil", "GPENCIL": "grease pencil"}


@dataclass
class Body:
    """A mesh of one or several materials, and the places where it stands."""

    name: str
    # Names of the materials and arrays, for each part.
    parts: list
    places: list = field(default_factory=list)
    # A name for each place.
    owners: list = field(default_factory=list)
    # Names of the object that is seen at each place, and of its topmost parent.
    shown: list = field(default_factory=list)


@dataclass
class Description:
    """What a scene shows. A part, a material or an image that stays is the same object in the next description."""

    bodies: dict = field(default_factory=dict)
    materials: dict = field(default_factory=dict)
    # What Cycles calls the materials.
    material_names: dict = field(default_factory=dict)
    lights: list = field(default_factory=list)
    environment: dict = field(default_factory=dict)


class Exporter:
    """Describes what a depsgraph shows.

    `model` takes the place of the transports of the materials' own methods; `is_cancelled` is asked between objects;
    `cache` has what an earlier description found and what has changed since.
    """

    def __init__(self, depsgraph, report, model=None, is_cancelled=lambda: False, cache=None):
        self._depsgraph, self._report, self._model = depsgraph, report, model
        self._is_cancelled = is_cancelled
        self._cache = cache if cache is not None else Cache()

    def describe(self):
        description = Description(environment=self._environment())
        layer, bodies = self._depsgraph.view_layer_eval, {}
        # What is found in an iteration is gone after it.
        for instance in self._depsgraph.object_instances:
            shown = instance.object
            if not instance.show_self:
                continue
            if shown.type == "LIGHT":
                light = light_keys(shown, instance.matrix_world, self._report)
                if light is not None:
                    description.lights.append(light)
            elif shown.type in _SURFACES:
                if layer.use_solid:
                    self._place(bodies, instance, shown, description)
            elif shown.type not in _SILENT:
                what = _KINDS.get(shown.type, shown.type.lower())
                self._report.add(f"object {shown.name}", None, f"{what} cannot be rendered")
        for body in bodies.values():
            self._leave_out_places(body)
            if body.parts and body.places:
                description.bodies[_unique(body.name, description.bodies)] = body
        self._cache.keep(bodies, description)
        return description

    def _leave_out_places(self, body):
        """Drops the places at which nothing can be seen, as where the scale is 0."""
        places = np.array(body.places)
        are_numbers = np.abs(places).max(axis=(1, 2)) <= FARTHEST
        for i in np.flatnonzero(~are_numbers):
            self._report.add(f"object {body.owners[i]}", None, "its matrix is beyond all bounds; it is left out")
        seen = are_numbers
        for i in np.flatnonzero(_stretch(np.where(are_numbers[:, None, None], places, np.eye(4))) >= _FLAT):
            seen[i] &= any(has_area(_moved(part.vertices, places[i]), part.triangles) for _, part in body.parts)
        if not seen.all():
            body.places = [body.places[i] for i in np.flatnonzero(seen)]
            body.owners = [body.owners[i] for i in np.flatnonzero(seen)]
            body.shown = [body.shown[i] for i in np.flatnonzero(seen)]

    def _environment(self):
        if self._cache.environment is not None:
            return self._cache.environment
        scene, layer = self._depsgraph.scene, self._depsgraph.view_layer_eval
        world = getattr(layer, "world_override", None) or scene.world
        return environment_keys(world if layer.use_sky else None, self._report, not scene.render.film_transparent)

    def _material(self, material):
        if material is None:
            return default_material()
        return material_of(material, self._report, self._model)

    def _place(self, bodies, instance, shown, description):
        override = self._depsgraph.view_layer_eval.material_override
        materials = [override or slot.material for slot in shown.material_slots] or [override]
        # Objects with the same evaluated mesh and the same materials share it.
        owner = "" if shown.type == "MESH" else shown.name_full
        names = tuple(material_name(material) for material in materials)
        for material in materials:
            self._add_material(description, material)
        asked = tuple(description.materials[name].asked for name in names)
        key = (shown.data.as_pointer(), shown.data.name_full, owner, names, asked)
        body = bodies.get(key)
        if body is None:
            if self._is_cancelled():
                raise InterruptedError("cancelled")
            parts = self._cache.parts.get(key)
            if parts is None:
                self._look_at(shown)
                source = instance.instance_object if instance.is_instance and shown.type != "MESH" else shown
                parts = self._parts(source, names, description)
            body = bodies[key] = Body(shown.name_full, parts)
            self._cache.sources.setdefault(key, set()).update((shown.name_full, shown.data.name_full))
        body.places.append(np.array(instance.matrix_world, dtype=np.float64))
        body.owners.append(_place_name(instance))
        body.shown.append((shown.name, _topmost(shown).name))

    def _look_at(self, shown):
        where = f"object {shown.name}"
        layer = self._depsgraph.view_layer
        owner = shown.original
        if owner.is_holdout or owner.holdout_get(view_layer=layer):
            self._report.add(where, None, "a holdout cannot be rendered; it is seen")
        if owner.indirect_only_get(view_layer=layer):
            self._report.add(where, None, "what is seen indirectly only cannot be rendered; it is seen")
        if getattr(shown, "is_shadow_catcher", False):
            self._report.add(where, None, "a shadow catcher cannot be rendered; it is seen")
        rays = ("camera", "diffuse", "glossy", "transmission", "shadow")
        if not all(getattr(shown, f"visible_{ray}", True) for ray in rays):
            self._report.add(where, None, "visibility by kind of ray cannot be rendered; all rays see it")
        for system in shown.particle_systems:
            if system.settings.type == "HAIR" and system.settings.render_type == "PATH":
                self._report.add(where, system.name, "hair cannot be rendered")

    def _parts(self, shown, names, description):
        """The mesh of an object, by materials."""
        own = [description.materials[name] for name in names]
        uv_layers = _Clamped({slot: m.uv_layer for slot, m in enumerate(own) if m.uv_layer is not None}, len(own))
        colors = _Clamped({slot: m.color_attribute for slot, m in enumerate(own) if m.color_attribute is not None}, len(own))
        is_mesh = shown.type == "MESH"
        mesh = shown.data if is_mesh else shown.to_mesh()
        if mesh is None:
            return []
        try:
            parts = arrays_of(mesh, uv_layers, colors, len(names) == 1)
        finally:
            if not is_mesh:
                shown.to_mesh_clear()
        where = f"object {shown.name}"
        for part in parts:
            if part.slot in uv_layers and part.uv is None:
                wanted = f" {uv_layers[part.slot]!r}" if uv_layers[part.slot] else ""
                self._report.add(where, None, f"it has no UV map{wanted}; its textures show one texel")
            if part.slot in colors and part.colors is None:
                self._report.add(where, None, f"it has no color attribute {colors[part.slot]!r}; it is white")
        parts = [mended(part, lambda text: self._report.add(where, None, text)) for part in parts]
        found = [(names[min(part.slot, len(names) - 1)], part) for part in parts if has_area(part.vertices, part.triangles)]
        if any(description.materials[name].glows for name, _ in found) and is_open([part for _, part in found]):
            self._report.add(where, None, "an open surface that glows shines from its front only")
        return found

    def _add_material(self, description, material):
        name = material_name(material)
        if name not in description.materials:
            known = self._cache.materials.get(name)
            description.materials[name] = self._material(material) if known is None else known
            description.material_names[name] = material.name if material is not None else "default_surface"


class Cache:
    """What the last description found."""

    def __init__(self):
        self.parts, self.sources, self.materials, self.environment = {}, {}, {}, None

    def keep(self, bodies, description):
        self.parts = {key: body.parts for key, body in bodies.items()}
        self.sources = {key: names for key, names in self.sources.items() if key in bodies}
        self.materials, self.environment = dict(description.materials), description.environment

    def forget_mesh(self, name):
        """An object's or a mesh's geometry has changed."""
        for key, names in self.sources.items():
            if name in names:
                self.parts.pop(key, None)

    def forget_material(self, name):
        """A material has changed; it may ask its meshes for other texture coordinates or colors."""
        self.materials.pop(name, None)

    def forget_materials(self):
        self.materials = {}


class _Clamped(dict):
    """A map of slots in which those beyond the last count as the last, as in Blender."""

    def __init__(self, slots, count):
        super().__init__(slots)
        self._last = count - 1

    def __contains__(self, slot):
        return super().__contains__(min(slot, self._last))

    def __getitem__(self, slot):
        return super().__getitem__(min(slot, self._last))


def material_name(material):
    return material.name_full if material is not None else "(no material)"


def _topmost(owner):
    while owner.parent is not None:
        owner = owner.parent
    return owner


def _place_name(instance):
    if not instance.is_instance:
        return instance.object.name_full
    parent = instance.parent.name_full if instance.parent else ""
    numbers = [str(i) for i in instance.persistent_id if i != 0x7FFFFFFF]
    return f"{instance.object.name_full} of {':'.join([parent, *numbers])}"


# Distance of a camera [m] from Blender's origin beyond which the renderer counts from near the camera: there, single precision
# no longer resolves a tenth of a millimeter as finely as walks below surfaces want.
_NEAR = 8.0


def _origin(camera):
    position = np.array(camera["position"], dtype=np.float64)
    return np.where(np.abs(position) > _NEAR, np.round(position / _NEAR) * _NEAR, 0.0)


def build(description, camera, film, integrator, movable=False):
    """The renderer's scene of a description, whose objects may be movable."""
    scene = translucid.Scene("m", camera=camera, film=film, integrator=integrator, environment=description.environment, origin=_origin(camera))
    for name, material in description.materials.items():
        scene.add_material(name, **material.keys)
    for name, body in description.bodies.items():
        for keys in meshes_of(name, body, description.materials, movable):
            scene.add_mesh(**keys)
    if not description.bodies:
        # The renderer wants an object: one that is too small and too clear to be seen.
        scene.add_material("(nothing)", geometry_opacity=0.0)
        scene.add_mesh("(nothing)", np.eye(3) * 1e-6, [[0, 1, 2]], material="(nothing)")
    for light in description.lights:
        scene.add_light(**light)
    return scene


def meshes_of(name, body, materials, movable=False):
    """The arguments of `Scene.add_mesh` for the parts of a body."""
    return (keys for _, keys in placed_meshes(name, body, materials, movable))


def placed_meshes(name, body, materials, movable=False):
    """The arguments of `Scene.add_mesh` for the parts of a body, each with the numbers of its places."""
    # The parts of a body share the light below their surfaces, and each place is a body of its own.
    is_shared = len(body.parts) > 1 and any(materials[material].scatters for material, _ in body.parts)
    places = np.array(body.places)
    stretch = _stretch(places)
    for number, (material, part) in enumerate(body.parts):
        own = name if len(body.parts) == 1 else f"{name}/{number}"
        words = {
            "vertices": part.vertices,
            "triangles": part.triangles,
            "normals": part.normals,
            "uv": part.uv,
            "colors": part.colors,
            "material": material,
        }
        if len(places) > 1 and not is_shared and max(stretch) < _FLAT:
            yield range(len(places)), {"name": own, "transforms": places, **words}
            continue
        for i, place in enumerate(places):
            group = {"subsurface_group": body.owners[i]} if is_shared else {}
            unique = own if len(places) == 1 else f"{own} {i}"
            if stretch[i] >= _FLAT:
                # What is flattened has no normals that a matrix could turn.
                flat = _moved(part.vertices, place)
                if has_area(flat, part.triangles):
                    yield [i], {"name": unique, **words, "vertices": flat, "normals": None, **group}
                continue
            free = {"movable": True} if movable and len(places) == 1 and stretch[i] < _STRETCHED else {}
            yield [i], {"name": unique, "matrix": place.ravel().tolist(), **group, **free, **words}


# How much a place may stretch one direction more than another: to be a map at all, and to be moved in place.
_FLAT, _STRETCHED = 1e5, 100.0


def _stretch(places):
    scales = np.linalg.svd(places[:, :3, :3], compute_uv=False)
    return np.where(scales[:, 2] > 1e-12, scales[:, 0] / np.maximum(scales[:, 2], 1e-12), np.inf)


def _moved(vertices, place):
    return vertices @ place[:3, :3].T + place[:3, 3]


def _unique(name, taken):
    # To the renderer an index in brackets is one of many places.
    name = name.replace("[", "(").replace("]", ")")
    number = 1
    unique = name
    while unique in taken:
        number += 1
        unique = f"{name} {number}"
    return unique
