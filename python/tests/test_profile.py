"""Profiles: known values, laws that all models keep, arrays of every kind."""

import concurrent.futures
import copy
import gc
import multiprocessing
import pickle
import sys
import weakref

import numpy as np
import pytest

import translucid
from translucid import Profile


def of(model, **words):
    return Profile(model, **{"surface_albedo": 0.5, "mfp": 1.0, **words})


def test_models_are_all_there():
    assert len(translucid.models) == 10
    assert "normalized-diffusion-refined" in translucid.models and "exact" in translucid.models


@pytest.mark.parametrize("model", translucid.models)
def test_every_model_keeps_the_laws(model):
    profile = of(model, surface_albedo=0.6, mfp=2.0)
    r = np.geomspace(0.01, 40.0, 2000)
    # The model reaches the albedo, and its energies add up
    assert profile.total == pytest.approx(0.6, abs=1e-9)
    assert np.allclose(profile.enclosed(r) + profile.beyond(r), profile.total, atol=1e-9)
    # R is the slope of the energy
    middle = np.sqrt(r[1:] * r[:-1])
    slope = np.diff(profile.enclosed(r)) / np.diff(r) / (2 * np.pi * middle)
    assert np.allclose(slope, profile.eval(middle), rtol=0.01, atol=1e-12)
    # Densities are R over the albedo
    assert np.allclose(profile.pdf_area(r) * profile.total, profile.eval(r), rtol=1e-12)
    assert np.allclose(profile.pdf(r), 2 * np.pi * r * profile.pdf_area(r), rtol=1e-12)
    # quantile inverts cdf, and sample draws from it: the greatest distance of 20000 stratified numbers
    u = (np.arange(200) + 0.5) / 200
    assert np.allclose(profile.cdf(profile.quantile(u)), u, atol=1e-9)
    drawn = np.sort(profile.tabulated().sample(np.random.default_rng(3).random(20_000)))
    distance = np.abs(profile.cdf(drawn) - (np.arange(20_000) + 0.5) / 20_000).max()
    assert distance < 2.0 / np.sqrt(20_000)  # false alarm in 7e-4 of seeds


def test_normalized_diffusion_is_the_formula_of_the_talk():
    a, mfp = 0.7, 1.3
    r = np.linspace(0.1, 10.0, 50)
    for configuration, s in [
        ("searchlight", 1.85 - a + 7 * abs(a - 0.8) ** 3),
        ("diffuse", 1.9 - a + 3.5 * (a - 0.8) ** 2),
    ]:
        d = mfp / s
        expected = a * (np.exp(-r / d) + np.exp(-r / (3 * d))) / (8 * np.pi * d * r)
        found = Profile("normalized-diffusion", surface_albedo=a, mfp=mfp, configuration=configuration)
        assert np.allclose(found.eval(r), expected, rtol=1e-13)
    s = 3.5 + 100 * (a - 0.33) ** 4
    d = mfp / s
    assert Profile("normalized-diffusion", surface_albedo=a, dmfp=mfp).cdf(1.0) == pytest.approx(
        1 - 0.25 * np.exp(-1 / d) - 0.75 * np.exp(-1 / (3 * d)), rel=1e-14
    )


def test_exact_model_has_the_energies_of_the_exact_solution():
    profile = Profile("exact", surface_albedo=0.5, mfp=1.0, configuration="searchlight")
    expected = [0.041267, 0.253274, 0.474759, 0.499984]
    assert np.allclose(profile.enclosed([0.1, 1.0, 5.0, 20.0]), expected, atol=2e-6)


def test_configuration_depends_on_the_length_by_default():
    assert of("exact").configuration == "diffuse"
    assert Profile(surface_albedo=0.5, dmfp=1.0).configuration == "searchlight"


@pytest.mark.parametrize("model", translucid.models)
def test_profile_is_the_command(command, model):
    words = ("--model", model, "--surface-albedo", 0.4, "--mfp", 0.7, "--configuration", "searchlight")
    rows = command("profile", *words, "--at", "0.05,0.5,3")
    profile = Profile(model, surface_albedo=0.4, mfp=0.7, configuration="searchlight")
    r = np.array([0.05, 0.5, 3.0])
    assert profile.eval(r).tolist() == [row["reflectance"] for row in rows]
    assert profile.enclosed(r).tolist() == [row["enclosed"] for row in rows]


