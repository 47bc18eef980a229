from collections.abc import Callable, Iterable, Mapping
from os import PathLike
from typing import Any, Literal, NamedTuple, TypeAlias, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import Profile

__all__ = [
    "LayersProfile",
    "LayersTotals",
    "LayersWalk",
    "WhiteTable",
    "exact",
    "exact_beyond",
    "exact_enclosed",
    "exact_total",
    "layers",
    "layers_profile",
    "layers_walk",
    "walk",
]

_Numbers: TypeAlias = float | np.floating[Any] | NDArray[np.floating[Any]]
_Progress: TypeAlias = bool | Literal["tqdm"] | Callable[[int, int], object]
_Configuration: TypeAlias = Literal["searchlight", "diffuse"]
_Side: TypeAlias = Literal["reflected", "transmitted"]

class LayersTotals(NamedTuple):
    specular_reflectance: _Numbers
    diffuse_reflectance: _Numbers
    collimated_transmittance: _Numbers
    diffuse_transmittance: _Numbers
    absorbed: NDArray[np.floating[Any]]
    absorbed_by_ground: _Numbers
    error: _Numbers

class LayersProfile(NamedTuple):
    reflectance: _Numbers
    reflectance_error: _Numbers
    transmittance: _Numbers
    transmittance_error: _Numbers

class LayersWalk(NamedTuple):
    specular_reflectance: float
    reflected: tuple[float, float]
    transmitted: tuple[float, float]
    absorbed_by_layer: tuple[NDArray[np.float64], NDArray[np.float64]]
    absorbed_by_ground: tuple[float, float]
    lost: tuple[float, float]
    r: NDArray[np.float64]
    z: NDArray[np.float64]
    reflectance: tuple[NDArray[np.float64], NDArray[np.float64]]
    transmittance: tuple[NDArray[np.float64], NDArray[np.float64]]
    absorption: tuple[NDArray[np.float64], NDArray[np.float64]]

