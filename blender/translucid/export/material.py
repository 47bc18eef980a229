# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees as materials of the renderer.

A surface is a sum of weighted lobes, which Mix Shader and Principled BSDF make of each other; the renderer's material
holds one of each kind: a metal, clear glass, subsurface scattering and a matte base, under a coat, partly transparent.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from .nodes import Evaluator, Socket
from .subsurface import transport_keys
from .value import Value, combine

_ONE, _ZERO = Value.of(1.0), Value.of(0.0)

# Cycles' surface of a mesh without a material.
DEFAULT_COLOR = (0.8, 0.8, 0.8)


@dataclass
class Lobe:
    kind: str
    weight: Value
    node: object
    color: Value
    # Keys of the renderer that belong to it alone.
    keys: dict = field(default_factory=dict)
    # Keys of the interface: specular_roughness, specular_ior, coat_… ; of a matte lobe without an interface none.
    interface: dict = field(default_factory=dict)


@dataclass
class Material:
    """Keys of the renderer's material, and the parts of a mesh that it looks at."""

    keys: dict
    uv_layer: str | None = None
    color_attribute: str | None = None

    @property
    def scatters(self):
        """Whether light travels below its surface."""
        weight = self.keys.get("subsurface_weight", 0)
        return (isinstance(weight, dict) or weight > 0) and not self.keys.get("geometry_thin_walled", False)

    @property
    def glows(self):
        """Whether it shines of its own."""
        return self.keys.get("emission_luminance", 0) > 0

    @property
    def asked(self):
        """The UV map and the color attribute that its meshes are asked for."""
        return self.uv_layer, self.color_attribute


def default_material():
    return Material({"base_color": list(DEFAULT_COLOR), "specular_weight": 0.0})


def material_of(material, report, model=None):
    """Translate a material.

    `model` takes the place of the transport that belongs to the nodes' method.
    """
    name = f"material {material.name}"
    if material.node_tree is None or not getattr(material, "use_nodes", True):
        return _without_nodes(material)
    evaluator = Evaluator(report, name)
    output = _output_node(material.node_tree)
    surface = Socket(output.inputs["Surface"]).source()[0] if output is not None else None
    for kind in ("Volume", "Displacement") if output is not None else ():
        if Socket(output.inputs[kind]).is_linked:
            report.add(name, output.name, f"{kind} cannot be translated and is left out")
    if surface is None:
        if output is not None and Socket(output.inputs["Volume"]).is_linked:
            # A volume alone has no surface to see.
            return Material({"geometry_opacity": 0.0})
        text = "there is no surface (Cycles shows black); it is light gray"
        report.add(name, output.name if output is not None else "", text)
        return default_material()
    lobes = _lobes(evaluator, surface, _ONE)
    keys = _MaterialKeys(evaluator, material.name, lobes).keys
    if model is not None and keys.get("subsurface_model", "none") != "none":
        # Cycles' index is that of the view's refraction; here it would be that of a body. What its walks make of a color
        # is its own, too.
        color = _mean_color([lobe for lobe in lobes if lobe.kind == "subsurface"])
        keys |= {"subsurface_model": model, "subsurface_eta": _ONE, "subsurface_color": color}
        keys.pop("subsurface_flights", None)
    return _spelled(evaluator, output, keys)


def _without_nodes(material):
    return Material(
        {
            "base_color": [_unit(x) for x in material.diffuse_color[:3]],
            "base_metalness": _unit(material.metallic),
            "specular_roughness": _unit(material.roughness),
        }
    )


def _unit(x):
    return min(max(float(x), 0.0), 1.0)


def _output_node(tree):
    outputs = [node for node in tree.nodes if node.type == "OUTPUT_MATERIAL" and node.target in {"ALL", "CYCLES"}]
    active = [node for node in outputs if node.is_active_output]
    return (active or outputs or [None])[0]


# --- lobes

def _lobes(evaluator, output, weight):
    """The lobes of the shader of an output, each times a weight."""
    if output.socket.type != "SHADER":
        # As in Cycles a color in place of a shader glows.
        return [Lobe("emission", weight, output.node, evaluator.output(output).color())]
    translate = _SHADERS.get(output.node.type)
    if translate is None:
        text = f"a {output.node.bl_label} node cannot be translated; it is diffuse"
        evaluator.say(output.node, text)
        socket = output.input("Color") or output.input("Base Color")
        return [Lobe("diffuse", weight, output.node, evaluator.value(socket, DEFAULT_COLOR))]
    return translate(evaluator, output, weight)


def _times(a, b):
    return combine(np.multiply, a, b)