def test_from_medium_knows_what_the_medium_amounts_to():
    profile = Profile.from_medium([0.1, 0.2], 0.9, g=[[0.0], [0.5]])
    assert profile.shape == (2, 2)
    assert np.allclose(profile.mfp, [[1.0, 1 / 1.1]] * 2)
    assert np.allclose(profile.g, [[0.0, 0.0], [0.5, 0.5]])
    assert (profile.eta == 1.0).all() and profile.configuration == "diffuse"
    # alpha = 0.9: the exact half space returns 0.47802448922824 of diffuse light
    assert profile.surface_albedo[0, 0] == pytest.approx(0.47802448922824, abs=1e-9)
    assert profile.total[0, 0] == pytest.approx(0.47802448922824, abs=1e-9)
    grosjean = (2 * 0.1 + 0.9) / 3
    assert profile.dmfp[0, 0] == pytest.approx(np.sqrt(grosjean / 0.1), rel=1e-12)


def test_properties_are_what_was_given():
    profile = Profile("dipole", surface_albedo=0.5, mfp=[1.0, 2.0], g=0.3, eta=1.4)
    assert profile.model == "dipole" and profile.shape == (2,)
    assert profile.mfp.tolist() == [1.0, 2.0] and profile.dmfp is None
    assert profile.surface_albedo.tolist() == [0.5, 0.5]
    assert profile.g.tolist() == [0.3, 0.3] and profile.eta.tolist() == [1.4, 1.4]
    table = Profile.from_table([1.0, 2.0, 3.0, 4.0], [4.0, 2.0, 1.0, 0.5])
    assert table.model is None and table.configuration is None and table.mfp is None


def test_arrays_of_every_kind_give_the_same_numbers():
    profile = of("normalized-diffusion-refined")
    r = np.random.default_rng(5).uniform(0.0, 9.0, (30, 40, 3))
    expected = np.array([profile.eval(float(x)) for x in r.ravel()]).reshape(r.shape)
    assert (profile.eval(r) == expected).all()
    assert (profile.eval(np.asfortranarray(r)) == expected).all()
    assert (profile.eval(r[::-2, ::3, ::-1]) == expected[::-2, ::3, ::-1]).all()
    assert (profile.eval(r.transpose(2, 0, 1)) == expected.transpose(2, 0, 1)).all()
    assert (profile.eval(r.astype(">f8")) == expected).all()
    assert (profile.eval(r.tolist()) == expected).all()
    assert (profile.eval(np.broadcast_to(r[0], r.shape)) == np.broadcast_to(expected[0], r.shape)).all()
    frozen = r.copy()
    frozen.setflags(write=False)
    assert (profile.eval(frozen) == expected).all()
    unaligned = np.zeros(8 * 100 + 1, dtype=np.uint8)[1:].view(np.float64)
    unaligned[:] = r.ravel()[:100]
    assert (profile.eval(unaligned) == expected.ravel()[:100]).all()
    fields = np.zeros(100, dtype=[("a", "i1"), ("r", "f8")])
    fields["r"] = r.ravel()[:100]
    assert (profile.eval(fields["r"]) == expected.ravel()[:100]).all()


@pytest.mark.parametrize("dtype", ["i1", "u2", "i4", "i8", "u8", ">i4", "f2", "f4", "f8", "g"])
def test_precisions(dtype):
    profile = of("normalized-diffusion")
    r = np.array([1, 2, 3], dtype=dtype)
    found = profile.eval(r)
    single = dtype in ("f2", "f4")
    assert found.dtype == (np.float32 if single else np.float64)
    assert np.allclose(found, profile.eval([1.0, 2.0, 3.0]), rtol=1e-6 if single else 1e-15)