@final
class WhiteTable:
    def run(
        self,
        photons: float | range,
        *,
        seed: int = 0,
        threads: int | None = None,
        device: str = "cpu",
        progress: _Progress | None = None,
    ) -> None: ...
    def eval(
        self,
        r: ArrayLike,
        *,
        surface_albedo: ArrayLike | None = None,
        single_scattering_albedo: ArrayLike | None = None,
        side: _Side = "reflected",
        azimuth: float | None = None,
    ) -> tuple[_Numbers, _Numbers]: ...
    def enclosed(
        self,
        r: ArrayLike,
        *,
        surface_albedo: ArrayLike | None = None,
        single_scattering_albedo: ArrayLike | None = None,
        side: _Side = "reflected",
    ) -> tuple[_Numbers, _Numbers]: ...
    def total(
        self,
        *,
        surface_albedo: ArrayLike | None = None,
        single_scattering_albedo: ArrayLike | None = None,
        side: _Side = "reflected",
    ) -> tuple[_Numbers, _Numbers]: ...
    def rings(
        self,
        *,
        surface_albedo: float | None = None,
        single_scattering_albedo: float | None = None,
        side: _Side = "reflected",
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    def single_scattering_albedo(self, surface_albedo: float) -> tuple[float, float]: ...
    def profile(
        self,
        *,
        surface_albedo: float | None = None,
        single_scattering_albedo: float | None = None,
        side: _Side = "reflected",
    ) -> Profile: ...
    def merge(self, *tables: WhiteTable) -> None: ...
    def __add__(self, value: WhiteTable, /) -> WhiteTable: ...
    def __radd__(self, value: WhiteTable, /) -> WhiteTable: ...
    def __eq__(self, value: object, /) -> bool: ...
    def __ne__(self, value: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]
    def __reduce__(self) -> tuple[Any, ...]: ...
    def save(self, path: str | PathLike[str]) -> None: ...
    @classmethod
    def load(cls, path: str | PathLike[str]) -> WhiteTable: ...
    @classmethod
    def _from_bytes(cls, bytes: bytes) -> WhiteTable: ...
    @property
    def photons(self) -> int: ...
    @property
    def photon_ranges(self) -> list[tuple[int, range]]: ...
    @property
    def edges(self) -> NDArray[np.float64]: ...
    @property
    def reference_albedo(self) -> float: ...
    @property
    def mean_collisions(self) -> float: ...
    @property
    def parameters(self) -> dict[str, Any]: ...

def exact(
    r: ArrayLike,
    *,
    surface_albedo: ArrayLike | None = None,
    single_scattering_albedo: ArrayLike | None = None,
    configuration: _Configuration | None = None,
    mfp: ArrayLike | None = None,
    eta: ArrayLike | None = None,
    incidence_angle: float | None = None,
    azimuth: ArrayLike | None = None,
    threads: int | None = None,
    progress: _Progress | None = None,
) -> tuple[_Numbers, _Numbers]: ...
def exact_enclosed(
    r: ArrayLike,
    *,
    surface_albedo: ArrayLike | None = None,
    single_scattering_albedo: ArrayLike | None = None,
    configuration: _Configuration | None = None,
    mfp: ArrayLike | None = None,
    eta: ArrayLike | None = None,
    incidence_angle: float | None = None,
    threads: int | None = None,
    progress: _Progress | None = None,
) -> tuple[_Numbers, _Numbers]: ...
def exact_beyond(
    r: ArrayLike,
    *,
    surface_albedo: ArrayLike | None = None,
    single_scattering_albedo: ArrayLike | None = None,
    configuration: _Configuration | None = None,
    mfp: ArrayLike | None = None,
    eta: ArrayLike | None = None,
    incidence_angle: float | None = None,
    threads: int | None = None,
    progress: _Progress | None = None,
) -> tuple[_Numbers, _Numbers]: ...
def exact_total(
    single_scattering_albedo: ArrayLike,
    *,
    configuration: _Configuration | None = None,
    eta: ArrayLike | None = None,
    incidence_angle: float | None = None,
    threads: int | None = None,
    progress: _Progress | None = None,
) -> tuple[_Numbers, _Numbers]: ...
def layers(
    layers: Iterable[Mapping[str, ArrayLike]],
    *,
    eta_above: ArrayLike | None = None,
    eta_below: ArrayLike | None = None,
    ground_reflectance: ArrayLike | None = None,
    configuration: _Configuration | None = None,
    incidence_angle: float | None = None,
    tolerance: float | None = None,
    threads: int | None = None,
    progress: _Progress | None = None,
) -> LayersTotals: ...
def layers_profile(
    r: ArrayLike,
    layers: Iterable[Mapping[str, ArrayLike]],
    *,
    eta_above: ArrayLike | None = None,
    eta_below: ArrayLike | None = None,
    ground_reflectance: ArrayLike | None = None,
    tolerance: float | None = None,
    threads: int | None = None,
    progress: _Progress | None = None,
) -> LayersProfile: ...
@overload
def layers_walk(
    photons: float,
    layers: Iterable[Mapping[str, ArrayLike]],
    *,
    eta_above: float | None = None,
    eta_below: float | None = None,
    ground_reflectance: float | None = None,
    absorptions: None = None,
    dr: float = 1.0,
    nr: int = 1,
    dz: float = 1.0,
    nz: int = 1,
    configuration: _Configuration | None = None,
    incidence_angle: float | None = None,
    seed: int = 0,
    threads: int | None = None,
    progress: _Progress | None = None,
) -> LayersWalk: ...
@overload
def layers_walk(
    photons: float,
    layers: Iterable[Mapping[str, ArrayLike]],
    *,
    eta_above: float | None = None,
    eta_below: float | None = None,
    ground_reflectance: float | None = None,
    absorptions: ArrayLike,
    dr: float = 1.0,
    nr: int = 1,
    dz: float = 1.0,
    nz: int = 1,
    configuration: _Configuration | None = None,
    incidence_angle: float | None = None,
    seed: int = 0,
    threads: int | None = None,
    progress: _Progress | None = None,
) -> list[LayersWalk]: ...
def walk(
    photons: float | range | None = None,
    *,
    radii: ArrayLike | None = None,
    edges: ArrayLike | None = None,
    surface_albedo: ArrayLike | None = None,
    single_scattering_albedo: ArrayLike | None = None,
    reference_albedo: float | None = None,
    configuration: _Configuration | None = None,
    g: float | None = None,
    phase_function: str | ArrayLike | None = None,
    eta: float | None = None,
    thickness: float | None = None,
    spot_radius: float | None = None,
    incidence_angle: float | None = None,
    sectors: int = 1,
    seed: int = 0,
    threads: int | None = None,
    device: str = "cpu",
    progress: _Progress | None = None,
) -> WhiteTable: ...
