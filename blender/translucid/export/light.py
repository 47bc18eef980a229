# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps. Blender states watts; the renderer takes radiances, intensities and irradiances."""

import math

import numpy as np

from .nodes import Evaluator, Socket


def light_keys(lamp_object, world_from_light, report):
    """The keys of a lamp, or None where it cannot shine."""
    light = lamp_object.data
    where = f"light {lamp_object.name}"
    world = np.array(world_from_light, dtype=np.float64)
    power = _power(light, where, report)
    if not np.isfinite(power).all():
        report.add(where, None, "its power is no number; it is left out")
        return None
    if np.any(power < 0):
        report.add(where, None, "light that is negative cannot be rendered; it is 0")
    power = np.maximum(power, 0)
    if not power.any():
        return None
    _look_at(lamp_object, where, report)
    visible = bool(getattr(lamp_object, "visible_camera", True))
    translate = {"POINT": _point, "SPOT": _spot, "SUN": _sun, "AREA": _area}[light.type]
    return translate(light, world, power, visible, where, report)


def _power(light, where, report):
    color = np.array(light.color[:], dtype=np.float64)
    if getattr(light, "use_temperature", False):
        color = color * np.array(light.temperature_color[:])
    power = color * light.energy * 2.0 ** getattr(light, "exposure", 0.0)
    if light.use_nodes and light.node_tree is not None:
        power = power * _emission(light, where, report)
    return power


def _look_at(lamp_object, where, report):
    if not getattr(lamp_object.data, "use_shadow", True):
        report.add(where, None, "a lamp without shadows cannot be rendered; it throws them")
    if not all(getattr(lamp_object, f"visible_{ray}", True) for ray in ("diffuse", "glossy", "transmission")):
        report.add(where, None, "visibility by kind of ray cannot be rendered; it lights all surfaces")
    linking = getattr(lamp_object, "light_linking", None)
    if linking is not None and (linking.receiver_collection or linking.blocker_collection):
        report.add(where, None, "light linking cannot be rendered; it lights all objects")


def _emission(light, where, report):
    """The factor of a lamp's nodes."""
    evaluator = Evaluator(report, where)
    outputs = [node for node in light.node_tree.nodes if node.type == "OUTPUT_LIGHT"]
    source = Socket(outputs[0].inputs["Surface"]).source()[0] if outputs else None
    if source is None:
        return np.zeros(3)
    if source.node.type != "EMISSION":
        evaluator.say(source.node, f"a {source.node.bl_label} node cannot be translated; the lamp shines without it")
        return np.ones(3)
    color, strength = evaluator.value(source.input("Color")), evaluator.value(source.input("Strength"), 1.0)
    if not (color.is_constant and strength.is_constant):
        evaluator.say(source.node, "light that varies over a lamp cannot be translated; its mean is used")
    return color.color().constant * strength.number


def _normalized(light, power, area):
    """The power of a lamp that states it, or that of one whose light grows with its area."""
    return power if getattr(light, "normalize", True) else power * area


def _scale(world):
    return float(np.mean([np.linalg.norm(world[:3, i]) for i in range(3)]))


def _point(light, world, power, visible, where, report):
    radius = light.shadow_soft_size
    position = world[:3, 3].tolist()
    if radius <= 0:
        return {"type": "point", "position": position, "intensity": (power / (4 * math.pi)).tolist()}
    power = _normalized(light, power, 4 * math.pi * radius**2)
    radiance = power / (4 * math.pi**2 * radius**2)
    return {"type": "sphere", "center": position, "radius": radius, "radiance": radiance.tolist(), "visible": visible}


def _spot(light, world, power, visible, where, report):
    radius = light.shadow_soft_size
    if radius > 0:
        power = _normalized(light, power, 4 * math.pi * radius**2)
    lengths = [np.linalg.norm(world[:3, i]) for i in range(3)]
    if max(lengths) > 1.001 * min(lengths):
        report.add(where, None, "a cone that is stretched cannot be translated; it is round")
    outer = min(light.spot_size / 2, math.pi)
    # Cycles lets the light fall by the smooth step of the cosine, over this share of the cone.
    cos_inner = math.cos(outer) + (1 - math.cos(outer)) * light.spot_blend
    inner = math.acos(min(max(cos_inner, -1.0), 1.0))
    keys = {
        "type": "spot",
        "position": world[:3, 3].tolist(),
        "direction": (-world[:3, 2]).tolist(),
        "intensity": (power / (4 * math.pi)).tolist(),
        "outer_angle": math.degrees(outer),
        "inner_angle": math.degrees(min(inner, outer * (1 - 1e-6))),
    }
    if radius > 0:
        keys["radius"], keys["visible"] = radius, visible
    return keys


def _sun(light, world, power, visible, where, report):
    half = min(light.angle / 2, math.radians(89.9))
    irradiance = _normalized(light, power, math.pi * math.sin(half) ** 2)
    return {
        "type": "distant",
        "direction": world[:3, 2].tolist(),
        "angular_radius": math.degrees(half),
        "irradiance": irradiance.tolist(),
    }


def _area(light, world, power, visible, where, report):
    if light.spread < math.pi - 1e-4:
        report.add(where, None, "a narrow spread cannot be translated; it shines as a Lambertian surface")
    across = light.size
    down = light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else across
    edge_x = world[:3, 0] * across
    # It shines along its -z.
    edge_y = -world[:3, 1] * down
    if not edge_x.any() or not edge_y.any():
        return None
    slant = edge_x @ edge_y / (edge_x @ edge_x) * edge_x
    if np.linalg.norm(slant) > 1e-4 * np.linalg.norm(edge_y):
        report.add(where, None, "a sheared lamp cannot be translated; it is right-angled")
    edge_y = edge_y - slant
    area = float(np.linalg.norm(np.cross(edge_x, edge_y)))
    if area == 0:
        return None
    is_round = light.shape in {"DISK", "ELLIPSE"}
    if is_round:
        area *= math.pi / 4
    radiance = _normalized(light, power, area) / (math.pi * area)
    shines = np.cross(edge_x, edge_y) @ -world[:3, 2] > 0
    return {
        "type": "ellipse" if is_round else "rectangle",
        "center": world[:3, 3].tolist(),
        "edge_x": edge_x.tolist(),
        "edge_y": (edge_y if shines else -edge_y).tolist(),
        "radiance": radiance.tolist(),
        "visible": visible,
    }
