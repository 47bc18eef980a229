# SPDX-License-Identifier: GPL-3.0-or-later
"""Constants and textures that nodes calculate with."""

from dataclasses import dataclass, field, replace

import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)

# Longest edge of what is baked, where textures with different placements meet.
LONGEST_BAKED_EDGE = 2048

_codes = np.arange(256, dtype=np.float64) / 255
_DECODED = np.where(_codes <= 0.04045, _codes / 12.92, ((_codes + 0.055) / 1.055) ** 2.4).astype(np.float32)


@dataclass(frozen=True)
class Placement:
    """How a texture lies on a surface: texture coordinates times a 2×3 matrix, u and v wrapped.

    `layer` is the UV map; the empty name is the mesh's own choice.
    """

    matrix: tuple = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    wrap: str = "repeat"
    layer: str = ""

    def mapped(self, linear, offset):
        """The placement after a further affine map."""
        own = np.array(self.matrix)
        new = np.column_stack([linear @ own[:, :2], linear @ own[:, 2] + offset])
        return replace(self, matrix=tuple(tuple(float(x) for x in row) for row in new))

    def coordinates(self, height, width):
        """Coordinates in the texture of the pixel centers of the unit square of UV space."""
        u = (np.arange(width) + 0.5) / width
        v = 1 - (np.arange(height) + 0.5) / height
        matrix = np.array(self.matrix)
        return tuple(row[0] * u[None, :] + row[1] * v[:, None] + row[2] for row in matrix)

    def keys(self):
        """The keys of an image table, and whether they say all of it."""
        matrix = np.array(self.matrix)
        linear = matrix[:, :2]
        scale = np.hypot(linear[0], linear[1])
        angle = np.arctan2(linear[1, 0], linear[0, 0])
        if np.linalg.det(linear) < 0:
            scale[1] = -scale[1]
        turned = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) * scale
        keys = {"wrap": self.wrap}
        if not np.allclose(scale, 1):
            keys["uv_scale"] = [float(x) for x in scale]
        if not np.isclose(angle, 0):
            keys["uv_rotation"] = float(np.degrees(angle))
        if not np.allclose(matrix[:, 2], 0):
            keys["uv_offset"] = [float(x) for x in matrix[:, 2]]
        return keys, np.allclose(turned, linear, atol=1e-5 * max(1.0, float(scale.max())))


@dataclass(frozen=True)
class Value:
    """A number, a color or a vector: the same everywhere, or by a texture, or by a mesh's colors.

    `pixels` has the shape (h, w, channels), the first row is the upper one. Linear float32, or uint8 codes of sRGB.
    Without a placement it has one pixel. `attribute` names the color attribute that multiplies it.
    """

    pixels: np.ndarray = field(repr=False)
    placement: object = None
    attribute: str | None = None

    @classmethod
    def of(cls, numbers):
        return cls(np.atleast_1d(np.asarray(numbers, dtype=np.float32)).reshape(1, 1, -1))

    @property
    def is_constant(self):
        return self.placement is None and self.attribute is None

    @property
    def channels(self):
        return self.pixels.shape[2]

    @property
    def linear(self):
        return _DECODED[self.pixels] if self.pixels.dtype == np.uint8 else self.pixels

    @property
    def constant(self):
        """The value, or the mean of a texture."""
        return self.linear.mean(axis=(0, 1), dtype=np.float64)

    @property
    def number(self):
        return float(self.scalar().constant[0])

    def is_everywhere(self, number):
        return self.attribute is None and bool(np.all(self.linear == np.float32(number)))

    def scalar(self):
        """One channel: the luminance of a color."""
        if self.channels == 1:
            return self
        return replace(self, pixels=self.linear[..., :3] @ LUMINANCE[:, None])

    def color(self):
        """Three channels."""
        if self.channels == 3:
            return self
        if self.channels == 1:
            return replace(self, pixels=np.repeat(self.linear, 3, axis=2))
        return replace(self, pixels=self.pixels[..., :3])


def combine(function, *values):
    """A function of the pixels of values. A mesh's colors get lost in it.

    Textures of one placement are combined pixel by pixel. Otherwise all are sampled over the unit square of UV space,
    where integer scales repeat without a seam.
    """
    textures = [value for value in values if value.placement is not None]
    if not textures:
        return Value(_float(function(*(value.linear for value in values))))
    placements = {value.placement for value in textures}
    shape = tuple(max(value.pixels.shape[axis] for value in textures) for axis in (0, 1))
    if len(placements) == 1:
        sampled = [
            value.linear if value.pixels.shape[:2] in (shape, (1, 1)) else _resized(value.linear, shape)
            for value in values
        ]
        return Value(_float(function(*sampled)), placements.pop())
    scale = max(float(np.abs(np.array(value.placement.matrix)[:, :2]).max()) for value in textures)
    shape = tuple(min(int(np.ceil(edge * max(scale, 1))), LONGEST_BAKED_EDGE) for edge in shape)
    sampled = [
        value.linear if value.placement is None else sample(value.linear, *value.placement.coordinates(*shape), value.placement.wrap)
        for value in values
    ]
    return Value(_float(function(*sampled)), Placement(layer=textures[0].placement.layer))


def sample(pixels, u, v, wrap):
    """Bilinear values at texture coordinates; u and v are arrays that broadcast against each other."""
    height, width = pixels.shape[:2]
    x, y = np.broadcast_arrays(u * width - 0.5, (1 - v) * height - 0.5)
    left, top = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    along, down = (x - left)[..., None].astype(np.float32), (y - top)[..., None].astype(np.float32)
    columns = [_wrapped(left + i, width, wrap) for i in (0, 1)]
    rows = [_wrapped(top + i, height, wrap) for i in (0, 1)]
    upper = pixels[rows[0], columns[0]] * (1 - along) + pixels[rows[0], columns[1]] * along
    lower = pixels[rows[1], columns[0]] * (1 - along) + pixels[rows[1], columns[1]] * along
    return upper * (1 - down) + lower * down


def _wrapped(index, count, wrap):
    if wrap == "repeat":
        return index % count
    if wrap == "mirror":
        index = index % (2 * count)
        return np.where(index < count, index, 2 * count - 1 - index)
    return np.clip(index, 0, count - 1)


def _resized(pixels, shape):
    u = (np.arange(shape[1]) + 0.5) / shape[1]
    v = 1 - (np.arange(shape[0]) + 0.5) / shape[0]
    return sample(pixels, u[None, :], v[:, None], "clamp")


def _float(pixels):
    return np.ascontiguousarray(pixels, dtype=np.float32)
