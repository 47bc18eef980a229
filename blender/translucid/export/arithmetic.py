# SPDX-License-Identifier: GPL-3.0-or-later
"""The operations of Math, Vector Math, Map Range and Vector Rotate, as Cycles has them: what has no value is 0.

Arrays have the channels last: one of numbers, three of vectors.
"""

import numpy as np


def divided(a, b):
    return np.where(b == 0, 0, a / np.where(b == 0, 1, b))


def power(a, b):
    # Of negative numbers whole powers only.
    sign = np.where((a < 0) & (np.mod(b, 2) == 1), -1, 1)
    found = sign * np.power(np.maximum(np.abs(a), 1e-30), b)
    return np.nan_to_num(np.where(a == 0, np.where(b == 0, 1, 0), np.where((a < 0) & (b != np.trunc(b)), 0, found)), posinf=0, neginf=0)


def modulo(a, b):
    return np.where(b == 0, 0, np.fmod(a, np.where(b == 0, 1, b)))


def wrapped(a, high, low):
    span = high - low
    return np.where(span == 0, low, a - span * np.floor(divided(a - low, span)))


def ping_pong(a, scale):
    place = divided(a - scale, 2 * scale)
    return np.abs((place - np.floor(place)) * 2 * scale - scale) * (scale != 0)


def smooth_minimum(a, b, distance):
    overlap = divided(np.maximum(distance - np.abs(a - b), 0), distance)
    return np.minimum(a, b) - overlap**3 * distance / 6


# --- numbers


MATH = {
    "ADD": lambda a, b, c: a + b,
    "SUBTRACT": lambda a, b, c: a - b,
    "MULTIPLY": lambda a, b, c: a * b,
    "DIVIDE": lambda a, b, c: divided(a, b),
    "MULTIPLY_ADD": lambda a, b, c: a * b + c,
    "POWER": lambda a, b, c: power(a, b),
    "LOGARITHM": lambda a, b, c: np.where((a > 0) & (b > 0), divided(np.log(np.maximum(a, 1e-30)), np.log(np.maximum(b, 1e-30))), 0),
    "SQRT": lambda a, b, c: np.sqrt(np.maximum(a, 0)),
    "INVERSE_SQRT": lambda a, b, c: np.where(a > 0, 1 / np.sqrt(np.maximum(a, 1e-30)), 0),
    "ABSOLUTE": lambda a, b, c: np.abs(a),
    "EXPONENT": lambda a, b, c: np.exp(np.minimum(a, 80)),
    "MINIMUM": lambda a, b, c: np.minimum(a, b),
    "MAXIMUM": lambda a, b, c: np.maximum(a, b),
    "LESS_THAN": lambda a, b, c: (a < b).astype(np.float32),
    "GREATER_THAN": lambda a, b, c: (a > b).astype(np.float32),
    "SIGN": lambda a, b, c: np.sign(a),
    "COMPARE": lambda a, b, c: (np.abs(a - b) <= np.maximum(c, 1e-5)).astype(np.float32),
    "SMOOTH_MIN": lambda a, b, c: smooth_minimum(a, b, c),
    "SMOOTH_MAX": lambda a, b, c: -smooth_minimum(-a, -b, c),
    "ROUND": lambda a, b, c: np.floor(a + 0.5),
    "FLOOR": lambda a, b, c: np.floor(a),
    "CEIL": lambda a, b, c: np.ceil(a),
    "TRUNC": lambda a, b, c: np.trunc(a),
    "FRACT": lambda a, b, c: a - np.floor(a),
    "MODULO": lambda a, b, c: modulo(a, b),
    "FLOORED_MODULO": lambda a, b, c: np.where(b == 0, 0, np.mod(a, np.where(b == 0, 1, b))),
    "WRAP": lambda a, b, c: wrapped(a, b, c),
    "SNAP": lambda a, b, c: np.floor(divided(a, b)) * b,
    "PINGPONG": lambda a, b, c: ping_pong(a, b),
    "SINE": lambda a, b, c: np.sin(a),
    "COSINE": lambda a, b, c: np.cos(a),
    "TANGENT": lambda a, b, c: np.tan(a),
    "ARCSINE": lambda a, b, c: np.arcsin(np.clip(a, -1, 1)),
    "ARCCOSINE": lambda a, b, c: np.arccos(np.clip(a, -1, 1)),
    "ARCTANGENT": lambda a, b, c: np.arctan(a),
    "ARCTAN2": lambda a, b, c: np.arctan2(a, b),
    "SINH": lambda a, b, c: np.sinh(np.clip(a, -80, 80)),
    "COSH": lambda a, b, c: np.cosh(np.clip(a, -80, 80)),
    "TANH": lambda a, b, c: np.tanh(a),
    "RADIANS": lambda a, b, c: np.radians(a),
    "DEGREES": lambda a, b, c: np.degrees(a),
}


