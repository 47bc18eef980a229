# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader nodes as constants and textures.

What depends on texture coordinates is calculated here, texel by texel; what depends on anything else, as the point or
the view, is reported and replaced by its nearest.
"""

import numpy as np

from .arithmetic import MATH, VECTOR_MATH, dot, mapped_range, normalized, rotated
from .colors import BLENDS, FROM_MODE, TO_MODE, blackbody, hsv_to_rgb, luminance, rgb_to_hsv
from .image import pixels_of
from .value import Placement, Value, combine

# Samples of a color ramp or curve.
_RAMP = 1025


class Socket:
    """An input of a node, within the groups that it is in."""

    def __init__(self, socket, groups=()):
        self.socket, self.groups = socket, groups

    @property
    def node(self):
        return self.socket.node

    def source(self):
        """The output that feeds it, through reroutes, groups and muted nodes; or the input whose own value counts."""
        socket, groups = self.socket, self.groups
        while True:
            link = next((link for link in socket.links if link.is_valid and not link.is_muted), None)
            if link is None:
                return None, Socket(socket, groups)
            output, node = link.from_socket, link.from_node
            if node.type == "GROUP" and node.node_tree is not None and not node.mute:
                ends = [inner for inner in node.node_tree.nodes if inner.type == "GROUP_OUTPUT"]
                end = next((inner for inner in ends if inner.is_active_output), None)
                if end is None:
                    return Output(output, groups), None
                groups = (*groups, node)
                socket = _by_identifier(end.inputs, output.identifier)
            elif node.type == "GROUP_INPUT" and groups:
                socket, groups = _by_identifier(groups[-1].inputs, output.identifier), groups[:-1]
            elif node.type == "REROUTE":
                socket = node.inputs[0]
            elif node.mute:
                passed = next((link for link in node.internal_links if link.to_socket == output), None)
                if passed is None:
                    return Output(output, groups), None
                socket = passed.from_socket
            else:
                return Output(output, groups), None

    @property
    def is_linked(self):
        return self.source()[0] is not None


class Output:
    """An output of a node, within the groups that it is in."""

    def __init__(self, socket, groups):
        self.socket, self.groups, self.node = socket, groups, socket.node

    def input(self, name):
        """An input of its node, by identifier or name; None where this version of Blender has none."""
        socket = _by_identifier(self.node.inputs, name) or self.node.inputs.get(name)
        return None if socket is None else Socket(socket, self.groups)


def _by_identifier(sockets, identifier):
    return next((socket for socket in sockets if socket.identifier == identifier), None)


class Evaluator:
    """The values of sockets; what it cannot calculate it reports for `name`.

    `placement_of` is how the texture that takes the coordinates of a socket lies, by UV unless something else is given.
    """

    def __init__(self, report, name, placement_of=None):
        self._report, self._name = report, name
        self._values = {}
        self._placement_of = placement_of or Evaluator._uv_placement

    def say(self, node, text):
        self._report.add(self._name, node.label or node.name, text)

    def value(self, socket, default=0.0):
        """The value of an input, of as many channels as its kind has; the default where there is no such input."""
        if socket is None:
            return Value.of(default)
        output, end = socket.source()
        if output is not None:
            return _as_kind(self.output(output), socket.socket.type)
        # A vector whose value is hidden, as a normal, is that of the place; hidden colors count.
        is_implied = end.socket.hide_value and end.socket.type == "VECTOR"
        if is_implied or not hasattr(end.socket, "default_value"):
            return Value.of(default)
        number = end.socket.default_value
        if end.socket.type == "RGBA":
            number = tuple(number)[:3]
        return _as_kind(Value.of(number), socket.socket.type)

    def output(self, output):
        """The value of an output."""
        key = (output.socket.as_pointer(), tuple(group.as_pointer() for group in output.groups))
        if key not in self._values:
            evaluate = _NODES.get(output.node.type)
            if evaluate is None:
                self.say(output.node, f"a {output.node.bl_label} node cannot be translated; its output counts as 0.5")
                self._values[key] = Value.of(0.5)
            else:
                self._values[key] = evaluate(self, output)
        return self._values[key]

    @property
    def sees_directions(self):
        """Whether textures are looked up by the direction of a ray, as those of a world."""
        return self._placement_of is not Evaluator._uv_placement

    def placement(self, socket, wrap):
        """How the texture that takes these coordinates lies on the surface."""
        return self._placement_of(self, socket, wrap)

    def _uv_placement(self, socket, wrap):
        output, _ = socket.source()
        plain = Placement(wrap=wrap)
        if output is None:
            return plain
        node = output.node
        if node.type == "UVMAP":
            return Placement(wrap=wrap, layer=node.uv_map)
        if node.type == "TEX_COORD":
            if output.socket.identifier != "UV":
                self.say(node, f"{output.socket.name} coordinates cannot be translated; the UV map is used")
            return plain
        if node.type == "MAPPING":
            before = self._uv_placement(output.input("Vector"), wrap)
            return before.mapped(*self._affine(output))
        self.say(node, f"texture coordinates from a {node.bl_label} node cannot be translated; the UV map is used")
        return plain

    def _affine(self, output):
        """The map of a Mapping node, of u and v."""
        location, rotation, scale = (
            self.value(output.input(name)).color().constant for name in ("Location", "Rotation", "Scale")
        )
        kind = output.node.vector_type
        if abs(rotation[0]) > 1e-6 or abs(rotation[1]) > 1e-6:
            self.say(output.node, "rotations about x and y cannot be translated and are left out")
        cos, sin = np.cos(rotation[2]), np.sin(rotation[2])
        turn, stretch = np.array([[cos, -sin], [sin, cos]]), np.diag(scale[:2])
        if kind == "TEXTURE":
            if np.any(scale[:2] == 0):
                self.say(output.node, "a scale of 0 cannot be undone and is left out")
                stretch = np.eye(2)
            linear = np.linalg.inv(stretch) @ turn.T
            return linear, -linear @ location[:2]
        if kind == "POINT":
            return turn @ stretch, location[:2]
        if kind == "VECTOR":
            return turn @ stretch, np.zeros(2)
        self.say(output.node, "the kind Normal cannot be translated; texture coordinates are taken as they are")
        return np.eye(2), np.zeros(2)


def _as_kind(value, kind):
    if kind in {"RGBA", "VECTOR"}:
        return value.color()
    return value.scalar() if value.channels != 1 else value


# --- nodes: each takes the evaluator and the output that is asked for

_EXTENSIONS = {"REPEAT": "repeat", "EXTEND": "clamp", "MIRROR": "mirror", "CLIP": "clamp"}


def _image_texture(evaluator, output):
    node = output.node
    # Cycles' color of a missing image.
    missing = Value.of([1.0, 0.0, 1.0])
    if node.image is None:
        evaluator.say(node, "it has no image and is magenta, as in Cycles")
        return missing
    pixels = pixels_of(node.image, lambda text: evaluator.say(node, f"image {node.image.name}: {text}"))
    if pixels is None:
        evaluator.say(node, f"image {node.image.name} cannot be read and is magenta, as in Cycles")
        return missing
    wrap = "repeat"
    if node.type == "TEX_IMAGE":
        if node.projection != "FLAT":
            evaluator.say(node, f"the projection {node.projection.capitalize()} cannot be translated; it is flat")
        if node.extension == "CLIP":
            evaluator.say(node, "the extension Clip cannot be translated; the edge is extended")
        wrap = _EXTENSIONS[node.extension]
    elif not evaluator.sees_directions:
        evaluator.say(node, "an environment on a surface cannot be translated; the UV map is used")
    elif node.projection != "EQUIRECTANGULAR":
        evaluator.say(node, "the projection Mirror Ball cannot be translated; it is equirectangular")
    if node.interpolation == "Closest":
        evaluator.say(node, "the interpolation Closest cannot be translated; it is linear")
    placement = evaluator.placement(output.input("Vector"), wrap)
    alpha = pixels[..., 3:4]
    if alpha.dtype == np.uint8:
        alpha = alpha.astype(np.float32) / 255
    if output.socket.identifier == "Alpha":
        return Value(alpha, placement)
    return Value(_color_as_in_cycles(node, pixels, alpha), placement)


def _color_as_in_cycles(node, pixels, alpha):
    """An image's color, associated with its alpha as Cycles has it.

    Cycles keeps colors associated with alpha, codes of sRGB before they are decoded, and undoes it where an image texture's
    alpha is used, too (`util/image.cpp`, `svm_image_texture`). Data, and channels without a common meaning, stay as they are.
    """
    color = np.ascontiguousarray(pixels[..., :3])
    mode = node.image.alpha_mode
    if mode in {"NONE", "CHANNEL_PACKED"} or node.image.colorspace_settings.is_data or float(alpha.min()) == 1:
        return color
    is_undone = node.type == "TEX_IMAGE" and node.outputs["Alpha"].is_linked
    is_associated = mode == "PREMUL" and color.dtype != np.uint8
    if is_undone != is_associated:
        return color
    factor = np.divide(1, alpha, out=np.ones_like(alpha), where=alpha > 0) if is_undone else alpha
    if color.dtype == np.uint8:
        return np.minimum(color * factor, 255).astype(np.uint8)
    return color * factor


def _vertex_color(evaluator, output):
    name = output.node.layer_name if output.node.type == "VERTEX_COLOR" else output.node.attribute_name
    if output.node.type == "ATTRIBUTE" and output.node.attribute_type != "GEOMETRY":
        evaluator.say(output.node, f"an attribute of {output.node.attribute_type} cannot be translated; it is white")
        return Value.of([1.0, 1.0, 1.0])
    if output.socket.identifier != "Color":
        evaluator.say(output.node, f"the output {output.socket.name} cannot be translated; it is 1")
        return Value.of(1.0)
    return Value(np.ones((1, 1, 3), dtype=np.float32), None, name)


def _given(evaluator, output):
    number = output.node.outputs[0].default_value
    return Value.of(tuple(number)[:3] if output.node.type == "RGB" else number)


def _combine(evaluator, output, function, *values):
    """A function of values, which a mesh's colors get lost in: said where there are any."""
    if any(value.attribute for value in values):
        evaluator.say(output.node, "a color attribute can be used directly or times a constant only; it is white here")
    return combine(function, *values)


