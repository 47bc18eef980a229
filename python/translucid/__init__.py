"""Subsurface scattering you can trust: profiles, exact references, fits and pictures on NumPy arrays.

Lengths are in one unit that the caller chose; a function returns them in the same.
Whatever takes radii, albedos or lengths takes numbers and arrays of any shape, and broadcasts them by NumPy's rules.

>>> import numpy as np
>>> import translucid
>>> jade = translucid.Profile(surface_albedo=0.6, mfp=1.5)
>>> r = np.array([0.1, 1.0, 10.0])
>>> jade.eval(r).shape
(3,)
>>> round(float(jade.cdf(jade.quantile(0.7))), 12)
0.7
"""

from ._render import Picture, Session, render
from ._translucid import Profile, Scene, SceneError, __version__, read_exr, tonemap, write_exr

__all__ = [
    "Picture",
    "Profile",
    "Scene",
    "SceneError",
    "Session",
    "__version__",
    "read_exr",
    "render",
    "tonemap",
    "write_exr",
]
