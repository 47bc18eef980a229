# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors: blends of two, other spaces, and black bodies, as Cycles has them."""

import numpy as np

from .value import LUMINANCE


def luminance(color):
    """The luminance of colors, as one channel."""
    return color @ LUMINANCE[:, None]


# --- spaces


def rgb_to_hsv(color):
    value = color.max(axis=-1)
    span = value - color.min(axis=-1)
    safe = np.where(span > 0, span, 1)
    r, g, b = np.moveaxis(color, -1, 0)
    hue = np.select([value == r, value == g], [((g - b) / safe) % 6, (b - r) / safe + 2], (r - g) / safe + 4) / 6
    saturation = np.where(value > 0, span / np.where(value > 0, value, 1), 0)
    return np.stack([np.where(span > 0, hue, 0), saturation, value], axis=-1)


def hsv_to_rgb(hsv):
    h, s, v = np.moveaxis(hsv, -1, 0)
    k = (np.stack([h * 6 + 5, h * 6 + 3, h * 6 + 1], axis=-1)) % 6
    return v[..., None] - (v * s)[..., None] * np.clip(np.minimum(k, 4 - k), 0, 1)


def rgb_to_hsl(color):
    high, low = color.max(axis=-1), color.min(axis=-1)
    lightness, span = (high + low) / 2, high - low
    room = np.where(lightness > 0.5, 2 - high - low, high + low)
    saturation = np.where((span > 0) & (room != 0), span / np.where(room != 0, room, 1), 0)
    return np.stack([rgb_to_hsv(color)[..., 0], saturation, lightness], axis=-1)


def hsl_to_rgb(hsl):
    h, s, light = np.moveaxis(hsl, -1, 0)
    ramps = [np.abs(h * 6 - 3) - 1, 2 - np.abs(h * 6 - 2), 2 - np.abs(h * 6 - 4)]
    chroma = (1 - np.abs(2 * light - 1)) * s
    return (np.clip(np.stack(ramps, axis=-1), 0, 1) - 0.5) * chroma[..., None] + light[..., None]


# Of the modes of Separate Color and Combine Color.
TO_MODE = {"RGB": lambda color: color, "HSV": rgb_to_hsv, "HSL": rgb_to_hsl}
FROM_MODE = {"RGB": lambda color: color, "HSV": hsv_to_rgb, "HSL": hsl_to_rgb}


# --- blends: of a factor and two colors


def _full_blends():
    def screen(a, b):
        return 1 - (1 - a) * (1 - b)

    def overlay(a, b):
        return np.where(a < 0.5, 2 * a * b, 1 - 2 * (1 - a) * (1 - b))

    def divide(a, b):
        return np.where(b == 0, a, a / np.where(b == 0, 1, b))

    def soft_light(a, b):
        return (1 - a) * b * a + a * screen(a, b)

    return {
        "MIX": lambda a, b: b,
        "ADD": lambda a, b: a + b,
        "SUBTRACT": lambda a, b: a - b,
        "MULTIPLY": lambda a, b: a * b,
        "SCREEN": screen,
        "OVERLAY": overlay,
        "DIVIDE": divide,
        "DIFFERENCE": lambda a, b: np.abs(a - b),
        "EXCLUSION": lambda a, b: a + b - 2 * a * b,
        "DARKEN": np.minimum,
        "LIGHTEN": np.maximum,
        "SOFT_LIGHT": soft_light,
        "LINEAR_LIGHT": lambda a, b: a + 2 * b - 1,
    }


def dodge(t, a, b):
    room = 1 - t * b
    return np.where(a == 0, 0, np.where(room <= 0, 1, np.minimum(a / np.where(room <= 0, 1, room), 1)))


def burn(t, a, b):
    room = 1 - t + t * b
    return np.where(room <= 0, 0, np.clip(1 - (1 - a) / np.where(room <= 0, 1, room), 0, 1))


def _taking(channels, gray):
    """A blend that takes channels of HSV from the second color; where the color `gray` has no hue, the first stays."""

    def blend(t, *colors):
        a, b = np.broadcast_arrays(*colors)
        first, second = rgb_to_hsv(a), rgb_to_hsv(b)
        stays = (first, second)[gray][..., 1:2] == 0 if gray is not None else False
        first[..., channels] = second[..., channels]
        return np.where(stays, a, a + t * (hsv_to_rgb(first) - a))

    return blend


def _linear(full):
    return lambda t, a, b: a + t * (full(a, b) - a)


BLENDS = {name: _linear(full) for name, full in _full_blends().items()} | {
    "DODGE": dodge,
    "BURN": burn,
    "HUE": _taking([0], 1),
    "SATURATION": _taking([1], 0),
    "COLOR": _taking([0, 1], 1),
    "VALUE": _taking([2], None),
}


# --- black bodies


def blackbody(temperature):
    """The color of a black body of luminance 1, linear Rec. 709.

    Planck's law against the fit of the CIE 1931 color matching functions by C. Wyman, P.-P. Sloan and P. Shirley,
    "Simple Analytic Approximations to the CIE XYZ Color Matching Functions", 2013.
    """
    nm = np.arange(360.0, 831.0)
    lobe = lambda mean, below, above: np.exp(-0.5 * ((nm - mean) / np.where(nm < mean, below, above)) ** 2)
    x = 1.056 * lobe(599.8, 37.9, 31.0) + 0.362 * lobe(442.0, 16.0, 26.7) - 0.065 * lobe(501.1, 20.4, 26.2)
    y = 0.821 * lobe(568.8, 46.9, 40.5) + 0.286 * lobe(530.9, 16.3, 31.1)
    z = 1.217 * lobe(437.0, 11.8, 36.0) + 0.681 * lobe(459.0, 26.0, 13.8)
    kelvin = np.clip(temperature, 800.0, 40000.0)
    power = nm**-5 / np.expm1(1.438777e7 / (nm * kelvin))
    xyz = np.array([(power * curve).sum() for curve in (x, y, z)])
    to_rec709 = np.array([[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]])
    rgb = np.maximum(to_rec709 @ (xyz / xyz[1]), 0)
    return rgb / (rgb @ LUMINANCE)