def _ramp(evaluator, output):
    node = output.node
    channels = slice(0, 3) if output.socket.identifier == "Color" else slice(3, 4)
    factor = evaluator.value(output.input("Fac"))
    if factor.is_constant:
        return Value.of(tuple(node.color_ramp.evaluate(factor.number))[channels])
    table = np.array([tuple(node.color_ramp.evaluate(i / (_RAMP - 1)))[channels] for i in range(_RAMP)])
    return _combine(evaluator, output, lambda x: _look_up(table, x), factor)


def _look_up(table, x):
    place = np.linspace(0, 1, _RAMP)
    return np.stack([np.interp(x[..., 0], place, column) for column in table.T], axis=-1)


def _curves(evaluator, output):
    """Of colors, vectors or a number: curves of the channels, of colors after that of all."""
    node, mapping = output.node, output.node.mapping
    mapping.initialize()
    factor, color = (evaluator.value(Socket(socket, output.groups)) for socket in node.inputs[:2])
    # Vectors have coordinates of both signs.
    place = np.linspace(-1, 1, 2 * _RAMP - 1) if node.type == "CURVE_VEC" else np.linspace(0, 1, _RAMP)
    curves = mapping.curves[: color.channels]
    all_of = mapping.curves[3] if node.type == "CURVE_RGB" else None
    tables = [np.array([_curved(mapping, (curve, all_of), x) for x in place]) for curve in curves]

    def function(factor, color):
        curved = np.stack([np.interp(color[..., i], place, table) for i, table in enumerate(tables)], axis=-1)
        return color + factor * (curved - color)

    return _combine(evaluator, output, function, factor, color)


