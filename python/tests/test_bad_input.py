"""What is wrong raises `ValueError` or `TypeError` that names the argument; whatever comes, results are finite."""

import datetime
import decimal
import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import translucid
from translucid import Profile, fit, fit_scaling
from translucid.reference import WhiteTable, exact, exact_total, walk

NAN, INF = math.nan, math.inf
JADE = Profile(surface_albedo=0.6, mfp=1.5)
IMAGE = Profile(surface_albedo=[0.2, 0.5, 0.8], mfp=1.0)
R, SAMPLES = [0.5, 1.0, 2.0, 4.0, 8.0], [1.0, 0.4, 0.1, 0.02, 0.001]


class Liar:
    """Says that it is an array, and is none."""

    def __array__(self, *arguments, **words):
        raise RuntimeError("no array today")


class WrongArray:
    def __array__(self, *arguments, **words):
        return "text"


class WrongNumber:
    def __float__(self):
        raise OverflowError("too much")


CASES = [
    # Radii
    (lambda: JADE.eval(-1.0), ValueError, "r is -1, but must be at least 0"),
    (lambda: JADE.eval(NAN), ValueError, "r is NaN"),
    (lambda: JADE.eval(-INF), ValueError, "r is -inf"),
    (lambda: JADE.eval([1.0, 2.0, -3.0]), ValueError, r"r\[2\] is -3"),
    (lambda: JADE.eval(np.array([[1.0, NAN], [1.0, 1.0]])), ValueError, r"r\[0, 1\] is NaN"),
    (lambda: JADE.eval(np.array([1.0, -2.0], dtype=np.float32)), ValueError, r"r\[1\] is -2"),
    (lambda: JADE.eval(np.linspace(1.0, -1.0, 100_001)), ValueError, r"r\[50001\] is -"),
    (lambda: JADE.eval(np.array([[1.0, 2.0], [3.0, -4.0]])[::-1, ::-1]), ValueError, r"r\[0, 0\] is -4"),
    (lambda: JADE.eval(np.array([1.0, -1.0], dtype=">f8")), ValueError, r"r\[1\] is -1"),
    (lambda: JADE.eval(np.array([-1], dtype=np.int8)), ValueError, r"r\[0\] is -1"),
    (lambda: JADE.eval([[1.0, 2.0], [3.0]]), ValueError, "r must be a number or an array"),
    (lambda: JADE.eval("1.0"), TypeError, "r must be real numbers"),
    (lambda: JADE.eval(b"1"), TypeError, "r must be real numbers"),
    (lambda: JADE.eval(None), TypeError, "r must be real numbers"),
    (lambda: JADE.eval(1j), TypeError, "r must be real numbers, but is of dtype complex"),
    (lambda: JADE.eval(np.array([1j])), TypeError, "complex"),
    (lambda: JADE.eval(True), TypeError, "bool"),
    (lambda: JADE.eval(np.array([True, False])), TypeError, "bool"),
    (lambda: JADE.eval(np.bool_(True)), TypeError, "bool"),
    (lambda: JADE.eval(object()), TypeError, "r must be real numbers"),
    (lambda: JADE.eval([object()]), TypeError, "object"),
    (lambda: JADE.eval(np.array([1.0, None])), TypeError, "object"),
    (lambda: JADE.eval({"r": 1.0}), TypeError, "r must be real numbers"),
    (lambda: JADE.eval({1.0, 2.0}), TypeError, "r must be real numbers"),
    (lambda: JADE.eval(x for x in [1.0]), TypeError, "r must be real numbers"),
    (lambda: JADE.eval(["a", "b"]), TypeError, "r must be real numbers"),
    (lambda: JADE.eval(decimal.Decimal("1.5")), TypeError, "object"),
    (lambda: JADE.eval(datetime.datetime(2026, 1, 1)), TypeError, "r must be real numbers"),
    (lambda: JADE.eval(np.array(["2026-01-01"], dtype="M8[D]")), TypeError, "datetime64"),
    (lambda: JADE.eval(np.zeros(3, dtype=[("a", "f8")])), TypeError, "r must be real numbers"),
    (lambda: JADE.eval(10**400), (ValueError, TypeError, OverflowError), "r is an integer that is too large"),
    (lambda: JADE.eval([10**400]), (ValueError, TypeError, OverflowError), "r"),
    (lambda: JADE.eval(Liar()), (ValueError, TypeError), "r must be"),
    (lambda: JADE.eval(WrongArray()), (ValueError, TypeError), "r must be"),
    (lambda: JADE.eval(WrongNumber()), (ValueError, TypeError, OverflowError), "r must be"),
    (lambda: JADE.eval(JADE), TypeError, "r must be real numbers"),
    (lambda: JADE.eval(), TypeError, "r"),
    (lambda: JADE.eval(1.0, 2.0), TypeError, "eval"),
    # Shares
    (lambda: JADE.quantile(1.5), ValueError, r"u is 1.5, but must be in \[0, 1\]"),
    (lambda: JADE.sample(-1e-300), ValueError, "u is -"),
    (lambda: JADE.sample(np.array([0.5, NAN])), ValueError, r"u\[1\] is NaN"),
    (lambda: JADE.sample(np.nextafter(1.0, 2.0)), ValueError, "u is 1.0000000000000002"),
    # Shapes
    (lambda: IMAGE.eval([1.0, 2.0]), ValueError, r"cannot be broadcast together: profile \[3\], r \[2\]"),
    (lambda: Profile(surface_albedo=[0.1, 0.2], mfp=[1, 2, 3]), ValueError, r"surface_albedo \[2\], mfp \[3\]"),
    (lambda: Profile(surface_albedo=[[0.1], [0.2, 0.3]], mfp=1.0), ValueError, "surface_albedo must be"),
    # Parameters
    (lambda: Profile(surface_albedo=1.5, mfp=1.0), ValueError, r"surface_albedo is 1.5, but must be in \[0, 1\]"),
    (lambda: Profile(surface_albedo=NAN, mfp=1.0), ValueError, "surface_albedo is NaN"),
    (lambda: Profile(surface_albedo=[0.5, -0.1], mfp=1.0), ValueError, r"surface_albedo is -0.1.*\(at index \[1\]\)"),
    (lambda: Profile(surface_albedo=0.5, mfp=0.0), ValueError, "mfp is 0, but must be"),
    (lambda: Profile(surface_albedo=0.5, mfp=-1.0), ValueError, "mfp is -1"),
    (lambda: Profile(surface_albedo=0.5, mfp=INF), ValueError, "mfp is inf"),
    (lambda: Profile(surface_albedo=0.5, dmfp=NAN), ValueError, "dmfp is NaN"),
    (lambda: Profile(surface_albedo=1.0, dmfp=1.0), ValueError, "surface_albedo is 1"),
    (lambda: Profile(surface_albedo=0.5), TypeError, "one of mfp and dmfp"),
    (lambda: Profile(surface_albedo=0.5, mfp=1.0, dmfp=1.0), TypeError, "one of mfp and dmfp"),
    (lambda: Profile(mfp=1.0), TypeError, "surface_albedo"),
    (lambda: Profile(surface_albedo="red", mfp=1.0), TypeError, "surface_albedo must be real numbers"),
    (lambda: Profile("burley", surface_albedo=0.5, mfp=1.0), ValueError, 'model is "burley", but must be one of normal'),
    (lambda: Profile(3, surface_albedo=0.5, mfp=1.0), TypeError, "model"),
    (lambda: Profile(surface_albedo=0.5, mfp=1.0, configuration="x"), ValueError, 'configuration is "x"'),
    (lambda: Profile("exact", surface_albedo=0.5, mfp=1.0, g=0.5), ValueError, "g is 0.5, but must be 0"),
    (lambda: Profile("gaussians", surface_albedo=0.5, mfp=1.0, eta=1.4), ValueError, "eta is 1.4, but must be 1"),
    (lambda: Profile("dipole", surface_albedo=0.5, mfp=1.0, g=1.0), ValueError, r"g is 1, but must be in \(-1, 1\)"),
    (lambda: Profile("dipole", surface_albedo=0.5, mfp=1.0, eta=-1.0), ValueError, "eta is -1"),
    (lambda: Profile("dipole", surface_albedo=0.5, mfp=1.0, eta=[1.0, NAN]), ValueError, r"eta is NaN.*\[1\]"),
    (lambda: Profile.from_medium(-1.0, 1.0), ValueError, "sigma_a is -1"),
    (lambda: Profile.from_medium(0.0, 0.0), ValueError, "sigma_t"),
    (lambda: Profile.from_medium(1.0, [1.0, INF]), ValueError, "sigma_s is inf"),
    (lambda: Profile.from_medium(1.0), TypeError, "sigma_s"),
    # Tables
    (lambda: Profile.from_table([1, 2, 3], [3, 2, 1]), ValueError, "must be at least 4"),
    (lambda: Profile.from_table([1, 2, 2, 4], [4, 3, 2, 1]), ValueError, r"r\[2\] is 2, but must be above 2"),
    (lambda: Profile.from_table([1, 2, 3, 4], [4, 3, 2]), ValueError, "reflectance has the shape"),
    (lambda: Profile.from_table([1, 2, 3, 4], [1, 2, 3, 1000]), ValueError, "R"),
    (lambda: Profile.from_table([1, 2, 3, 4], [4, NAN, 2, 1]), ValueError, r"reflectance\[1\] is NaN"),
    (lambda: Profile.from_table([1, 2, 3, 4], [0, 0, 0, 0]), ValueError, "0 everywhere"),
    (lambda: Profile.from_table([[1, 2], [3, 4]], [[4, 3], [2, 1]]), ValueError, "one dimension"),
    (lambda: Profile.from_table([1, 2, 3, 4]), TypeError, "reflectance is missing"),
    (lambda: Profile.from_table("no such file.csv"), ValueError, "no such file.csv"),
    (lambda: Profile.from_table(R, SAMPLES, mfp=2.0), TypeError, "surface_albedo is missing"),
    (lambda: Profile.from_table(R, [SAMPLES] * 2, surface_albedos=[0.5]), ValueError, "surface_albedos has the shape"),
    (lambda: Profile.from_table(R, [SAMPLES] * 2, surface_albedos=[0.5, 0.2], surface_albedo=0.3), ValueError, r"surface_albedos\[1\] is 0.2"),
    (lambda: Profile.from_table(R, [SAMPLES] * 2, surface_albedos=[0.2, 0.5]), TypeError, "surface_albedo is missing"),
    (lambda: Profile.from_table(R, SAMPLES, surface_albedo=2.0), ValueError, "surface_albedo is 2"),
    (lambda: Profile.from_table(R, SAMPLES, enclosed=[1, 2]), ValueError, "enclosed has the shape"),
    # The exact solution
    (lambda: exact(1.0), TypeError, "one of surface_albedo and single_scattering_albedo"),
    (lambda: exact(1.0, surface_albedo=0.5, single_scattering_albedo=0.5), TypeError, "one of"),
    (lambda: exact(-1.0, surface_albedo=0.5), ValueError, "r is -1"),
    (lambda: exact(1.0, surface_albedo=[0.5, 0.0]), ValueError, r"surface_albedo\[1\] is 0, but must be in \(0, 1\]"),
    (lambda: exact(1.0, surface_albedo=0.5, mfp=0.0), ValueError, "mfp is 0"),
    (lambda: exact(1.0, surface_albedo=0.5, eta=4.0), ValueError, r"eta is 4, but must be in \[0.5, 3\]"),
    (lambda: exact(1.0, surface_albedo=0.5, configuration="beam"), ValueError, 'configuration is "beam"'),
    (lambda: exact(1.0, surface_albedo=0.5, incidence_angle=90.0), ValueError, r"incidence_angle is 90, but must be in \[0, 90\)"),
    (lambda: exact(1.0, surface_albedo=0.5, incidence_angle=60.0, eta=0.8), ValueError, r"below asin\(eta\) = 53.1"),
    (lambda: exact(1.0, surface_albedo=0.5, incidence_angle=[1, 2]), TypeError, "incidence_angle must be one number"),
    (lambda: exact(1.0, surface_albedo=0.5, incidence_angle=10, configuration="diffuse"), ValueError, "incidence_angle"),
    (lambda: exact(1.0, surface_albedo=0.5, azimuth=10.0), TypeError, "azimuth needs an incidence_angle"),
    (lambda: exact(1.0, surface_albedo=0.5, threads=0), ValueError, "threads is 0"),
    (lambda: exact(1.0, surface_albedo=0.5, progress=3), TypeError, "progress is 3"),
    (lambda: exact_total(0.0), ValueError, "single_scattering_albedo is 0"),
    # Walks
    (lambda: walk(-1), ValueError, "photons is -1, but must be a whole number"),
    (lambda: walk(1.5), ValueError, "photons is 1.5"),
    (lambda: walk(NAN), ValueError, "photons is nan"),
    (lambda: walk(2**70), ValueError, "photons is"),
    (lambda: walk("10"), TypeError, "photons must be a whole number"),
    (lambda: walk(True), TypeError, "photons must be a whole number"),
    (lambda: walk(range(0, 10, 2)), ValueError, "a range of step 1"),
    (lambda: walk(range(-5, 10)), ValueError, "a range of step 1"),
    (lambda: walk(10, radii=[0.0]), ValueError, r"radii\[0\] is 0"),
    (lambda: walk(10, radii=[[1.0], [2.0]]), ValueError, "radii has the shape"),
    (lambda: walk(10, edges=[2.0, 1.0]), ValueError, "greater than the radius before it"),
    (lambda: walk(10, radii=[1.0], edges=[1.0]), TypeError, "one of radii and edges"),
    (lambda: walk(10, g=1.0), ValueError, r"g is 1, but must be in \(-1, 1\)"),
    (lambda: walk(10, g=[0.1, 0.2]), TypeError, "g must be one number"),
    (lambda: walk(10, eta=0.0), ValueError, "eta is 0"),
    (lambda: walk(10, thickness=0.0), ValueError, "thickness is 0"),
    (lambda: walk(10, spot_radius=-1.0), ValueError, "spot_radius is -1"),
    (lambda: walk(10, reference_albedo=1.0), ValueError, "reference_albedo is 1"),
    (lambda: walk(10, single_scattering_albedo=1.0), ValueError, "a walk goes up to 0.999999"),
    (lambda: walk(10, surface_albedo=0.5, reference_albedo=0.5), TypeError, "at most one of"),
    (lambda: walk(10, phase_function="mie"), ValueError, 'phase_function is "mie"'),
    (lambda: walk(10, phase_function="rayleigh", g=0.1), ValueError, "Rayleigh"),
    (lambda: walk(10, phase_function="moments:0.3334"), ValueError, "at every angle, for a walk"),
    (lambda: walk(10, phase_function=[0.1, 0.2]), ValueError, r"of the shape \(n, 2\)"),
    (lambda: walk(10, phase_function=[[-1, 1], [0.5, 1]]), ValueError, "last cosine of the phase function is 0.5"),
    (lambda: walk(10, phase_function=[[-1, 1], [1, 1]], g=0.5), ValueError, "states the mean cosine"),
    (lambda: walk(10, sectors=0), ValueError, "sectors is 0"),
    (lambda: walk(10, sectors=-1), (OverflowError, ValueError), "."),
    (lambda: walk(10, seed=-1), (OverflowError, ValueError), "."),
    (lambda: walk(10, radii=np.linspace(1, 2, 9000)), ValueError, "at most 8000"),
    (lambda: walk(10, radii=[1.0]).eval(2.0, single_scattering_albedo=0.5), ValueError, "radius is 2"),
    (lambda: walk(10, radii=[1.0]).eval(1.0, single_scattering_albedo=0.9999), ValueError, "single_scattering_albedo is"),
    (lambda: walk(10, radii=[1.0]).eval(1.0, single_scattering_albedo=0.5, side="transmitted"), ValueError, "half space"),
    (lambda: walk(10, radii=[1.0]).eval(1.0, single_scattering_albedo=0.5, side="left"), ValueError, 'side is "left"'),
    (lambda: walk(10).profile(single_scattering_albedo=0.5), ValueError, "."),
    (lambda: WhiteTable(), TypeError, "."),
    (lambda: WhiteTable._from_bytes(b"PK\x03\x04junk"), ValueError, "bytes"),
    # Fits
    (lambda: fit([1.0, 2.0], [1.0, 0.5]), ValueError, "number of samples is 2"),
    (lambda: fit(R, SAMPLES[:4]), ValueError, "reflectance has the shape"),
    (lambda: fit(R, [1.0, 0.5, -0.1, 0.1, 0.1]), ValueError, r"reflectance\[2\] is -0.1"),
    (lambda: fit(R, SAMPLES, [0.1, 0.1, 0.0, 0.1, 0.1]), ValueError, r"error\[2\] is 0"),
    (lambda: fit(R, SAMPLES, [0.1, 0.1]), ValueError, "error has the shape"),
    (lambda: fit([0.0, *R[1:]], SAMPLES), ValueError, r"r\[0\] is 0"),
    (lambda: fit(R, [NAN, *SAMPLES[1:]]), ValueError, r"reflectance\[0\] is NaN"),
    (lambda: fit(R, SAMPLES, family="sinc"), ValueError, 'family is "sinc"'),
    (lambda: fit(R, SAMPLES, terms=0), ValueError, "terms is 0"),
    (lambda: fit(R, SAMPLES, terms=1.5), ValueError, "terms is 1.5"),
    (lambda: fit(R, SAMPLES, terms=9), ValueError, "terms is 9"),
    (lambda: fit(R, SAMPLES, terms=2, family="normalized-diffusion"), ValueError, "terms is 2"),
    (lambda: fit(R), TypeError, "reflectance is missing"),
    (lambda: fit(JADE, SAMPLES), TypeError, "r is a Profile"),
    (lambda: fit(IMAGE), ValueError, r"shape \[3\], but must be a single one"),
    (lambda: fit(Profile(surface_albedo=0.0, mfp=1.0)), ValueError, "total is 0"),
    (lambda: fit_scaling("x"), ValueError, 'configuration is "x"'),
    (lambda: fit_scaling(parameter="x"), ValueError, 'parameter is "x"'),
    (lambda: fit_scaling(surface_albedo=[0.0]), ValueError, r"surface_albedo\[0\] is 0"),
    (lambda: fit_scaling(surface_albedo=[]), ValueError, "surface_albedo has the shape"),
    (lambda: fit_scaling(max_radius=0.0), ValueError, "max_radius is 0"),
]