def _rest(value):
    return combine(lambda x: 1 - x, value)


def _weight(evaluator, output, name, default):
    return combine(lambda x: np.clip(x, 0, 1), evaluator.value(output.input(name), default))


def _mix(evaluator, output, weight):
    factor = _weight(evaluator, output, "Fac", 0.5)
    lobes = []
    for socket, share in zip(output.node.inputs[1:3], (_rest(factor), factor), strict=True):
        if share.is_everywhere(0):
            continue
        source = Socket(socket, output.groups).source()[0]
        if source is None:
            lobes.append(Lobe("diffuse", _times(weight, share), output.node, Value.of([0.0, 0.0, 0.0])))
        else:
            lobes += _lobes(evaluator, source, _times(weight, share))
    return lobes


def _add(evaluator, output, weight):
    sources = [Socket(socket, output.groups).source()[0] for socket in output.node.inputs[:2]]
    return [lobe for source in sources if source is not None for lobe in _lobes(evaluator, source, weight)]


def _number(evaluator, output, name, default):
    """One number for the whole surface."""
    value = evaluator.value(output.input(name), default)
    if not value.is_constant:
        evaluator.say(output.node, f"a texture of {name} cannot be translated; its mean is used")
    return value.number


def _diffuse(evaluator, output, weight):
    _say_unless_zero(evaluator, output, "Roughness", "the roughness of diffuse light cannot be translated and is 0")
    return [Lobe("diffuse", weight, output.node, _color(evaluator, output), _normal(evaluator, output))]


def _color(evaluator, output, name="Color"):
    color = evaluator.value(output.input(name), DEFAULT_COLOR).color()
    if float(color.linear.max()) > 1 + 1e-3:
        evaluator.say(output.node, f"{name} above 1 would reflect more light than arrives; it is 1")
    return combine_unit(color)


def combine_unit(value):
    """A value in [0, 1]; one that is keeps its codes and its mesh's colors."""
    if value.pixels.dtype == np.uint8:
        return value
    return Value(np.clip(value.pixels, 0, 1), value.placement, value.attribute)


def _say_unless_zero(evaluator, output, name, text):
    if not evaluator.value(output.input(name)).is_everywhere(0):
        evaluator.say(output.node, text)


def _subsurface(evaluator, output, weight):
    node = output.node
    color = _color(evaluator, output)
    keys = transport_keys(
        node.falloff,
        color,
        evaluator.value(output.input("Radius")).color(),
        evaluator.value(output.input("Scale")),
        _number(evaluator, output, "IOR", 1.4),
        _number(evaluator, output, "Anisotropy", 0.0),
        min(max(_number(evaluator, output, "Roughness", 1.0), 0.0), 1.0),
    )
    _say_of_attribute(evaluator, node, color)
    return [Lobe("subsurface", weight, node, color, keys | _normal(evaluator, output))]


def _say_of_attribute(evaluator, node, color):
    if color.attribute is not None:
        evaluator.say(node, "below a color attribute light travels as far as below white")


def _glossy(evaluator, output, weight):
    color = _color(evaluator, output)
    interface = _facets(evaluator, output) | {"specular_color": combine(even_tint, color)}
    return [Lobe("metal", weight, output.node, color, _normal(evaluator, output), interface)]


def _facets(evaluator, output, default=0.5):
    """The roughness of a microfacet node, and words for what else it says of its facets."""
    roughness = _weight(evaluator, output, "Roughness", default)
    if roughness.is_everywhere(0):
        return {"specular_roughness": roughness}
    _say_unless_zero(evaluator, output, "Anisotropy", "anisotropic reflection cannot be translated; it is isotropic")
    _say_of_distribution(evaluator, output.node)
    return {"specular_roughness": roughness}


def _say_of_distribution(evaluator, node):
    if node.distribution != "MULTI_GGX":
        name = node.bl_rna.properties["distribution"].enum_items[node.distribution].name
        evaluator.say(node, f"the distribution {name} cannot be translated; it is Multiscatter GGX")


def schlick(f0, cosine):
    """Schlick's approximation of a reflectance that is f0 at normal incidence."""
    return f0 + (1 - f0) * (1 - cosine) ** 5


def edge_tint(f0, f82):
    """The tint of a metal whose reflectances are f0 at normal incidence and f82 where the cosine is 1/7."""
    return np.clip(f82 / np.maximum(schlick(f0, 1 / 7), 1e-6), 0, 1)