# --- vectors


def dot(a, b):
    return (a * b).sum(axis=-1, keepdims=True)


def length(a):
    return np.sqrt(dot(a, a))


def normalized(a):
    return divided(a, length(a))


def refracted(incident, normal, eta):
    cosine = dot(normal, incident)
    k = 1 - eta * eta * (1 - cosine * cosine)
    return np.where(k < 0, 0, eta * incident - (eta * cosine + np.sqrt(np.maximum(k, 0))) * normal)


# Of three vectors and a number.
VECTOR_MATH = {
    "CROSS_PRODUCT": lambda a, b, c, s: np.cross(a, b),
    "PROJECT": lambda a, b, c, s: divided(dot(a, b), dot(b, b)) * b,
    "REFLECT": lambda a, b, c, s: a - 2 * dot(a, normalized(b)) * normalized(b),
    "REFRACT": lambda a, b, c, s: refracted(a, normalized(b), s),
    "FACEFORWARD": lambda a, b, c, s: np.where(dot(b, c) < 0, a, -a),
    "DOT_PRODUCT": lambda a, b, c, s: dot(a, b),
    "DISTANCE": lambda a, b, c, s: length(a - b),
    "LENGTH": lambda a, b, c, s: length(a),
    "SCALE": lambda a, b, c, s: a * s,
    "NORMALIZE": lambda a, b, c, s: normalized(a),
    "FRACTION": lambda a, b, c, s: a - np.floor(a),
} | {
    name: lambda a, b, c, s, of_numbers=MATH[same]: of_numbers(a, b, c)
    for name, same in [
        *((name, name) for name in ("ADD", "SUBTRACT", "MULTIPLY", "DIVIDE", "MULTIPLY_ADD", "POWER", "MINIMUM", "MAXIMUM")),
        *((name, name) for name in ("ROUND", "FLOOR", "CEIL", "MODULO", "WRAP", "SNAP", "SINE", "COSINE", "TANGENT", "SIGN")),
        ("ABSOLUTE", "ABSOLUTE"),
    ]
}


# --- ranges


def mapped_range(kind, x, from_low, from_high, to_low, to_high, steps):
    """A place in one range as the same place in another."""
    t = divided(x - from_low, from_high - from_low)
    if kind == "STEPPED":
        t = divided(np.floor(t * (steps + 1)), steps)
    elif kind != "LINEAR":
        t = np.clip(t, 0, 1)
        t = t * t * (3 - 2 * t) if kind == "SMOOTHSTEP" else t**3 * (t * (6 * t - 15) + 10)
    return to_low + t * (to_high - to_low)


# --- rotations


def rotated(vector, center, axis, angle):
    """A vector turned about an axis through a center [O. Rodrigues 1840]; about no axis it stays."""
    axis, arm = normalized(axis), vector - center
    cos, sin = np.cos(angle), np.sin(angle)
    turned = arm * cos + np.cross(axis, arm) * sin + axis * dot(axis, arm) * (1 - cos)
    return np.where(dot(axis, axis) > 0, turned + center, vector)
