from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Final, Literal, NamedTuple, TypeAlias, TypedDict, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Unpack

from . import reference as reference
from ._answer import Answer as Answer
from ._presets import Presets
from ._questions import judge as judge, oracle as oracle, skin as skin, stack as stack

__version__: Final[str]
models: Final[list[str]]

__all__: list[str]

_Path = str | PathLike[str]
_LinearSpace = Literal["lin_rec709", "acescg", "lin_displayp3", "lin_rec2020", "lin_adobergb"]
_Unit = Literal["mm", "cm", "m"]
_Progress = bool | Literal["tqdm"] | Callable[[int, int], object] | None
_ToneMapping = Literal["neutral", "agx", "srgb"]
_Numbers: TypeAlias = float | np.floating[Any] | NDArray[np.floating[Any]]
_Configuration: TypeAlias = Literal["searchlight", "diffuse"]
_Family: TypeAlias = Literal["exponentials", "gaussians", "normalized-diffusion"]

@final
class Profile:
    def __new__(
        cls,
        model: str = "normalized-diffusion-refined",
        *,
        surface_albedo: ArrayLike,
        mfp: ArrayLike | None = None,
        dmfp: ArrayLike | None = None,
        configuration: _Configuration | None = None,
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
        configuration: _Configuration | None = None,
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
    def eval(self, r: ArrayLike, *, out: NDArray[Any] | None = None) -> _Numbers: ...
    def pdf(self, r: ArrayLike, *, out: NDArray[Any] | None = None) -> _Numbers: ...
    def pdf_area(self, r: ArrayLike, *, out: NDArray[Any] | None = None) -> _Numbers: ...
    def cdf(self, r: ArrayLike, *, out: NDArray[Any] | None = None) -> _Numbers: ...
    def enclosed(self, r: ArrayLike, *, out: NDArray[Any] | None = None) -> _Numbers: ...
    def beyond(self, r: ArrayLike, *, out: NDArray[Any] | None = None) -> _Numbers: ...
    def quantile(self, u: ArrayLike, *, out: NDArray[Any] | None = None) -> _Numbers: ...
    def sample(self, u: ArrayLike, *, out: NDArray[Any] | None = None) -> _Numbers: ...
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
    def configuration(self) -> _Configuration | None: ...
    @property
    def shape(self) -> tuple[int, ...]: ...

@final
class Fit:
    @property
    def family(self) -> _Family: ...
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
    @property
    def coat(self) -> float: ...
    @property
    def coat_roughness(self) -> float: ...
    @property
    def group(self) -> str: ...

def fit(
    r: ArrayLike | Profile,
    reflectance: ArrayLike | None = None,
    error: ArrayLike | None = None,
    *,
    family: _Family = "exponentials",
    terms: int | None = None,
) -> Fit: ...
def fit_scaling(
    configuration: _Configuration = "searchlight",
    parameter: Literal["mfp", "dmfp"] = "mfp",
    *,
    surface_albedo: ArrayLike | None = None,
    max_radius: float | None = None,
) -> dict[str, Any]: ...

class Measured(NamedTuple):
    value: NDArray[np.float64]
    likely: NDArray[np.float64]
    sure: NDArray[np.float64]
    unit: str

class Measurement(dict[str, Measured]):
    material: dict[str, Any]
    is_seen: NDArray[np.bool_] | None
    blur: float | None
    misfit: float | None
    correlation: NDArray[np.float64] | None
    stray_light: NDArray[np.float64] | None
    steps: int | None
    findings: list[str]
    notes: list[str]
    warnings: list[str]
    def __init__(self, found: dict[str, Any]) -> None: ...

def measure(
    photo: ArrayLike | _Path,
    *,
    setup: Literal["edge", "spot", "slab"] | None = None,
    thickness: float | None = None,
    mm_per_pixel: float | None = None,
    ruler: ArrayLike | None = None,
    white: Sequence[int] | None = None,
    white_photo: ArrayLike | _Path | None = None,
    white_reflectance: ArrayLike | None = None,
    white_tolerance: float | None = None,
    surface_albedo: ArrayLike | None = None,
    region: Sequence[int] | None = None,
    edge: ArrayLike | None = None,
    center: ArrayLike | None = None,
    card: Literal["hidden", "visible"] | None = None,
    exposure: Iterable[ArrayLike | _Path] | None = None,
    dark: ArrayLike | _Path | None = None,
    linear: bool = False,
    configuration: _Configuration | None = None,
    incidence: float | None = None,
    eta: float | None = None,
    g: float | None = None,
    scene: Scene | _Path | None = None,
    fit: str | Iterable[str] | None = None,
    material: str | None = None,
    subsurface: str | None = None,
    spp: int | None = None,
    seed: int | None = None,
    threads: int | None = None,
    progress: _Progress = None,
) -> Measurement: ...

class ConvertedParameter(NamedTuple):
    system: str
    parameter: str
    value: float | NDArray[np.float64]
    unit: str
    equal: str
    source: str

class Conversion(dict[str, dict[str, float | NDArray[np.float64]]]):
    rows: list[ConvertedParameter]
    notes: list[str]
    def __init__(self, rows: list[ConvertedParameter], notes: list[str]) -> None: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    def _repr_html_(self) -> str: ...

def convert(
    source: str,
    *,
    surface_albedo: ArrayLike | None = None,
    unit: _Unit = "mm",
    to_unit: _Unit | None = None,
    to: str | Iterable[str] = (),
    settings: Mapping[str, Mapping[str, float]] | None = None,
    configuration: _Configuration = "diffuse",
    color_space: _LinearSpace | None = None,
    from_color_space: _LinearSpace = "lin_rec709",
    thin: float | None = None,
    thin_g: float = 0.0,
    thin_eta: float = 1.0,
    **parameters: ArrayLike,
) -> Conversion: ...

def cycles_material(
    method: str,
    *,
    base_color: ArrayLike,
    radius: ArrayLike,
    scale: float = 1.0,
    ior: float = 1.4,
    anisotropy: float = 0.0,
    alpha: float = 1.0,
    version: tuple[int, ...] | None = None,
) -> dict[str, Any]: ...

presets: Final[Presets]

_Color: TypeAlias = ArrayLike | str
_Scalar: TypeAlias = ArrayLike

# Written by: cargo run -p translucid-scene --example keys
# keys
class _MaterialKeys(TypedDict, total=False):
    preset: str | None
    file: _Path | None
    file_material: str | None
    file_unit: _Unit | None
    base_weight: float | None
    base_color: _Color | dict[str, Any] | None
    base_metalness: _Scalar | dict[str, Any] | None
    specular_weight: _Scalar | dict[str, Any] | None
    specular_color: _Color | dict[str, Any] | None
    specular_roughness: _Scalar | dict[str, Any] | None
    specular_ior: float | None
    transmission_weight: _Scalar | dict[str, Any] | None
    transmission_color: _Color | dict[str, Any] | None
    transmission_depth: float | None
    transmission_tint: _Color | dict[str, Any] | None
    subsurface_weight: _Scalar | dict[str, Any] | None
    subsurface_color: _Color | dict[str, Any] | None
    subsurface_radius: _Scalar | dict[str, Any] | None
    subsurface_radius_scale: _Color | dict[str, Any] | None
    subsurface_scatter_anisotropy: float | None
    subsurface_eta: float | None
    subsurface_flights: float | None
    coat_weight: _Scalar | dict[str, Any] | None
    coat_color: _Color | dict[str, Any] | None
    coat_roughness: _Scalar | dict[str, Any] | None
    coat_ior: float | None
    emission_luminance: float | None
    emission_color: _Color | dict[str, Any] | None
    geometry_opacity: _Scalar | dict[str, Any] | None
    geometry_thin_walled: bool | None
    layer: Sequence[dict[str, Any]] | Literal["none"] | None
    subsurface_model: Literal["normalized-diffusion", "normalized-diffusion-refined", "normalized-diffusion-oblique", "dipole", "better-dipole", "directional-dipole", "quantized-diffusion", "photon-beam-diffusion", "gaussians", "exact", "random-walk", "random-walk-diffuse", "random-walk-rough", "random-walk-skin", "none", "default", "layers"] | None
    subsurface_table: _Path | None
    subsurface_parameter: Literal["mfp", "dmfp"] | None
    subsurface_configuration: Literal["searchlight", "diffuse"] | None
    subsurface_texture_at: Literal["exit", "entry", "both"] | None
    subsurface_normalization: Literal["none", "energy"] | None
    camera_visibility: Literal["surface", "shadow", "none"] | None
    geometry_normal: _Path | ArrayLike | dict[str, Any] | None

class _LightKeys(TypedDict, total=False):
    center: ArrayLike | None
    target: ArrayLike | None
    direction: ArrayLike | None
    up: ArrayLike | None
    size: ArrayLike | None
    edge_x: ArrayLike | None
    edge_y: ArrayLike | None
    radiance: _Color | None
    visible: bool | None
    radius: float | None
    unit_direction: ArrayLike | None
    angular_radius: float | None
    irradiance: _Color | None
    position: ArrayLike | None
    intensity: _Color | None
    inner_angle: float | None
    outer_angle: float | None
    origin: ArrayLike | None
    power: _Color | None

class _EnvironmentKeys(TypedDict, total=False):
    radiance: _Color | None
    file: _Path | ArrayLike | None
    rotation: float | None
    matrix: ArrayLike | None
    visible: bool | None

class _CameraKeys(TypedDict, total=False):
    position: ArrayLike | None
    target: ArrayLike | None
    up: ArrayLike | None
    projection: Literal["perspective", "orthographic"] | None
    fov: float | None
    width: float | None
    shift: ArrayLike | None
    lens_radius: float | None
    focus_distance: float | None

class _FilmKeys(TypedDict, total=False):
    size: ArrayLike | None
    filter: Literal["box", "gaussian", "blackman-harris"] | None
    filter_radius: float | None
    exposure: float | None
    tone_mapping: Literal["srgb", "neutral", "agx"] | None

class _IntegratorKeys(TypedDict, total=False):
    samples_per_pixel: int | None
    max_depth: int | None
    max_diffuse_depth: int | None
    caustics: bool | None
    subsurface_tail: float | None
    subsurface_method: Literal["ray-traced", "point-based", "cycles-disk"] | None
    subsurface_sharing: bool | None
    point_tolerance: float | None
    point_memory: int | None
    seed: int | None

_LightType: TypeAlias = Literal["rectangle", "ellipse", "sphere", "distant", "spot", "point", "beam"]
# end of keys

class SceneError(ValueError):
    message: str
    path: str | None
    line: int | None
    part: str | None
    help: str | None

@final
class Scene:
    def __new__(
        cls,
        unit: _Unit = "mm",
        *,
        camera: dict[str, Any] | None = None,
        environment: dict[str, Any] | None = None,
        film: dict[str, Any] | None = None,
        integrator: dict[str, Any] | None = None,
        lights: Iterable[dict[str, Any]] | None = None,
        origin: ArrayLike | None = None,
        subsurface_grouping: Literal["object", "material"] | None = None,
    ) -> Scene: ...
    @classmethod
    def load(
        cls,
        path: _Path,
        *,
        preset: str | None = None,
        unit: _Unit | None = None,
        size: Sequence[int] | None = None,
        subsurface: str | None = None,
        up: Literal["x", "y", "z", "-x", "-y", "-z"] | None = None,
        view: str | None = None,
        floor: str | None = None,
        camera: str | None = None,
    ) -> Scene: ...
    def add_material(self, name: str, **keys: Unpack[_MaterialKeys]) -> None: ...
    def add_mesh(
        self,
        name: str,
        vertices: ArrayLike,
        triangles: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        uv: ArrayLike | None = None,
        colors: ArrayLike | None = None,
        **keys: Any,
    ) -> None: ...
    def add_object(self, name: str | None = None, **keys: Any) -> None: ...
    def add_light(
        self,
        type: _LightType | None = None,
        **keys: Unpack[_LightKeys],
    ) -> None: ...
    def set_environment(self, **keys: Unpack[_EnvironmentKeys]) -> None: ...
    def set_camera(self, **keys: Unpack[_CameraKeys]) -> None: ...
    def set_film(self, **keys: Unpack[_FilmKeys]) -> None: ...
    def set_integrator(self, **keys: Unpack[_IntegratorKeys]) -> None: ...
    @property
    def unit(self) -> _Unit: ...
    @property
    def objects(self) -> list[str]: ...
    @property
    def materials(self) -> list[str]: ...
    @property
    def size(self) -> tuple[int, int]: ...

class Session:
    def __new__(
        cls,
        scene: Scene | _Path,
        *,
        size: Sequence[int] | None = None,
        subsurface: str | None = None,
        seed: int | None = None,
        threads: int | None = None,
        device: str = "cpu",
        region: Sequence[int] | None = None,
    ) -> Session: ...
    def run(self, samples: int | range | None = None, *, progress: _Progress = None) -> None: ...
    def step(self, samples: int = 1, *, progress: _Progress = None) -> None: ...
    def start(self, samples: int | range | None = None) -> None: ...
    def wait(self, *, progress: _Progress = None) -> None: ...
    def save(self, path: _Path, *, scene: str = "", samples_per_pixel: int | None = None) -> None: ...
    def cancel(self) -> None: ...
    def snapshot(self, layer: str = "radiance") -> NDArray[np.float32]: ...
    def picture(self, layers: Iterable[str] = ("radiance", "alpha")) -> Picture: ...
    def cryptomatte(
        self,
        kind: Literal["object", "material"] = "object",
        *,
        levels: int = 6,
        names: Mapping[str, str] | None = None,
    ) -> NDArray[np.float32]: ...
    def edit_material(self, name: str, **keys: Unpack[_MaterialKeys]) -> None: ...
    def edit_mesh(
        self,
        name: str,
        vertices: ArrayLike,
        triangles: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        uv: ArrayLike | None = None,
        colors: ArrayLike | None = None,
    ) -> None: ...
    def add_mesh(
        self,
        name: str,
        vertices: ArrayLike,
        triangles: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        uv: ArrayLike | None = None,
        colors: ArrayLike | None = None,
        **keys: Any,
    ) -> None: ...
    def edit_object(self, name: str, **keys: Any) -> None: ...
    def remove_object(self, name: str) -> None: ...
    def add_material(self, name: str, **keys: Unpack[_MaterialKeys]) -> None: ...
    def remove_material(self, name: str) -> None: ...
    def set_film(self, **keys: Unpack[_FilmKeys]) -> None: ...
    def set_region(self, region: Sequence[int] | None = None) -> None: ...
    def set_camera(self, **keys: Unpack[_CameraKeys]) -> None: ...
    def set_lights(self, lights: Iterable[dict[str, Any]]) -> None: ...
    def set_environment(self, **keys: Unpack[_EnvironmentKeys]) -> None: ...
    def set_integrator(self, **keys: Unpack[_IntegratorKeys]) -> None: ...
    @property
    def samples(self) -> int: ...
    @property
    def is_running(self) -> bool: ...
    @property
    def size(self) -> tuple[int, int]: ...
    @property
    def notes(self) -> list[str]: ...
    def _repr_png_(self) -> bytes | None: ...

class Picture(dict[str, NDArray[np.float32]]):
    exposure: float
    tone_mapping: str
    def __init__(
        self,
        layers: Mapping[str, NDArray[np.float32]] | Iterable[tuple[str, NDArray[np.float32]]] = (),
        *,
        exposure: float = 0.0,
        tone_mapping: str = "neutral",
    ) -> None: ...
    def tonemap(self, **arguments: Any) -> NDArray[Any]: ...
    def save(self, path: _Path) -> None: ...
    def _repr_png_(self) -> bytes | None: ...

def render(
    scene: Scene | _Path,
    *,
    size: Sequence[int] | None = None,
    spp: int | None = None,
    subsurface: str | None = None,
    seed: int | None = None,
    threads: int | None = None,
    device: str = "cpu",
    region: Sequence[int] | None = None,
    layers: Iterable[str] = ("radiance", "alpha"),
    progress: _Progress = None,
) -> Picture: ...
def tonemap(
    array: ArrayLike,
    *,
    exposure: float = 0.0,
    tone_mapping: _ToneMapping = "neutral",
    dtype: Literal["uint8", "float32"] = "uint8",
) -> NDArray[Any]: ...
def write_exr(
    path: _Path,
    picture: ArrayLike | Mapping[str, ArrayLike],
    *,
    half: Sequence[str] | None = None,
) -> None: ...
def cryptomatte_id(name: str) -> float: ...
def cryptomatte_metadata(layer: str, names: Iterable[str]) -> dict[str, str]: ...
def read_exr(path: _Path) -> dict[str, NDArray[np.float32]]: ...