def even_tint(f0):
    """The tint of a metal that reflects f0 on the average of all directions, as a surface that has f0 at all angles.

    The renderer's F(μ) = F_Schlick(μ) - a μ (1 - μ)⁶ has this mean for a = (1 - f0) / 21 / ∫ 2 μ² (1 - μ)⁶ dμ = 6 (1 - f0).
    """
    return edge_tint(f0, schlick(f0, 1 / 7) - 6 * (1 - f0) * (1 / 7) * (6 / 7) ** 6)


def conductor_reflectance(n, k, cosine):
    """Fresnel's reflectance of a metal of index n and extinction k, unpolarized."""
    # The refracted wave's √(η² - sin²) is p + i q.
    real = n * n - k * k - (1 - cosine**2)
    size = np.hypot(real, 2 * n * k)
    p, q_squared = np.sqrt(np.maximum((size + real) / 2, 0)), np.maximum((size - real) / 2, 0)
    across = ((cosine - p) ** 2 + q_squared) / ((cosine + p) ** 2 + q_squared)
    tangent = (1 - cosine**2) / cosine
    return across * (1 + ((p - tangent) ** 2 + q_squared) / ((p + tangent) ** 2 + q_squared)) / 2


def _metallic(evaluator, output, weight):
    _say_unless_zero(evaluator, output, "Thin Film Thickness", _LEFT_OUT["Thin Film Thickness"])
    if output.node.fresnel_type == "F82":
        color = _color(evaluator, output, "Base Color")
        tint = _color(evaluator, output, "Edge Tint") if output.input("Edge Tint") else _ONE
    else:
        evaluator.say(output.node, "physical conductors cannot be translated; it has their reflectance at 0° and 82°")
        n, k = (evaluator.value(output.input(name)).color() for name in ("IOR", "Extinction"))
        color = combine(lambda n, k: conductor_reflectance(n, k, 1.0), n, k)
        tint = combine(lambda n, k, f0: edge_tint(f0, conductor_reflectance(n, k, 1 / 7)), n, k, color)
    interface = _facets(evaluator, output) | ({} if tint.is_everywhere(1) else {"specular_color": tint})
    return [Lobe("metal", weight, output.node, color, _normal(evaluator, output), interface)]


def _glass(evaluator, output, weight):
    node = output.node
    if node.type == "BSDF_REFRACTION":
        evaluator.say(node, "refraction without reflection cannot be translated; it is glass")
    _say_unless_zero(evaluator, output, "Thin Film Thickness", _LEFT_OUT["Thin Film Thickness"])
    color = _color(evaluator, output)
    interface = _facets(evaluator, output, 0.0) | {
        "specular_ior": evaluator.value(output.input("IOR"), 1.5),
        "specular_color": color,
    }
    return [Lobe("glass", weight, node, color, _normal(evaluator, output), interface)]


def _transparent(evaluator, output, weight):
    color = _color(evaluator, output)
    if not color.is_everywhere(1):
        evaluator.say(output.node, "colored transparency cannot be translated; it lets through the color's luminance")
        clear = color.scalar()
        return [
            Lobe("transparent", _times(weight, clear), output.node, _ONE),
            Lobe("diffuse", _times(weight, _rest(clear)), output.node, Value.of([0.0, 0.0, 0.0])),
        ]
    return [Lobe("transparent", weight, output.node, color)]


def _emission(evaluator, output, weight):
    color, strength = evaluator.value(output.input("Color")), evaluator.value(output.input("Strength"), 1.0)
    return [Lobe("emission", weight, output.node, _radiance(evaluator, output.node, color, strength))]


def _radiance(evaluator, node, color, strength):
    if strength.linear.min() < 0 or color.linear.min() < 0:
        evaluator.say(node, "light that is negative cannot be rendered; it is 0")
    if color.attribute and strength.is_constant:
        return Value(color.linear * max(strength.number, 0), color.placement, color.attribute)
    return combine(lambda c, s: np.maximum(c * s, 0), color, strength)


def _normal(evaluator, output):
    """The normal map of a shader."""
    source = output.input("Normal").source()[0] if output.input("Normal") else None
    if source is None:
        return {}
    node = source.node
    if node.type != "NORMAL_MAP":
        evaluator.say(node, f"normals from a {node.bl_label} node cannot be translated; the mesh's own are used")
        return {}
    if node.space != "TANGENT":
        evaluator.say(node, "only normal maps in tangent space can be translated; the mesh's own normals are used")
        return {}
    color, strength = evaluator.value(source.input("Color")), evaluator.value(source.input("Strength"), 1.0)
    if color.placement is None:
        if not np.allclose(color.constant, [0.5, 0.5, 1.0], atol=1e-3):
            evaluator.say(node, "a normal map that is no image cannot be translated; the mesh's own normals are used")
        return {}
    if node.uv_map and color.placement.layer not in {"", node.uv_map}:
        evaluator.say(node, f"the tangents are those of the UV map {color.placement.layer!r}")
    # Blender has the property since 5.1.
    is_directx = getattr(node, "convention", "OPENGL") == "DIRECTX"
    return {"geometry_normal": strengthened(color, strength.number, is_directx)}