@pytest.mark.parametrize("number", range(len(CASES)))
def test_mistakes_are_named(number):
    call, kind, message = CASES[number]
    with pytest.raises(kind, match=message):
        call()


NUMBERS = st.one_of(
    st.floats(),
    st.floats(0.0, 1.0),
    st.floats(0.0, 1e300),
    st.sampled_from([0.0, -0.0, 5e-324, 2.2e-308, 1e-150, 1e150, 1.7e308, 1.0, 0.999999999, 1e-17]),
    st.integers(-3, 10**25),
)
ARRAYS = st.one_of(
    NUMBERS,
    st.lists(NUMBERS, max_size=4).map(lambda x: np.array(x, dtype=float)),
    st.lists(st.floats(0.0, 1.0, width=32), max_size=4).map(lambda x: np.array(x, dtype=np.float32)[::-1]),
    st.sampled_from([None, "x", [[0.5], [0.1, 0.2]], True, 1j, np.zeros((2, 0)), np.full((2, 2), 0.5, dtype=">f4")]),
)
ALLOWED = (ValueError, TypeError, OverflowError)


def finite(value):
    assert np.isfinite(value).all(), value
    return value


FEW = settings(deadline=None, suppress_health_check=list(HealthCheck), derandomize=True, database=None)


@settings(FEW, max_examples=9000)
@given(
    st.sampled_from(translucid.models),
    st.one_of(ARRAYS, st.floats(0.0, 1.0)),
    st.one_of(ARRAYS, st.floats(1e-3, 1e3)),
    st.sampled_from(["mfp", "dmfp"]),
    st.sampled_from([None, "searchlight", "diffuse"]),
    st.one_of(st.none(), st.none(), st.floats(-1.0, 1.0), NUMBERS),
    st.one_of(st.none(), st.none(), st.floats(0.5, 2.0), NUMBERS),
    st.sampled_from(["eval", "pdf", "pdf_area", "cdf", "enclosed", "beyond", "quantile", "sample"]),
    ARRAYS,
)
def test_profiles_return_finite_numbers_or_say_why(model, albedo, length, name, configuration, g, eta, method, x):
    try:
        words = {name: value for name, value in (("g", g), ("eta", eta)) if value is not None}
        profile = Profile(model, surface_albedo=albedo, configuration=configuration, **{name: length}, **words)
        finite(profile.total)
        found = getattr(profile, method)(x)
    except ALLOWED as error:
        assert str(error)
        return
    finite(found)


