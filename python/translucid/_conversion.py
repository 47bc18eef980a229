"""A material in the numbers of other renderers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from . import _translucid


class ConvertedParameter(NamedTuple):
    """One parameter of one system."""

    system: str
    parameter: str
    value: float | np.ndarray
    unit: str
    equal: str
    source: str


class Conversion(dict):
    """A material in the numbers of other systems: ``conversion[system][parameter]``.

    A value is a number, or an array of shape (3,) for red, green and blue.

    Attributes
    ----------
    rows : list of ConvertedParameter
        The same with units, what the conversion keeps ("surface_albedo", the width "d" of Burley's profile, or the "mfp")
        and where the rule was read.
    notes : list of str
        Which systems have no numbers, and which will not use theirs as they are.
    """

    def __init__(self, rows: list[ConvertedParameter], notes: list[str]) -> None:
        super().__init__()
        self.rows = rows
        self.notes = notes
        for row in rows:
            self.setdefault(row.system, {}).setdefault(row.parameter, row.value)

    def __reduce__(self):
        return (Conversion, (self.rows, self.notes))

    def _repr_html_(self) -> str:
        from html import escape

        def cells(row: ConvertedParameter) -> str:
            numbers = ", ".join(f"{value:.6g}" for value in np.atleast_1d(row.value))
            texts = (row.system, row.parameter, numbers, row.unit, row.equal)
            return "".join(f"<td>{escape(text)}</td>" for text in texts)

        head = "".join(f"<th>{name}</th>" for name in ("system", "parameter", "value", "unit", "equal"))
        body = "".join(f"<tr>{cells(row)}</tr>" for row in self.rows)
        return f"<table><tr>{head}</tr>{body}</table>"


def convert(
    source: str,
    *,
    surface_albedo=None,
    unit: str = "mm",
    to_unit: str | None = None,
    to: str | Iterable[str] = (),
    settings: Mapping[str, Mapping[str, float]] | None = None,
    configuration: str = "diffuse",
    color_space: str | None = None,
    from_color_space: str = "lin_rec709",
    thin: float | None = None,
    thin_g: float = 0.0,
    thin_eta: float = 1.0,
    **parameters,
) -> Conversion:
    """Convert a material to the numbers of other renderers and engines.

    Parameters
    ----------
    source : str
        System that the material comes from, such as "renderman", "cycles-burley", "arnold", "unreal", "pbrt" or
        "translucid"; `convert.systems()` lists all with their parameters.
    surface_albedo : float or array_like of shape (3,), optional
        Surface albedo as one enters it in the source system, in [0, 1]; not for a system whose coefficients determine it.
    unit, to_unit : {"mm", "cm", "m"}, default "mm"
        Unit of lengths in the scene that the material comes from, and in that it goes to, for systems without a unit of
        their own; the second is that of the first by default.
    to : str or iterable of str, optional
        Systems to convert to; all by default.
    settings : mapping, optional
        Factors and distances of those systems that are to have a value: ``{"renderman": {"unitLength": 1.0}}``.
    configuration : {"diffuse", "searchlight"}, default "diffuse"
        How light enters in the fit between the width of a profile and the mean free path of a medium.
    color_space, from_color_space : str, optional
        Linear color space of the numbers, and of those that the material comes from: "lin_rec709", "acescg",
        "lin_displayp3", "lin_rec2020" or "lin_adobergb". Surface albedos change as colors do, and each new channel is the
        medium nearest to the mixture of old channels that it is; ``conversion["color space"]`` has the shares of the light
        that leaves at another radius.
    thin : float, optional
        Thickness of a slab of the material, in `unit`: the conversion then has, in place of the systems' numbers, the light
        of the ``"slab"`` and the thin-walled surfaces that stand for it, with their errors.
    thin_g, thin_eta : float, optional
        Mean cosine of the slab's phase function, in [-0.95, 0.95], and its index of refraction, in [1, 3].
    **parameters
        Parameters of the source system by its own names, each a number or three for red, green and blue. A length or color
        that is not given is 1, another factor the system's default.

    Returns
    -------
    Conversion
        A dict of dicts: ``conversion[system][parameter]``.

    Raises
    ------
    ValueError
        If a system or parameter is not known (with the nearest name), missing or outside its range, or a system that was
        asked for has no numbers.
    TypeError
        If an argument is no number or name.

    Notes
    -----
    Between systems that draw Burley's profile its width d is kept, between systems that walk or solve a medium the
    transport mean free path; from one kind to the other d = mfp/s(A) by the fit of the configuration. The rules and their
    sources are in docs/guide/conventions.md.

    Examples
    --------
    >>> import translucid
    >>> conversion = translucid.convert("renderman", dmfp=20.0, surface_albedo=0.8, to="cycles-burley")
    >>> round(conversion["cycles-burley"]["subsurface_radius"] * conversion["cycles-burley"]["subsurface_scale"], 3)
    2.999
    """
    said = {
        "from": _settings(source, parameters),
        "surface_albedo": surface_albedo,
        "unit": unit,
        "to_unit": to_unit,
        "to": to or None,
        "set": [text for system, values in dict(settings or {}).items() for text in _settings(system, values)] or None,
        "configuration": configuration,
        "color_space": color_space,
        "from_color_space": None if from_color_space == "lin_rec709" else from_color_space,
        "thin": thin,
        "g": thin_g or None,
        "eta": None if thin_eta == 1.0 else thin_eta,
    }
    return _conversion(said, {"from": "source", "set": "settings", "g": "thin_g", "eta": "thin_eta"})


def _settings(system: str, values: Mapping[str, float]) -> list[str]:
    if not isinstance(system, str) or not isinstance(values, Mapping):
        raise TypeError(f"the parameters of {system!r} must be a mapping, but are {values!r}")
    return [f"{system}:{name}={','.join(repr(float(x)) for x in np.atleast_1d(value))}" for name, value in values.items()]


def _conversion(said: dict[str, Any], names: dict[str, str]) -> Conversion:
    """Asks; errors begin with a key, which is the caller's name here."""
    try:
        found = _translucid._ask("convert", {key: value for key, value in said.items() if value is not None})
    except ValueError as error:
        key, space, rest = str(error).partition(" ")
        raise ValueError(names.get(key, key) + space + rest) from None
    # Red, green and blue are rows of the command; here they are one array.
    merged: list[ConvertedParameter] = []
    for system, parameter, channel, value, length_unit, equal, rule in zip(*found["columns"].values()):
        if channel in ("all", "r"):
            merged.append(ConvertedParameter(system, parameter, float(value), length_unit, equal, rule))
        else:
            merged[-1] = merged[-1]._replace(value=np.append(merged[-1].value, value))
    return Conversion(merged, found["notes"])


def systems() -> list[dict]:
    """Every system with its parameters and their defaults, the unit of its lengths, versions and rule."""
    return _translucid._conversion_systems()


def slab(color, balance, *, thin: float | None = None, g: float = 0.0, eta: float = 1.0) -> Conversion:
    """Find the slab that has the light of a thin-walled surface.

    Parameters
    ----------
    color : float or array_like of shape (3,)
        Share of the light below the interface that the surface scatters, in (0, 1]: OpenPBR's ``subsurface_color``.
    balance : float or array_like of shape (3,)
        Share of that which goes to the other side, in (0, 1]: (1 + a)/2 of OpenPBR's ``subsurface_scatter_anisotropy`` a.
    thin : float, optional
        Thickness of the slab, in any unit.
    g, eta : float, optional
        Mean cosine of the slab's phase function, in [-0.95, 0.95], and its index of refraction, in [1, 3].

    Returns
    -------
    Conversion
        ``conversion["slab"]`` has ``single_scattering_albedo``, ``thickness in mean free paths``, ``surface_albedo``, the
        transport mean free path as ``mfp`` in the unit of `thin`, or else as ``mfp in thicknesses``, and
        ``transmittance unscattered``.

    Raises
    ------
    ValueError
        If a parameter is outside its range, or no slab has such a reflectance and transmittance.

    Examples
    --------
    >>> import translucid
    >>> slab = translucid.convert.slab(0.8, 0.5)["slab"]
    >>> wall = translucid.convert("translucid", mfp=slab["mfp in thicknesses"], surface_albedo=slab["surface_albedo"], thin=1.0)
    >>> round(wall["openpbr"]["subsurface_color"], 4), abs(round(wall["openpbr"]["subsurface_scatter_anisotropy"], 4))
    (0.8, 0.0)
    """
    said = {"wall_color": color, "wall_balance": balance, "thin": thin, "g": g or None, "eta": None if eta == 1.0 else eta}
    return _conversion(said, {"wall_color": "color", "wall_balance": "balance"})


convert.slab = slab  # type: ignore[attr-defined]
convert.systems = systems  # type: ignore[attr-defined]