def strengthened(color, strength, is_directx=False):
    """A normal map whose normals are mixed with the surface's, as Cycles' Strength does; DirectX's green points down."""
    if strength == 1 and not is_directx:
        return color

    def function(codes):
        normal = (2 * codes - 1) * ([1, -1, 1] if is_directx else [1, 1, 1])
        mixed = np.array([0.0, 0.0, 1.0]) * (1 - strength) + normal * strength
        mixed[..., 2] = np.maximum(mixed[..., 2], 1e-3)
        mixed /= np.linalg.norm(mixed, axis=-1, keepdims=True)
        return (mixed + 1) / 2

    return combine(function, color)


_LEFT_OUT = {
    "Diffuse Roughness": "the roughness of diffuse light cannot be translated and is 0",
    "Anisotropic": "anisotropic reflection cannot be translated; it is isotropic",
    "Sheen Weight": "sheen cannot be translated and is left out",
    "Thin Film Thickness": "a thin film cannot be translated and is left out",
    "Transmission Dispersion Scale": "dispersion cannot be translated and is left out",
}


def interface_index(ior, level):
    """The index of refraction whose reflectance at normal incidence is that of `ior` times twice `level`."""
    f0 = min(((ior - 1) / (ior + 1)) ** 2 * 2 * max(level, 0.0), 0.99)
    return (1 + f0**0.5) / (1 - f0**0.5)


def _principled(evaluator, output, weight):
    node = output.node
    for name, text in _LEFT_OUT.items():
        _say_unless_zero(evaluator, output, name, text)
    number = lambda name, default: _number(evaluator, output, name, default)
    base = _color(evaluator, output, "Base Color")
    metallic, transmission, scattering, alpha, coat = (
        _weight(evaluator, output, name, default)
        for name, default in (
            ("Metallic", 0.0),
            ("Transmission Weight", 0.0),
            ("Subsurface Weight", 0.0),
            ("Alpha", 1.0),
            ("Coat Weight", 0.0),
        )
    )
    ior, level = number("IOR", 1.5), number("Specular IOR Level", 0.5)
    index = interface_index(ior, level)
    roughness = _weight(evaluator, output, "Roughness", 0.5)
    tint = _color(evaluator, output, "Specular Tint") if output.input("Specular Tint") else Value.of([1.0, 1.0, 1.0])
    interface = {"specular_roughness": roughness, "specular_ior": Value.of(index)}
    if not tint.is_everywhere(1):
        interface["specular_color"] = tint
        if not metallic.is_everywhere(1):
            evaluator.say(node, "the specular tint colors reflections at grazing angles, too")
    if not (metallic.is_everywhere(0) and transmission.is_everywhere(0)):
        _say_of_distribution(evaluator, node)
    if not coat.is_everywhere(0):
        interface |= {
            "coat_weight": coat,
            "coat_roughness": _weight(evaluator, output, "Coat Roughness", 0.03),
            "coat_ior": evaluator.value(output.input("Coat IOR"), 1.5),
        }
        depth = _coat_depth(interface["coat_ior"].number)
        coat_tint = _color(evaluator, output, "Coat Tint")
        if not coat_tint.is_everywhere(1):
            evaluator.say(node, "the tint of a coat is the same in all directions, that of their mean")
        interface["coat_color"] = combine(lambda tint: tint**depth, coat_tint)
        if output.input("Coat Normal") and output.input("Coat Normal").is_linked:
            evaluator.say(node, "a normal of the coat's own cannot be translated; it is the surface's")
    wall = {"geometry_thin_walled": True} if _is_thin_walled(evaluator, output) else {}
    keys = _normal(evaluator, output) | wall
    solid = _times(weight, alpha)
    opaque = _times(solid, _rest(metallic))
    below = _times(opaque, _rest(transmission))
    parts = [
        Lobe("transparent", _times(weight, _rest(alpha)), node, _ONE),
        Lobe("metal", _times(solid, metallic), node, base, keys, interface),
        # Light crosses glass twice, but a thin wall once, and shall then have the base color.
        Lobe("glass", _times(opaque, transmission), node, base if wall else _glass_color(base, transmission), keys, interface),
        Lobe("diffuse", _times(below, _rest(scattering)), node, base, keys, interface),
    ]
    if wall and not scattering.is_everywhere(0):
        # Scattering to both sides has no way through a body
        g = min(max(number("Subsurface Anisotropy", 0.0), -_MOST_ANISOTROPIC), _MOST_ANISOTROPIC)
        sides = {"subsurface_color": base, "subsurface_scatter_anisotropy": g}
        parts.append(Lobe("subsurface", _times(below, scattering), node, base, keys | sides, interface))
    elif not scattering.is_everywhere(0):
        transport = transport_keys(
            node.subsurface_method,
            base,
            evaluator.value(output.input("Subsurface Radius"), [1.0, 0.2, 0.1]).color(),
            evaluator.value(output.input("Subsurface Scale"), 0.05),
            number("Subsurface IOR", 1.4) if node.subsurface_method == "RANDOM_WALK_SKIN" else index,
            _number(evaluator, output, "Subsurface Anisotropy", 0.0),
            roughness.number**2,
        )
        _say_of_attribute(evaluator, node, base)
        parts.append(Lobe("subsurface", _times(below, scattering), node, base, keys | transport, interface))
    lobes = [lobe for lobe in parts if not lobe.weight.is_everywhere(0)]
    emission = (evaluator.value(output.input(name), default) for name, default in (("Emission Color", [1.0, 1.0, 1.0]), ("Emission Strength", 0.0)))
    emitted = _radiance(evaluator, node, *emission)
    if not emitted.is_everywhere(0):
        lobes.append(Lobe("emission", solid, node, emitted))
    return lobes


