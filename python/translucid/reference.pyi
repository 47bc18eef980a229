from ._translucid import WhiteTable as WhiteTable
from ._translucid import exact as exact
from ._translucid import exact_beyond as exact_beyond
from ._translucid import exact_enclosed as exact_enclosed
from ._translucid import exact_total as exact_total
from ._translucid import walk as walk

__all__ = ["WhiteTable", "exact", "exact_beyond", "exact_enclosed", "exact_total", "walk"]
