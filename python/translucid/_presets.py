"""Presets by name."""

from collections.abc import Mapping

from . import _translucid


class UnknownPreset(KeyError, ValueError):
    """There is no preset of this name."""

    def __str__(self):
        # KeyError's own would quote the message.
        return str(self.args[0])


class Presets(Mapping):
    """Ready-made translucent materials by name; case, spaces and hyphens do not matter.

    Examples
    --------
    >>> import translucid
    >>> len(translucid.presets)
    70
    >>> translucid.presets["Whole Milk"].name
    'wholemilk'
    >>> milk = translucid.presets["wholemilk"]
    >>> translucid.Profile(surface_albedo=milk.surface_albedo, mfp=milk.mfp).shape
    (3,)
    """

    def __getitem__(self, name):
        if not isinstance(name, str):
            raise TypeError(f"a preset is found by its name, a str, not by {name!r}")
        try:
            return _translucid._preset(name)
        except ValueError as error:
            raise UnknownPreset(str(error)) from None

    def __contains__(self, name):
        try:
            return isinstance(name, str) and _translucid._preset(name) is not None
        except ValueError:
            return False

    def __iter__(self):
        return iter(_translucid._preset_names())

    def __len__(self):
        return len(_translucid._preset_names())

    def __repr__(self):
        return f"<{len(self)} presets: {', '.join(self)}>"


presets = Presets()