# The renderer's mean cosines are less than 1.
_MOST_ANISOTROPIC = 0.9999


def _is_thin_walled(evaluator, output):
    """Whether the surface is a sheet, which Blender's have been able to be since 5.2."""
    value = evaluator.value(output.input("Thin Wall"), 0.0)
    if not value.is_constant:
        evaluator.say(output.node, "Thin Wall cannot change over a surface; it is as on most of it")
    return value.number > 0.5


def _coat_depth(ior):
    """The mean way through a coat of thickness 1 that is seen from everywhere: ∫ 2 μ / μ_t(μ) dμ.

    Cycles' tint is that of its thickness, and darkens with the way; the renderer's is the same for all directions.
    """
    return 2 * ior**2 * (1 - (1 - 1 / ior**2) ** 0.5) if ior > 1 else 2.0


def _glass_color(base, transmission):
    return base if transmission.is_everywhere(0) else combine(np.sqrt, base)


_SHADERS = {
    "BSDF_DIFFUSE": _diffuse,
    "SUBSURFACE_SCATTERING": _subsurface,
    "BSDF_GLOSSY": _glossy,
    "BSDF_ANISOTROPIC": _glossy,
    "BSDF_METALLIC": _metallic,
    "BSDF_GLASS": _glass,
    "BSDF_REFRACTION": _glass,
    "BSDF_TRANSPARENT": _transparent,
    "EMISSION": _emission,
    "BSDF_PRINCIPLED": _principled,
    "MIX_SHADER": _mix,
    "ADD_SHADER": _add,
}


# --- one material of many lobes


