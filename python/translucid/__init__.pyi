from . import reference as reference
from ._conversion import Conversion as Conversion
from ._conversion import convert as convert
from ._presets import presets as presets
from ._translucid import Fit as Fit
from ._translucid import Preset as Preset
from ._translucid import Profile as Profile
from ._translucid import __version__ as __version__
from ._translucid import fit as fit
from ._translucid import fit_scaling as fit_scaling
from ._translucid import models as models

__all__ = [
    "Conversion",
    "Fit",
    "Preset",
    "Profile",
    "__version__",
    "convert",
    "fit",
    "fit_scaling",
    "models",
    "presets",
    "reference",
]