def test_shapes_follow_numpy():
    assert isinstance(of("dipole").eval(1.0), float)
    assert isinstance(of("dipole").eval(np.float64(1.0)), float)
    assert of("dipole").eval(np.array(1.0)).shape == () and of("dipole").eval([]).shape == (0,)
    image = Profile(surface_albedo=np.full((4, 5, 3), 0.5), mfp=[1.0, 2.0, 3.0])
    assert image.shape == (4, 5, 3) and image.eval(1.0).shape == (4, 5, 3)
    assert image.eval(np.ones((7, 1, 1, 1))).shape == (7, 4, 5, 3)
    single = [Profile(surface_albedo=0.5, mfp=mfp).eval(1.0) for mfp in (1.0, 2.0, 3.0)]
    assert (image.eval(1.0)[2, 3] == single).all()
    assert image.eval(np.float32(1.0)).dtype == np.float32
    assert Profile(surface_albedo=np.ones((0, 3)) / 2, mfp=1.0).eval(1.0).shape == (0, 3)


def test_equal_elements_share_one_profile():
    # A million pixels of two albedos are made in no time; as many media to invert would take minutes
    albedos = np.where(np.indices((1000, 1000)).sum(0) % 2, 0.3, 0.6)
    image = Profile("quantized-diffusion", surface_albedo=albedos, mfp=1.0)
    assert np.unique(image.total.round(6)).tolist() == [0.3, 0.6]


def test_large_arrays_are_not_copied():
    import tracemalloc

    profile, r = of("normalized-diffusion"), np.linspace(0.1, 9.0, 2_000_000)
    image = Profile("normalized-diffusion", surface_albedo=[[0.2], [0.5]], mfp=1.0)
    for of_r in (profile.eval, profile.cdf, image.eval):
        for numbers in (r, r[::2], r.astype(np.float32)):
            tracemalloc.start()
            found = of_r(numbers)
            _, peak = tracemalloc.get_traced_memory()
            tracemalloc.stop()
            assert peak < found.nbytes + 100_000


def test_references_are_let_go():
    profile, r = of("normalized-diffusion"), np.ones(10)
    before = sys.getrefcount(r)
    for _ in range(100):
        profile.eval(r)
        with pytest.raises(ValueError):
            profile.eval(-r)
    assert sys.getrefcount(r) == before
    there = weakref.ref(profile)
    del profile
    gc.collect()
    assert there() is None


def test_from_table_keeps_what_is_known():
    truth = of("exact", surface_albedo=0.8, configuration="searchlight")
    r = np.geomspace(0.01, 60.0, 150)
    samples = Profile.from_table(r, truth.eval(r))
    assert samples.total == pytest.approx(0.8, abs=1e-4)
    both = Profile.from_table(r, truth.eval(r), enclosed=truth.enclosed(r))
    assert np.allclose(both.enclosed(r), truth.enclosed(r), rtol=1e-9)
    scaled = Profile.from_table(r, truth.eval(r), surface_albedo=0.4, mfp=[1.0, 2.0])
    assert np.allclose(scaled.total, 0.4) and scaled.shape == (2,)
    assert np.allclose(scaled.cdf([3.0, 6.0]), truth.cdf(3.0), atol=1e-4)


def test_from_table_of_a_file_is_the_command(command, tmp_path):
    albedos, r = np.array([0.2, 0.5, 0.8]), np.geomspace(0.01, 40.0, 100)
    rows = Profile("exact", surface_albedo=albedos[:, None], mfp=1.0).eval(r)
    lines = [f"{a!r},{x!r},{y!r}" for a, row in zip(albedos.tolist(), rows.tolist()) for x, y in zip(r.tolist(), row)]
    path = tmp_path / "table.csv"
    path.write_text("surface_albedo,r,reflectance\n" + "\n".join(lines) + "\n")
    printed = command("profile", "--table", path, "--surface-albedo", 0.35, "--mfp", 1.7, "--at", "0.1,1,4")
    for table in (
        Profile.from_table(path, surface_albedo=0.35, mfp=1.7),
        Profile.from_table(r, rows, surface_albedos=albedos, surface_albedo=0.35, mfp=1.7),
    ):
        assert table.eval([0.1, 1.0, 4.0]).tolist() == [row["reflectance"] for row in printed]