class _MaterialKeys:
    """The keys of a sum of lobes, as values."""

    def __init__(self, evaluator, name, lobes):
        self._evaluator, self._name = evaluator, name
        lobes = _shared(lobes)
        lobes = lobes + _unlit(lobes)
        groups = {kind: [lobe for lobe in lobes if lobe.kind == kind] for kind in _KINDS}
        weights = {kind: _sum(lobe.weight for lobe in group) for kind, group in groups.items()}
        surface = [lobe for kind in ("metal", "glass", "subsurface", "diffuse") for lobe in groups[kind]]
        self.keys = {}
        self._weigh(weights, surface)
        self._wall(groups["subsurface"] + groups["glass"])
        self._color(groups)
        self._scatter(groups["subsurface"])
        self._cover(surface, weights)
        self._emit(groups["emission"])
        self._shape(surface)

    def _say(self, lobe, text):
        self._evaluator.say(lobe.node, text)

    def _weigh(self, weights, surface):
        opaque = _sum([weights["subsurface"], weights["diffuse"]])
        dielectric = _sum([weights["glass"], opaque])
        solid = _sum([weights["metal"], dielectric])
        whole = _sum([weights["transparent"], solid])
        # Of matte surfaces that are added the colors are; of others that is more than one material knows.
        self._gain = None
        if float(whole.linear.max()) > 1 + 1e-4:
            if weights["transparent"].is_everywhere(0) and all(lobe.kind == "diffuse" and not lobe.interface for lobe in surface):
                self._gain = whole
            else:
                self._say(surface[-1], "surfaces that are added are mixed by their weights")
        opacity = combine(lambda t, w: 1 - t / np.maximum(w, 1), weights["transparent"], whole)
        self.keys["base_metalness"] = _share(weights["metal"], solid)
        self.keys["transmission_weight"] = _share(weights["glass"], dielectric)
        self.keys["subsurface_weight"] = _share(weights["subsurface"], opaque)
        self.keys["geometry_opacity"] = combine(lambda x: np.clip(x, 0, 1), opacity)
        self._opaque = opaque

    def _wall(self, passed):
        """Whether the surface is a sheet: parts that no light passes are alike with and without an inside."""
        walls = [lobe.keys.get("geometry_thin_walled", False) for lobe in passed]
        if len(set(walls)) > 1:
            self._say(passed[0], "thin-walled parts of a surface and others are all as the first that light passes")
        if walls and walls[0]:
            self.keys["geometry_thin_walled"] = True

    def _color(self, groups):
        matte = _mean_color(groups["diffuse"])
        metal = _mean_color(groups["metal"])
        if self._gain is not None:
            matte = _times(matte, self._gain)
            if float(matte.linear.max()) > 1:
                self._say(groups["diffuse"][0], "surfaces that are added reflect more light than arrives; they reflect all of it")
                matte = combine_unit(matte)
        if matte is not None and metal is not None and not _same(matte, metal):
            if groups["subsurface"]:
                self._say(groups["metal"][0], "a matte and a metallic part of one surface have the same color, the mean of theirs")
                matte = _mean_color(groups["diffuse"] + groups["metal"])
            else:
                # Scattering without transport is matte, too, and has a color of its own.
                self.keys |= {"subsurface_model": "none", "subsurface_weight": _ONE, "subsurface_color": matte}
                if "geometry_thin_walled" in self.keys:
                    self.keys["subsurface_scatter_anisotropy"] = -_MOST_ANISOTROPIC
                matte = None
        base = matte if matte is not None else metal
        self.keys["base_color"] = base if base is not None else Value.of(DEFAULT_COLOR)
        if groups["glass"]:
            self.keys["transmission_color"] = _mean_color(groups["glass"])

    def _scatter(self, lobes):
        if not lobes:
            return
        first = lobes[0]
        if any(not _same_keys(lobe.keys, first.keys) for lobe in lobes[1:]):
            self._say(lobes[1], "subsurface scattering of several kinds in one surface is that of the first")
        self.keys |= {key: value for key, value in first.keys.items() if key.startswith("subsurface_")}
        if len(lobes) > 1:
            self.keys["subsurface_color"] = _mean_color(lobes)
        self._entry_roughness = first.keys.get("specular_roughness")

    def _cover(self, surface, weights):
        """The interface: what of the matte parts has one, and its roughness and index."""
        with_interface = [lobe for lobe in surface if lobe.interface]
        covered = _sum(lobe.weight for lobe in with_interface if lobe.kind in {"subsurface", "diffuse"})
        share = _share(covered, self._opaque)
        has_mirror = any(lobe.kind in {"metal", "glass"} for lobe in surface)
        self.keys["specular_weight"] = _ONE if has_mirror else share
        if not with_interface:
            self._enter(surface)
            return
        first = next((lobe for lobe in with_interface if lobe.kind != "metal"), with_interface[0])
        if any(not _same_keys(lobe.interface, first.interface) for lobe in with_interface if lobe.kind != "metal"):
            self._say(first, "parts of one surface with different roughness, index or coat have those of the first")
        metal = next((lobe for lobe in with_interface if lobe.kind == "metal"), first)
        if not _same(metal.interface["specular_roughness"], first.interface["specular_roughness"]):
            self._say(metal, "a metallic part of a surface has the roughness of the other part")
        metals = [lobe for lobe in with_interface if lobe.kind == "metal"]
        if any(not _same(lobe.interface["specular_roughness"], metal.interface["specular_roughness"]) for lobe in metals):
            self._say(metal, "metallic parts of one surface with different roughness have that of the first")
        self.keys |= first.interface
        if first.kind == "metal":
            self._tint(metals)
        elif metals and not _same(_edge(metal), _edge(first)):
            self._say(metal, "a metallic part of a surface has the specular tint of the other part")
        if has_mirror and share.is_everywhere(0) and not weights["glass"].is_everywhere(0):
            if not self._opaque.is_everywhere(0):
                self._say(first, "the matte part beside glass gets a specular reflection, too")
        elif has_mirror and share.is_everywhere(0):
            self.keys["specular_ior"] = _ONE
        elif has_mirror and not share.is_everywhere(1) and not self._opaque.is_everywhere(0):
            self._say(first, "a matte part beside a metal or glass has the specular reflection everywhere")
        self._enter(surface)

    def _tint(self, metals):
        """The tint of metals of one surface, whose reflectances are mixed at 0° and 82°."""
        if any(not _same(_edge(lobe), _edge(metals[0])) for lobe in metals):
            at_edge = [combine(lambda f0, tint: schlick(f0, 1 / 7) * tint, lobe.color, _edge(lobe)) for lobe in metals]
            self.keys["specular_color"] = combine(edge_tint, _mean_color(metals), _mean(metals, at_edge))

    def _enter(self, surface):
        """Walks enter through the roughness of the interface, also where it reflects nothing."""
        roughness = getattr(self, "_entry_roughness", None)
        if roughness is None:
            return
        if "specular_roughness" not in self.keys or self.keys["specular_weight"].is_everywhere(0):
            self.keys["specular_roughness"] = roughness
        elif not any(lobe.interface for lobe in surface if lobe.kind == "subsurface") and not _same(self.keys["specular_roughness"], roughness):
            self._say(surface[0], "the view enters what scatters through the roughness of the reflection beside it")

    def _emit(self, lobes):
        if not lobes:
            return
        opacity = self.keys["geometry_opacity"]
        if opacity.is_everywhere(0):
            self._say(lobes[0], "light that is added to a transparent surface cannot be translated; it is opaque")
            opacity = self.keys["geometry_opacity"] = _ONE
        elif not opacity.is_everywhere(1):
            self._say(lobes[0], "a transparent surface that glows shines from its front only")
        if len(lobes) == 1 and lobes[0].weight.is_constant and opacity.is_constant:
            factor = lobes[0].weight.number / opacity.number
            color = lobes[0].color
            radiance = Value(color.linear * np.float32(factor), color.placement, color.attribute)
        else:
            radiance = combine(
                lambda o, *rest: sum(w * c for w, c in zip(rest[::2], rest[1::2], strict=True)) / np.maximum(o, 1e-3),
                opacity,
                *(value for lobe in lobes for value in (lobe.weight, lobe.color)),
            )
        # Colors of textures and meshes are in [0, 1]; the strength is a number apart.
        brightest = float(radiance.linear.max())
        if brightest > 0:
            self.keys["emission_luminance"] = brightest
            self.keys["emission_color"] = Value(radiance.linear / brightest, radiance.placement, radiance.attribute)

    def _shape(self, surface):
        maps = [lobe.keys.get("geometry_normal") for lobe in surface]
        given = [value for value in maps if value is not None]
        if not given:
            return
        if len(given) < len(maps) or any(not _same(value, given[0]) for value in given[1:]):
            self._say(surface[0], "shaders of one surface with different normals have those of the first normal map")
        self.keys["geometry_normal"] = given[0]