@settings(FEW, max_examples=500)
@given(ARRAYS, st.one_of(ARRAYS, st.floats(0.0, 1.0)), st.sampled_from(["surface_albedo", "single_scattering_albedo"]),
       st.one_of(st.just(1.0), NUMBERS), st.sampled_from([None, "searchlight", "diffuse"]))
def test_exact_returns_finite_numbers_or_says_why(r, albedo, name, mfp, configuration):
    try:
        value, error = exact(r, mfp=mfp, configuration=configuration, **{name: albedo})
    except ALLOWED as error:
        assert str(error)
        return
    assert np.all(finite(value) >= 0) and np.all(finite(error) >= 0)


@settings(FEW, max_examples=300)
@given(st.lists(st.tuples(st.floats(0.0, 100.0), st.floats(-1.0, 10.0), st.floats(0.0, 1.0)), max_size=8),
       st.booleans(), st.sampled_from(["exponentials", "gaussians", "normalized-diffusion"]), st.integers(0, 3))
def test_fits_return_finite_numbers_or_say_why(rows, has_errors, family, terms):
    columns = np.array(rows, dtype=float).reshape(-1, 3).T
    try:
        found = fit(columns[0], columns[1], columns[2] if has_errors else None, family=family, terms=terms)
    except ALLOWED as error:
        assert str(error)
        return
    for value in (found.surface_albedo, found.surface_albedo_error, found.scales, found.scale_errors, found.weights,
                  found.weight_errors, found.residuals, found.chi_square):
        finite(value)