def test_plot_draws_a_line_for_each_profile():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    for profile, lines in [(of("dipole"), 1), (Profile(surface_albedo=[[0.2, 0.5, 0.8]], mfp=[[1.0], [2.0]]), 6)]:
        for quantity in ("eval", "cdf", "pdf"):
            ax = profile.plot(quantity=quantity, label="x")
            assert len(ax.lines) == lines
            assert profile.plot([1.0, 2.0], ax=ax) is ax and len(ax.lines) == 2 * lines
            matplotlib.pyplot.close(ax.figure)
    with pytest.raises(ValueError, match="quantity is 'x'"):
        of("dipole").plot(quantity="x")
    ax = Profile(surface_albedo=[0.2, 0.5], mfp=1.0).plot()
    assert [line.get_label() for line in ax.lines] == ["surface albedo 0.2", "surface albedo 0.5"]
    assert of("dipole").plot(ax=ax).lines[-1].get_label() == "dipole"
    matplotlib.pyplot.close(ax.figure)


def test_plot_says_what_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match=r"translucid\[plot\]"):
        of("dipole").plot()


def test_repr_says_what_it_is():
    text = repr(Profile("dipole", surface_albedo=[0.1, 0.2], mfp=1.0))
    assert text == '<Profile("dipole", surface_albedo=0.1…0.2, mfp=1, configuration="diffuse") of shape [2]>'
    text = repr(Profile.from_medium(sigma_a=0.01, sigma_s=2.5, model="dipole"))
    assert "sigma_a=0.01, sigma_s=2.5" in text


METHODS = ["eval", "pdf", "pdf_area", "cdf", "enclosed", "beyond", "quantile", "sample"]


@pytest.mark.parametrize("method", METHODS)
def test_results_go_into_memory_that_is_given(method):
    u = np.random.default_rng(4).random((6, 5))
    many = Profile(surface_albedo=[[0.3]] * 6, mfp=[1.0, 2.0, 3.0, 4.0, 5.0])
    for profile in (of("normalized-diffusion"), many):
        f = getattr(profile, method)
        expected = f(u)
        # In C order, in Fortran's, strided, backwards, and not aligned
        odd = np.zeros(8 * 30 + 1, dtype=np.uint8)[1:].view(np.float64).reshape(6, 5)
        for out in (np.empty((6, 5)), np.empty((5, 6)).T, np.empty((12, 15))[::2, ::3], np.empty((6, 5))[::-1], odd):
            for numbers in (u, np.asfortranarray(u), u[::-1][::-1]):
                out[...] = np.nan
                assert f(numbers, out=out) is out
                assert (out == expected).all()
        single = np.empty((6, 5), dtype=np.float32)
        assert f(u.astype(np.float32), out=single) is single
        assert (single == f(u.astype(np.float32))).all()
    image = np.empty((2, 3))
    assert getattr(Profile(surface_albedo=[[0.2], [0.5]], mfp=1.0), method)([0.1, 0.5, 0.9], out=image) is image
    scalar = np.empty(())
    assert getattr(of("dipole"), method)(0.5, out=scalar) is scalar
    assert scalar == getattr(of("dipole"), method)(0.5)


def test_out_may_be_what_is_read():
    profile, r = of("normalized-diffusion-refined"), np.linspace(0.1, 9.0, 100_003)
    expected = profile.eval(r)
    same = r.copy()
    assert profile.eval(same, out=same) is same and (same == expected).all()
    # Shifted by some elements, backwards, and in turns
    for take, put in [
        (np.s_[:-7], np.s_[7:]),
        (np.s_[7:], np.s_[:-7]),
        (np.s_[:], np.s_[::-1]),
        (np.s_[:-3:2], np.s_[1:-2:2]),
    ]:
        memory = r.copy()
        out = memory[put]
        assert profile.eval(memory[take], out=out) is out and (out == expected[take]).all()
    several = Profile(surface_albedo=np.full(100_003, 0.5), mfp=1.0)
    assert (several.eval(r, out=r[::-1])[::-1] == expected[::-1]).all()