def _shared(lobes):
    """Glossy and matte lobes that are added, as mixed ones: each with a share for the light that it reflects."""
    surface = [lobe for lobe in lobes if lobe.kind != "emission"]
    kinds = {lobe.kind for lobe in surface}
    are_even = all(lobe.node.type in {"BSDF_DIFFUSE", "BSDF_GLOSSY", "BSDF_ANISOTROPIC"} for lobe in surface)
    if not are_even or "metal" not in kinds or float(_sum(lobe.weight for lobe in surface).linear.max()) <= 1 + 1e-4:
        return lobes
    reflected = [_times(lobe.weight, lobe.color) for lobe in surface]
    brightest = [max(float(value.linear.max()), 1e-6) for value in reflected]
    if sum(brightest) > 1:
        # More than one surface can reflect: it is said where they are weighed.
        return lobes
    found = []
    for lobe, value, share in zip(surface, reflected, brightest, strict=True):
        color = combine(lambda x, share=share: x * sum(brightest) / share, value)
        interface = lobe.interface | ({"specular_color": combine(even_tint, color)} if lobe.kind == "metal" else {})
        found.append(replace(lobe, weight=Value.of(share / sum(brightest)), color=color, interface=interface))
    return found + [lobe for lobe in lobes if lobe.kind == "emission"]


def _unlit(lobes):
    """The black part of what is neither transparent nor scatters: emission takes it where shaders are mixed."""
    weights = [lobe.weight for lobe in lobes if lobe.kind != "emission"]
    rest = combine(lambda x: np.maximum(1 - x, 0), _sum(weights))
    if float(rest.linear.max()) < 1e-5:
        return []
    return [Lobe("diffuse", rest, lobes[0].node, Value.of([0.0, 0.0, 0.0]))]


