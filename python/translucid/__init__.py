"""Subsurface scattering you can trust: profiles, exact references, fits and pictures on NumPy arrays.

- `Profile`: reflectance profiles of every model, to evaluate, to sample and to plot.
- `reference`: the exact half space and Monte Carlo walks, with errors.
- `fit`, `fit_scaling`: simple profiles fitted to samples, to other profiles and to the exact half space.
- `measure`: a material from a photograph, with confidence intervals.
- `stack`: the color of plane layers over grounds.
- `skin`: human skin from its pigments.
- `judge`, `oracle`: a picture of a lit shape beside the exact light, and tables of that light.
- `convert`: a material in the numbers of other renderers.
- `cycles_material`: the subsurface of Blender Cycles as a material that looks the same.
- `presets`: measured materials.
- `Scene`, `render`, `Session`: scenes from files and arrays, and pictures of them.
- `tonemap`, `read_exr`, `write_exr`: pictures in files.
- `cryptomatte_id`, `cryptomatte_metadata`: names and notes of Cryptomattes.

Lengths are in one unit that the caller chose; a function returns them in the same.
Whatever takes radii, albedos or lengths takes numbers and arrays of any shape, and broadcasts them by NumPy's rules.
A wrong argument is a `ValueError` or `TypeError` that says which, its value and what is allowed; results are finite.

>>> import numpy as np
>>> import translucid
>>> jade = translucid.Profile(surface_albedo=0.6, mfp=1.5)
>>> r = np.array([0.1, 1.0, 10.0])
>>> jade.eval(r).shape
(3,)
>>> round(jade.cdf(jade.quantile(0.7)), 12)
0.7
"""

from . import reference
from ._conversion import Conversion, ConvertedParameter, convert
from ._cryptomatte import cryptomatte_metadata
from ._cycles import cycles_material
from ._measure import Measured, Measurement, measure
from ._answer import Answer
from ._presets import presets
from ._questions import judge, oracle, skin, stack
from ._render import Picture, Session, render
from ._translucid import (
    Fit,
    Preset,
    Profile,
    Scene,
    SceneError,
    __version__,
    cryptomatte_id,
    fit,
    fit_scaling,
    models,
    read_exr,
    tonemap,
    write_exr,
)

__all__ = [
    "Answer",
    "Conversion",
    "ConvertedParameter",
    "Fit",
    "Measured",
    "Measurement",
    "Picture",
    "Preset",
    "Profile",
    "Scene",
    "SceneError",
    "Session",
    "__version__",
    "convert",
    "cryptomatte_id",
    "cryptomatte_metadata",
    "cycles_material",
    "fit",
    "fit_scaling",
    "judge",
    "measure",
    "models",
    "oracle",
    "presets",
    "read_exr",
    "reference",
    "render",
    "skin",
    "stack",
    "tonemap",
    "write_exr",
]