def _curved(mapping, curves, x):
    for curve in curves:
        x = mapping.evaluate(curve, x) if curve is not None else x
    return x


def _mix(evaluator, output):
    node = output.node
    if node.type == "MIX":
        kind = {"FLOAT": "Float", "VECTOR": "Vector", "RGBA": "Color"}.get(node.data_type)
        if kind is None:
            evaluator.say(node, f"a mix of {node.data_type.lower()}s cannot be translated; it is 0.5")
            return Value.of(0.5)
        uniform = kind != "Vector" or node.factor_mode == "UNIFORM"
        names = ("Factor_Float" if uniform else "Factor_Vector", f"A_{kind}", f"B_{kind}")
        blend = node.blend_type if kind == "Color" else "MIX"
        clamp_factor, clamp_result = node.clamp_factor, kind == "Color" and node.clamp_result
    else:
        names, blend = ("Fac", "Color1", "Color2"), node.blend_type
        clamp_factor, clamp_result = True, node.use_clamp
    function = BLENDS[blend]
    factor, a, b = (evaluator.value(output.input(name)) for name in names)
    tinted = _tinted(blend, factor, a, b)
    if tinted is not None:
        return tinted

    def mixed(factor, a, b):
        t = np.clip(factor, 0, 1) if clamp_factor else factor
        result = function(t, a, b)
        return np.clip(result, 0, 1) if clamp_result else result

    return _combine(evaluator, output, mixed, factor, a, b)


