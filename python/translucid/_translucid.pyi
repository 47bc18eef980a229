from collections.abc import Callable
from os import PathLike
from typing import Any, Final, Literal, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Numbers: TypeAlias = float | np.floating[Any] | NDArray[np.floating[Any]]
_Progress: TypeAlias = Callable[[int, int], object]
_ConfigurationName: TypeAlias = Literal["searchlight", "diffuse"]
_SideName: TypeAlias = Literal["reflected", "transmitted"]
_FamilyName: TypeAlias = Literal["exponentials", "gaussians", "normalized-diffusion"]

__all__: list[str]
__version__: Final[str]
models: Final[list[str]]

@final
class Profile:
    def __new__(
        cls,
        model: str = "normalized-diffusion-refined",
        *,
        surface_albedo: ArrayLike,
        mfp: ArrayLike | None = None,
        dmfp: ArrayLike | None = None,
        configuration: _ConfigurationName | None = None,
        g: ArrayLike | None = None,
        eta: ArrayLike | None = None,
    ) -> Profile: ...
    @classmethod
    def from_medium(
        cls,
        sigma_a: ArrayLike,
        sigma_s: ArrayLike,
        *,
        model: str = "normalized-diffusion-refined",
        g: ArrayLike | None = None,
        eta: ArrayLike | None = None,
        configuration: _ConfigurationName | None = None,
    ) -> Profile: ...
    @classmethod
    def from_table(
        cls,
        r: ArrayLike | PathLike[str],
        reflectance: ArrayLike | None = None,
        *,
        enclosed: ArrayLike | None = None,
        surface_albedos: ArrayLike | None = None,
        surface_albedo: ArrayLike | None = None,
        mfp: ArrayLike | None = None,
        dmfp: ArrayLike | None = None,
    ) -> Profile: ...
    def tabulated(self) -> Profile: ...
    def eval(self, r: ArrayLike) -> _Numbers: ...
    def pdf(self, r: ArrayLike) -> _Numbers: ...
    def pdf_area(self, r: ArrayLike) -> _Numbers: ...
    def cdf(self, r: ArrayLike) -> _Numbers: ...
    def enclosed(self, r: ArrayLike) -> _Numbers: ...
    def beyond(self, r: ArrayLike) -> _Numbers: ...
    def quantile(self, u: ArrayLike) -> _Numbers: ...
    def sample(self, u: ArrayLike) -> _Numbers: ...
    def plot(
        self,
        r: ArrayLike | None = None,
        *,
        quantity: Literal["eval", "pdf", "pdf_area", "cdf", "enclosed", "beyond"] = "eval",
        ax: Any = None,
        **line: Any,
    ) -> Any: ...
    @property
    def total(self) -> _Numbers: ...
    @property
    def surface_albedo(self) -> _Numbers | None: ...
    @property
    def mfp(self) -> _Numbers | None: ...
    @property
    def dmfp(self) -> _Numbers | None: ...
    @property
    def g(self) -> _Numbers | None: ...
    @property
    def eta(self) -> _Numbers | None: ...
    @property
    def model(self) -> str | None: ...
    @property
    def configuration(self) -> _ConfigurationName | None: ...
    @property
    def shape(self) -> tuple[int, ...]: ...

@final
class Fit:
    @property
    def family(self) -> _FamilyName: ...
    @property
    def surface_albedo(self) -> float: ...
    @property
    def surface_albedo_error(self) -> float: ...
    @property
    def weights(self) -> NDArray[np.float64]: ...
    @property
    def weight_errors(self) -> NDArray[np.float64]: ...
    @property
    def scales(self) -> NDArray[np.float64]: ...
    @property
    def scale_errors(self) -> NDArray[np.float64]: ...
    @property
    def chi_square(self) -> float | None: ...
    @property
    def degrees_of_freedom(self) -> int | None: ...
    @property
    def residuals(self) -> NDArray[np.float64] | None: ...
    @property
    def l1_error(self) -> float | None: ...
    @property
    def undetermined(self) -> list[str]: ...
    @property
    def profile(self) -> Profile: ...