@pytest.mark.parametrize(
    "out, error, message",
    [
        (np.empty(4), ValueError, r"out has the shape \[4\], but must have that of the result, \[3\]"),
        (np.empty((1, 3)), ValueError, r"out has the shape \[1, 3\]"),
        (np.empty(3, dtype=np.float32), TypeError, "out is of dtype float32, but must be .* float64"),
        (np.empty(3, dtype=">f8"), TypeError, "out is of dtype >f8"),
        (np.empty(3, dtype=int), TypeError, "out is of dtype int64"),
        ([0.0, 0.0, 0.0], TypeError, "out is of type list"),
        (np.broadcast_to(0.0, 3), ValueError, "out is read-only"),
    ],
)
def test_out_that_does_not_fit_is_refused(out, error, message):
    with pytest.raises(error, match=message):
        of("dipole").eval(np.array([1.0, 2.0, 3.0]), out=out)
    with pytest.raises(error):
        Profile("dipole", surface_albedo=[0.4, 0.5, 0.6], mfp=1.0).eval(1.0, out=out)


def test_results_for_out_take_no_memory():
    import tracemalloc

    profile, r = of("normalized-diffusion"), np.linspace(0.1, 9.0, 2_000_000)
    image = Profile("normalized-diffusion", surface_albedo=[[0.2], [0.5]], mfp=1.0)
    out, both = np.empty_like(r), np.empty((2, len(r)))
    for work in (lambda: profile.sample(r / 9.0, out=out), lambda: profile.eval(r, out=out), lambda: image.eval(r, out=both)):
        work()
        tracemalloc.start()
        work()
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert peak < r.nbytes + 100_000  # r / 9.0


def pickled():
    """Profiles of every origin."""
    r = np.geomspace(0.01, 30.0, 40)
    truth = of("exact", surface_albedo=0.8)
    albedos = np.array([0.2, 0.5, 0.8])
    rows = Profile(surface_albedo=albedos[:, None], mfp=1.0).eval(r)
    walk = translucid.reference.walk(20_000, single_scattering_albedo=0.9, radii=np.geomspace(0.1, 5.0, 9))
    return {
        "model": of("dipole", g=0.3, eta=1.4, configuration="searchlight"),
        "dmfp": Profile(surface_albedo=0.7, dmfp=2.0),
        "image": Profile(surface_albedo=np.random.default_rng(6).random((4, 5, 3)), mfp=[1.0, 2.0, 3.0]),
        "equal elements": Profile(surface_albedo=np.full((4, 5), 0.25), mfp=1 / 3),
        "lengths": Profile(surface_albedo=0.5, mfp=np.float32([[0.1], [0.2]])),
        "none": Profile(surface_albedo=np.empty((0, 3)), mfp=1.0),
        "medium": Profile.from_medium([0.1, 0.2], 0.9, g=[[0.0], [0.5]]),
        "samples": Profile.from_table(r, truth.eval(r)),
        "energies": Profile.from_table(r, truth.eval(r), enclosed=truth.enclosed(r)),
        "shape": Profile.from_table(r, truth.eval(r), surface_albedo=0.4, dmfp=[1.0, 2.0]),
        "table": Profile.from_table(r, rows, surface_albedos=albedos, surface_albedo=[[0.3], [0.6]], mfp=[1.0, 0.1]),
        "tabulated": of("dipole").tabulated(),
        "twice": Profile("dipole", surface_albedo=[0.2, 0.4], mfp=1.0).tabulated().tabulated(),
        "fit": translucid.fit(truth, terms=3, family="gaussians").profile,
        "fit of samples": translucid.fit(r, truth.eval(r)).profile,
        "walk": walk.profile(single_scattering_albedo=0.9),
    }


@pytest.fixture(scope="module")
def profiles():
    return pickled()


def same_profile(a, b, u=0.37):
    numbers = [getattr(a, name) for name in ("total", "surface_albedo", "mfp", "dmfp", "g", "eta")]
    others = [getattr(b, name) for name in ("total", "surface_albedo", "mfp", "dmfp", "g", "eta")]
    assert (repr(a), a.shape, a.model, a.configuration) == (repr(b), b.shape, b.model, b.configuration)
    assert all(np.array_equal(x, y) for x, y in zip(numbers, others))
    for method in METHODS:
        assert np.array_equal(getattr(a, method)(u), getattr(b, method)(u)), method


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
def test_pickles_come_back(profiles, protocol):
    for profile in profiles.values():
        again = pickle.loads(pickle.dumps(profile, protocol))
        same_profile(profile, again)
        same_profile(profile, pickle.loads(pickle.dumps(again)))