def _tinted(blend, factor, a, b):
    """A product of a mesh's colors with something else: the renderer knows that."""
    if blend != "MULTIPLY" or not factor.is_everywhere(1) or bool(a.attribute) == bool(b.attribute):
        return None
    colors, other = (a, b) if a.attribute else (b, a)
    product = combine(np.multiply, Value(colors.pixels, colors.placement), other)
    return Value(product.pixels, product.placement, colors.attribute)


def _math(evaluator, output):
    node = output.node
    function = MATH.get(node.operation)
    if function is None:
        evaluator.say(node, f"the operation {node.operation.capitalize()} cannot be translated; it counts as 0.5")
        return Value.of(0.5)
    values = [evaluator.value(Socket(socket, output.groups)) for socket in node.inputs[:3]]
    values += [Value.of(0.0)] * (3 - len(values))

    def clamped(*numbers):
        result = function(*numbers)
        return np.clip(result, 0, 1) if node.use_clamp else result

    return _combine(evaluator, output, clamped, *values)


def _vector_math(evaluator, output):
    node = output.node
    values = [evaluator.value(Socket(socket, output.groups)) for socket in node.inputs[:3]]
    function = VECTOR_MATH.get(node.operation)
    if function is None:
        evaluator.say(node, f"the operation {node.operation.capitalize()} cannot be translated; it counts as 0.5")
        return Value.of(0.5)
    return _combine(evaluator, output, function, *values, evaluator.value(output.input("Scale"), 1.0))


def _vector_rotate(evaluator, output):
    node = output.node
    vector, center, axis = (evaluator.value(output.input(name)) for name in ("Vector", "Center", "Axis"))
    sign = -1 if node.invert else 1
    axes = np.eye(3, dtype=np.float32)
    if node.rotation_type == "EULER_XYZ":
        angles = evaluator.value(output.input("Rotation"))

        def function(vector, center, angles):
            for i in (range(3) if sign > 0 else reversed(range(3))):
                vector = rotated(vector, center, axes[i], sign * angles[..., i : i + 1])
            return vector

        return _combine(evaluator, output, function, vector, center, angles)
    if node.rotation_type != "AXIS_ANGLE":
        axis = Value.of(axes["XYZ".index(node.rotation_type[0])])
    angle = evaluator.value(output.input("Angle"))
    return _combine(evaluator, output, lambda v, c, a, t: rotated(v, c, a, sign * t), vector, center, axis, angle)


def _normal(evaluator, output):
    direction = Value.of(tuple(output.node.outputs["Normal"].default_value))
    if output.socket.identifier == "Normal":
        return direction
    given = evaluator.value(output.input("Normal"))
    return _combine(evaluator, output, lambda a, b: dot(normalized(a), normalized(b)), direction, given)


def _invert(evaluator, output):
    factor, color = evaluator.value(output.input("Fac"), 1.0), evaluator.value(output.input("Color"))
    return _combine(evaluator, output, lambda f, c: c + f * (1 - 2 * c), factor, color)


def _gamma(evaluator, output):
    color, gamma = evaluator.value(output.input("Color")), evaluator.value(output.input("Gamma"), 1.0)
    return _combine(evaluator, output, lambda c, g: np.where(c > 0, np.power(np.maximum(c, 1e-30), g), c), color, gamma)


def _bright_contrast(evaluator, output):
    color, bright, contrast = (evaluator.value(output.input(name)) for name in ("Color", "Bright", "Contrast"))
    function = lambda c, b, k: np.maximum((1 + k) * c + b - k / 2, 0)
    return _combine(evaluator, output, function, color, bright, contrast)