@settings(FEW, max_examples=300)
@given(st.integers(0, 300), st.lists(st.one_of(st.floats(0.0, 10.0), NUMBERS), max_size=3), NUMBERS,
       st.one_of(st.just(0.0), st.floats(-1.0, 1.0)), st.floats(0.0, 3.0), st.one_of(st.none(), st.floats(0.0, 5.0)),
       st.one_of(st.floats(0.0, 1.0), NUMBERS), st.integers(0, 9))
def test_walks_return_finite_numbers_or_say_why(photons, radii, reference, g, eta, thickness, alpha, sectors):
    try:
        found = walk(photons, radii=radii, reference_albedo=min(float(reference), 0.99), g=g, eta=eta,
                     thickness=thickness, sectors=sectors, threads=1)
        values = [*found.total(single_scattering_albedo=alpha), *found.rings(single_scattering_albedo=alpha)]
        if radii:
            values += [*found.eval(radii, single_scattering_albedo=alpha)]
    except ALLOWED as error:
        assert str(error)
        return
    for value in values:
        finite(value)


def test_wrong_questions_are_refused_by_their_keys():
    questions = translucid._translucid._wrong_questions()
    assert len(questions) > 100
    for name, said, key in questions:
        with pytest.raises((TypeError, ValueError)) as raised:
            translucid._translucid._ask(name, said)
        message = str(raised.value)
        assert key in message and any(word in message for word in ("must", "need", "allowed")), (name, said, message)
