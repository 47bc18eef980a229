"""Ground truth for reflectance profiles: the exact half space, and Monte Carlo walks for everything else.

All is per unit of flux that has entered the medium: what the boundary reflects from outside is not part of it.

>>> import translucid
>>> value, error = translucid.reference.exact(1.0, surface_albedo=0.5, configuration="searchlight")
>>> walk = translucid.reference.walk(100_000, radii=[1.0], surface_albedo=0.5, configuration="searchlight")
>>> mean, standard_error = walk.eval(1.0, surface_albedo=0.5)
>>> abs(mean - value) < 4 * standard_error
True
"""

from ._translucid import WhiteTable, exact, exact_beyond, exact_enclosed, exact_total, walk

__all__ = ["WhiteTable", "exact", "exact_beyond", "exact_enclosed", "exact_total", "walk"]