def test_table_of_a_file_with_radii_of_their_own_comes_back(tmp_path):
    path = tmp_path / "table.csv"
    lines = ["surface_albedo,r,reflectance"]
    for albedo, radii in [(0.2, [0.1, 0.5, 1.0, 2.0]), (0.6, [0.2, 0.4, 1.5, 3.0, 4.0])]:
        of_albedo = Profile(surface_albedo=albedo, mfp=1.0)
        lines += [f"{albedo},{r},{of_albedo.eval(r)!r}" for r in radii]
    path.write_text("\n".join(lines) + "\n")
    profile = Profile.from_table(path, surface_albedo=0.4, mfp=2.0)
    text = pickle.dumps(profile)
    path.unlink()
    same_profile(profile, pickle.loads(text))


def test_copies_are_the_same(profiles):
    for profile in profiles.values():
        same_profile(profile, copy.copy(profile))
        same_profile(profile, copy.deepcopy({"a": [profile]})["a"][0])


def test_pickle_of_an_image_is_as_large_as_its_albedos():
    image = Profile(surface_albedo=np.random.default_rng(8).random((100, 100)), mfp=1.0)
    assert len(pickle.dumps(image)) < 8 * 10_000 + 1000


def test_profiles_go_to_other_processes():
    profile, r = Profile("better-dipole", surface_albedo=[0.2, 0.5], mfp=1.0), [0.1, 1.0, 3.0]
    context = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as pool:
        assert [x.tolist() for x in pool.map(profile.eval, r)] == [profile.eval(x).tolist() for x in r]


def test_damaged_pickles_are_exceptions(profiles):
    random = np.random.default_rng(9)
    # Names that a change makes are not to be imported: nothing of a pickle but what profiles need
    import io

    class Unpickler(pickle.Unpickler):
        def find_class(self, module, name):
            if module.split(".")[0] not in ("translucid", "numpy", "functools") and (module, name) != ("builtins", "getattr"):
                raise pickle.UnpicklingError(f"{module}.{name}")
            return super().find_class(module, name)

    refused = 0
    for profile in profiles.values():
        whole = pickle.dumps(profile)
        assert isinstance(Unpickler(io.BytesIO(whole)).load(), Profile)
        for _ in range(60):
            bytes_ = bytearray(whole)
            for _ in range(random.integers(1, 4)):
                bytes_[random.integers(len(bytes_))] = random.integers(256)
            if random.random() < 0.2:
                del bytes_[random.integers(len(bytes_)) :]
            try:
                again = Unpickler(io.BytesIO(bytes_)).load()
            except Exception as error:
                assert not type(error).__name__ == "PanicException"
                refused += 1
                continue
            if isinstance(again, Profile):
                assert np.isfinite(again.eval(0.5)).all() and np.isfinite(again.total).all()
    assert refused > 100


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: Profile._from_rows([]), r"rows.len\(\)"),
        (lambda: Profile._from_rows([(0.5, [1.0, 2.0], [1.0], [])]), r"radii.len\(\)"),
        (lambda: Profile._from_rows([(None, [1.0, 2.0, 3.0, 4.0], [1.0, 0.5, np.nan, 0.1], [])]), "NaN"),
        (lambda: Profile._from_rows([(2.0, [1.0, 2.0, 3.0, 4.0], [1.0, 0.5, 0.2, 0.1], [])]), "surface_albedo"),
        (lambda: Profile._from_rows(3), "rows"),
        (lambda: Profile._from_rows([("a", [], [], [])]), "rows"),
        (lambda: Profile._from_fit("cubes", 0.5, [(1.0, 1.0)]), "family"),
        (lambda: Profile._from_fit("gaussians", -1.0, [(1.0, 1.0)]), "total"),
        (lambda: Profile._from_fit("gaussians", 0.5, []), "weights"),
        (lambda: Profile._from_fit("exponentials", 0.5, [(np.nan, 1.0)]), "weight"),
        (lambda: Profile._from_fit("exponentials", 0.5, [(1.0, 0.0)]), "scale"),
    ],
)
def test_calls_of_pickles_check_their_arguments(make, message):
    with pytest.raises((ValueError, TypeError), match=message):
        make()