@final
class Preset:
    @property
    def name(self) -> str: ...
    @property
    def source(self) -> str: ...
    @property
    def surface_albedo(self) -> NDArray[np.float64]: ...
    @property
    def mfp(self) -> NDArray[np.float64]: ...
    @property
    def eta(self) -> float: ...
    @property
    def roughness(self) -> float: ...

@final
class WhiteTable:
    def run(
        self,
        photons: float | range,
        *,
        seed: int = 0,
        threads: int | None = None,
        progress: _Progress | None = None,
    ) -> None: ...
    def eval(
        self,
        r: ArrayLike,
        *,
        surface_albedo: ArrayLike | None = None,
        single_scattering_albedo: ArrayLike | None = None,
        side: _SideName = "reflected",
        azimuth: float | None = None,
    ) -> tuple[_Numbers, _Numbers]: ...
    def enclosed(
        self,
        r: ArrayLike,
        *,
        surface_albedo: ArrayLike | None = None,
        single_scattering_albedo: ArrayLike | None = None,
        side: _SideName = "reflected",
    ) -> tuple[_Numbers, _Numbers]: ...
    def total(
        self,
        *,
        surface_albedo: ArrayLike | None = None,
        single_scattering_albedo: ArrayLike | None = None,
        side: _SideName = "reflected",
    ) -> tuple[_Numbers, _Numbers]: ...
    def rings(
        self,
        *,
        surface_albedo: float | None = None,
        single_scattering_albedo: float | None = None,
        side: _SideName = "reflected",
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    def single_scattering_albedo(self, surface_albedo: float) -> tuple[float, float]: ...
    def profile(
        self,
        *,
        surface_albedo: float | None = None,
        single_scattering_albedo: float | None = None,
        side: _SideName = "reflected",
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

def fit(
    r: ArrayLike | Profile,
    reflectance: ArrayLike | None = None,
    error: ArrayLike | None = None,
    *,
    family: _FamilyName = "exponentials",
    terms: int | None = None,
) -> Fit: ...
def fit_scaling(
    configuration: _ConfigurationName = "searchlight",
    parameter: Literal["mfp", "dmfp"] = "mfp",
    *,
    surface_albedo: ArrayLike | None = None,
    max_radius: float | None = None,
) -> dict[str, Any]: ...
def exact(
    r: ArrayLike,
    *,
    surface_albedo: ArrayLike | None = None,
    single_scattering_albedo: ArrayLike | None = None,
    configuration: _ConfigurationName | None = None,
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
    configuration: _ConfigurationName | None = None,
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
    configuration: _ConfigurationName | None = None,
    mfp: ArrayLike | None = None,
    eta: ArrayLike | None = None,
    incidence_angle: float | None = None,
    threads: int | None = None,
    progress: _Progress | None = None,
) -> tuple[_Numbers, _Numbers]: ...
def exact_total(
    single_scattering_albedo: ArrayLike,
    *,
    configuration: _ConfigurationName | None = None,
    eta: ArrayLike | None = None,
    incidence_angle: float | None = None,
    threads: int | None = None,
    progress: _Progress | None = None,
) -> tuple[_Numbers, _Numbers]: ...
def walk(
    photons: float | range | None = None,
    *,
    radii: ArrayLike | None = None,
    edges: ArrayLike | None = None,
    surface_albedo: ArrayLike | None = None,
    single_scattering_albedo: ArrayLike | None = None,
    reference_albedo: float | None = None,
    configuration: _ConfigurationName | None = None,
    g: float | None = None,
    phase_function: Literal["henyey-greenstein", "rayleigh"] = "henyey-greenstein",
    eta: float | None = None,
    thickness: float | None = None,
    spot_radius: float | None = None,
    incidence_angle: float | None = None,
    sectors: int = 1,
    seed: int = 0,
    threads: int | None = None,
    progress: _Progress | None = None,
) -> WhiteTable: ...
def _convert(
    source: str,
    parameters: dict[str, Any],
    surface_albedo: ArrayLike | None,
    unit: str,
    to_unit: str | None,
    to: list[str],
    settings: dict[str, dict[str, Any]],
    configuration: str,
) -> tuple[list[tuple[str, str, str, float, str, str, str]], list[str]]: ...
def _conversion_systems() -> list[dict[str, Any]]: ...
def _preset(name: str) -> Preset: ...
def _preset_names() -> list[str]: ...
