"""Profiles: known values, laws that all models keep, arrays of every kind."""

import gc
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


def test_plot_says_what_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match=r"translucid\[plot\]"):
        of("dipole").plot()


def test_repr_says_what_it_is():
    text = repr(Profile("dipole", surface_albedo=[0.1, 0.2], mfp=1.0))
    assert "dipole" in text and "[2]" in text
    with pytest.raises(TypeError):
        pickle.dumps(of("dipole"))