def _hue_saturation(evaluator, output):
    names = ("Hue", "Saturation", "Value", "Fac", "Color")
    values = [evaluator.value(output.input(name)) for name in names]

    def function(hue, saturation, value, factor, color):
        h, s, v = np.moveaxis(rgb_to_hsv(np.broadcast_to(color, np.broadcast_shapes(color.shape, hue.shape))), -1, 0)
        h = np.mod(h + hue[..., 0] + 0.5, 1)
        changed = hsv_to_rgb(np.stack([h, np.clip(s * saturation[..., 0], 0, 1), v * value[..., 0]], axis=-1))
        return color + factor * (np.maximum(changed, 0) - color)

    return _combine(evaluator, output, function, *values)


def _clamp(evaluator, output):
    value, low, high = (evaluator.value(output.input(name)) for name in ("Value", "Min", "Max"))

    def function(x, a, b):
        if output.node.clamp_type == "RANGE":
            a, b = np.minimum(a, b), np.maximum(a, b)
        return np.clip(x, a, np.maximum(a, b))

    return _combine(evaluator, output, function, value, low, high)


def _map_range(evaluator, output):
    node = output.node
    is_vector = node.data_type == "FLOAT_VECTOR"
    names = ("From Min", "From Max", "To Min", "To Max", "Steps")
    names = ("Vector", *(name.replace(" ", "_") + "_FLOAT3" for name in names)) if is_vector else ("Value", *names)
    values = [evaluator.value(output.input(name)) for name in names]

    def function(x, from_low, from_high, to_low, to_high, steps):
        found = mapped_range(node.interpolation_type, x, from_low, from_high, to_low, to_high, steps)
        return np.clip(found, np.minimum(to_low, to_high), np.maximum(to_low, to_high)) if node.clamp else found

    return _combine(evaluator, output, function, *values)


def _separate(evaluator, output):
    node = output.node
    color = evaluator.value(Socket(node.inputs[0], output.groups))
    channel = list(node.outputs).index(output.socket)
    mode = getattr(node, "mode", "RGB")
    if mode != "RGB":
        return _combine(evaluator, output, lambda c: TO_MODE[mode](c)[..., channel : channel + 1], color)
    if color.attribute is None:
        return Value(np.ascontiguousarray(color.linear[..., channel : channel + 1]), color.placement)
    return _combine(evaluator, output, lambda c: c[..., channel : channel + 1], color)


def _join(evaluator, output):
    node = output.node
    parts = [evaluator.value(Socket(socket, output.groups)) for socket in node.inputs[:3]]

    def function(*parts):
        color = np.concatenate(np.broadcast_arrays(*parts), axis=-1)
        return FROM_MODE[getattr(node, "mode", "RGB")](color)

    return _combine(evaluator, output, function, *parts)


def _to_gray(evaluator, output):
    return _combine(evaluator, output, luminance, evaluator.value(output.input("Color")))


def _blackbody(evaluator, output):
    temperature = evaluator.value(output.input("Temperature")).number
    return Value.of(blackbody(temperature))


_NODES = {
    "TEX_IMAGE": _image_texture,
    "TEX_ENVIRONMENT": _image_texture,
    "VERTEX_COLOR": _vertex_color,
    "ATTRIBUTE": _vertex_color,
    "RGB": _given,
    "VALUE": _given,
    "VALTORGB": _ramp,
    "CURVE_RGB": _curves,
    "CURVE_VEC": _curves,
    "CURVE_FLOAT": _curves,
    "MIX": _mix,
    "MIX_RGB": _mix,
    "MATH": _math,
    "VECT_MATH": _vector_math,
    "VECTOR_ROTATE": _vector_rotate,
    "NORMAL": _normal,
    "INVERT": _invert,
    "GAMMA": _gamma,
    "BRIGHTCONTRAST": _bright_contrast,
    "HUE_SAT": _hue_saturation,
    "CLAMP": _clamp,
    "MAP_RANGE": _map_range,
    "SEPARATE_COLOR": _separate,
    "SEPRGB": _separate,
    "SEPXYZ": _separate,
    "COMBINE_COLOR": _join,
    "COMBRGB": _join,
    "COMBXYZ": _join,
    "RGBTOBW": _to_gray,
    "BLACKBODY": _blackbody,
}