_KINDS = ("metal", "glass", "subsurface", "diffuse", "transparent", "emission")


def _sum(values):
    values = list(values)
    return combine(lambda *all: sum(all), *values) if values else _ZERO


def _share(part, whole):
    if part.is_everywhere(0):
        return _ZERO
    if part is whole or _same(part, whole):
        return _ONE
    return combine(lambda p, w: np.where(w > 0, np.clip(p / np.where(w > 0, w, 1), 0, 1), 0), part, whole)


def _same(a, b):
    if a is b:
        return True
    if (a.placement, a.attribute, a.pixels.shape) != (b.placement, b.attribute, b.pixels.shape):
        return False
    return a.pixels is b.pixels or bool(np.array_equal(a.linear, b.linear))


def _same_keys(a, b):
    def same(x, y):
        return _same(x, y) if isinstance(x, Value) and isinstance(y, Value) else x == y

    return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)


def _edge(lobe):
    """The tint of a lobe's reflection."""
    return lobe.interface.get("specular_color", Value.of([1.0, 1.0, 1.0]))


def _mean_color(lobes):
    """The color of lobes of one kind, weighted."""
    return _mean(lobes, [lobe.color for lobe in lobes]) if lobes else None


def _mean(lobes, values):
    """The mean of values of lobes, weighted."""
    if all(_same(value, values[0]) for value in values):
        return values[0]

    def function(*rest):
        weights, values = rest[::2], rest[1::2]
        whole = sum(weights)
        return sum(w * v for w, v in zip(weights, values, strict=True)) / np.where(whole > 0, whole, 1)

    return combine(function, *(value for pair in zip((lobe.weight for lobe in lobes), values, strict=True) for value in pair))


# --- spelling


_COLORS = {
    "base_color",
    "specular_color",
    "transmission_color",
    "subsurface_color",
    "subsurface_radius_scale",
    "coat_color",
    "emission_color",
}

# Keys that take a number only.
_NUMBERS = {
    "specular_ior": (1.0, 4.0),
    "coat_ior": (1.0, 4.0),
    "subsurface_scatter_anisotropy": (-0.95, 0.95),
    "subsurface_eta": (0.5, 3.0),
    "subsurface_flights": (2, 65536),
}


def _spelled(evaluator, node, keys):
    """The keys as the renderer takes them."""
    spelled, layers, attributes = {}, [], []
    for key, value in keys.items():
        if not isinstance(value, Value):
            spelled[key] = value
            continue
        if value.placement is not None:
            layers.append(value.placement.layer)
        if value.attribute is not None:
            attributes.append(value.attribute)
        spelled[key] = _spelled_value(evaluator, node, key, value)
    for names, what in ((layers, "UV maps"), (attributes, "color attributes")):
        if len(set(names)) > 1:
            evaluator.say(node, f"of several {what} in one material only {names[0] or 'the active one'!r} is used")
    return Material(spelled, layers[0] if layers else None, attributes[0] if attributes else None)


def _spelled_value(evaluator, node, key, value):
    if key in _NUMBERS:
        if not value.is_constant:
            evaluator.say(node, f"a texture of {key} cannot be translated; its mean is used")
        low, high = _NUMBERS[key]
        return min(max(value.number, low), high)
    if value.is_constant:
        constant = value.constant
        return [float(x) for x in constant] if key in _COLORS else float(constant[0])
    if value.placement is None:
        if key not in _COLORS or not (key == "emission_color" or np.all(value.linear == 1)):
            evaluator.say(node, f"a color attribute of {key} cannot be translated; it is white")
            return [1.0, 1.0, 1.0] if key in _COLORS else 1.0
        if np.all(value.linear == 1):
            return "vertex"
        evaluator.say(node, "a color attribute that is scaled by a color has the mean of it")
        return "vertex"
    place, is_exact = value.placement.keys()
    if not is_exact:
        evaluator.say(node, f"a texture of {key} is skewed, which cannot be translated; it is turned and stretched")
    # The renderer keeps sRGB codes, linear numbers as floating point.
    table = {"image": value.pixels if key in _COLORS else value.linear, **place}
    if key in _COLORS:
        table["color_space"] = "srgb" if value.pixels.dtype == np.uint8 else "linear"
        if value.attribute is not None:
            table["vertex_color"] = True
    elif key != "geometry_normal":
        table["image"] = np.ascontiguousarray(value.scalar().linear[..., 0])
    return table
