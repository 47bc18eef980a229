"""Presets by name."""

from collections.abc import Iterator, Mapping

from ._translucid import Preset, _preset, _preset_names


class UnknownPreset(KeyError, ValueError):
    """There is no preset of this name."""

    def __str__(self) -> str:
        # KeyError's own would quote the message.
        return str(self.args[0])


class Presets(Mapping[str, Preset]):
    """Ready-made translucent materials by name; case, spaces and hyphens do not matter.

    Examples
    --------
    >>> import translucid
    >>> len(translucid.presets)
    59
    >>> translucid.presets["Whole Milk"].name
    'wholemilk'
    >>> milk = translucid.presets["wholemilk"]
    >>> translucid.Profile(surface_albedo=milk.surface_albedo, mfp=milk.mfp).shape
    (3,)
    """

    def __getitem__(self, name: str) -> Preset:
        if not isinstance(name, str):
            raise TypeError(f"a preset is found by its name, a str, not by {name!r}")
        try:
            return _preset(name)
        except ValueError as error:
            raise UnknownPreset(str(error)) from None

    def __contains__(self, name: object) -> bool:
        try:
            return isinstance(name, str) and _preset(name) is not None
        except ValueError:
            return False

    def __iter__(self) -> Iterator[str]:
        return iter(_preset_names())

    def __len__(self) -> int:
        return len(_preset_names())

    def __repr__(self) -> str:
        return f"<{len(self)} presets: {', '.join(self)}>"


presets = Presets()
