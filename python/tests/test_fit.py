"""Fits: what went in comes out, with errors that hold, and the command's numbers."""

import pickle

import numpy as np
import pytest

import translucid
from translucid import Profile, fit, fit_scaling


def test_scaling_has_the_best_scales():
    # Best single s for all r, exact solution, searchlight; found on a grid of radii, and the minimum is flat
    albedos = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]
    best = [3.950, 2.972, 2.359, 1.921, 1.594, 1.333, 1.132, 0.955, 0.816]
    found = fit_scaling("searchlight", "mfp", surface_albedo=albedos)
    assert np.allclose(found["s"], best, atol=5e-3)
    assert found["talk_formula"] == "s = 1.85 - A + 7 |A - 0.8|^3"
    assert found["mean_error"] < found["talk_mean_error"]


def test_scaling_of_the_talk():
    # The mean errors of the talk's polynomials over 99 albedos and all r, by an independent solution
    for words, mean in [(("searchlight", "mfp"), 0.062), (("diffuse", "mfp"), 0.048), (("searchlight", "dmfp"), 0.076)]:
        assert fit_scaling(*words)["talk_mean_error"] == pytest.approx(mean, abs=0.0006)


def test_scaling_is_the_command(command):
    rows = command("fit", "--family", "burley", "--configuration", "diffuse", "--parameter", "mfp")
    found = fit_scaling("diffuse", "mfp")
    assert found["s"].tolist() == [row["s"] for row in rows]
    assert found["error"].tolist() == [row["error"] for row in rows]


@pytest.mark.parametrize("family, truth", [
    ("exponentials", lambda r: 0.3 * np.exp(-r / 0.5) / 0.5 / r + 0.3 * np.exp(-r / 2) / 2 / r),
    ("gaussians", lambda r: 0.3 * np.exp(-(r**2) / 0.5) / 0.25 + 0.3 * np.exp(-(r**2) / 8) / 4),
])
def test_sums_come_back(family, truth):
    r = np.geomspace(0.05, 12.0, 80)
    samples = truth(r) / (2 * np.pi)
    found = fit(r, samples, 0.01 * samples, family=family, terms=2)
    assert np.allclose(found.scales, [0.5, 2.0], rtol=1e-4) and np.allclose(found.weights, 0.5, rtol=1e-4)
    assert found.surface_albedo == pytest.approx(0.6, rel=1e-5) and found.chi_square < 1e-3
    assert found.degrees_of_freedom == 76 and found.undetermined == []
    assert np.allclose(found.profile.eval(r), samples, rtol=1e-4)
    assert np.abs(found.residuals).max() < 0.01


def test_errors_hold_the_truth():
    """Of 200 fits to noisy samples 1.96 errors hold the truth in 95 %: 4 binomial deviations are 6 %."""
    truth = Profile("normalized-diffusion", surface_albedo=0.5, mfp=1.0)
    rng, r = np.random.default_rng(11), np.geomspace(0.1, 8.0, 40)
    inside = 0
    for _ in range(200):
        error = 0.05 * truth.eval(r)
        found = fit(r, rng.normal(truth.eval(r), error), error, family="normalized-diffusion")
        inside += abs(found.surface_albedo - 0.5) < 1.96 * found.surface_albedo_error
    assert 0.89 < inside / 200 <= 1.0


def test_samples_without_errors_are_the_command(command, tmp_path):
    truth = Profile("exact", surface_albedo=0.5, mfp=1.0)
    r = np.geomspace(0.1, 8.0, 40)
    samples = truth.eval(r) * np.random.default_rng(2).normal(1.0, 0.05, 40)
    path = tmp_path / "measured.csv"
    path.write_text("r,reflectance\n" + "\n".join(f"{x!r},{y!r}" for x, y in zip(r.tolist(), samples.tolist())))
    rows = command("fit", "--table", path, "--terms", 2)
    for family in ("normalized-diffusion", "exponentials", "gaussians"):
        found = fit(r, samples, family=family)
        printed = {row["parameter"]: (row["value"], row["standard_error"]) for row in rows if row["fit"] == family}
        assert (found.surface_albedo, found.surface_albedo_error) == printed["surface_albedo"]
        scales = [value for name, value in printed.items() if name.startswith(("d", "scale", "standard"))]
        assert list(zip(found.scales.tolist(), found.scale_errors.tolist())) == scales


def test_profiles_are_fitted():
    exact = Profile("exact", surface_albedo=0.5, mfp=1.0, configuration="searchlight")
    errors = [fit(exact, terms=terms).l1_error for terms in (1, 2, 3, 4)]
    assert errors == sorted(errors, reverse=True) and errors[2] < 0.015
    found = fit(Profile("normalized-diffusion", surface_albedo=0.5, mfp=1.0, configuration="searchlight"), terms=2)
    assert np.allclose(found.weights, [0.25, 0.75], atol=1e-8)
    assert found.scales[1] / found.scales[0] == pytest.approx(3.0, abs=1e-7)
    assert found.chi_square is None and found.residuals is None and "exponentials" in repr(found)


def test_what_is_not_determined_is_named():
    r = np.linspace(0.01, 0.02, 20)
    samples = Profile(surface_albedo=0.5, mfp=1.0).eval(r)
    found = fit(r, samples, 0.2 * samples, terms=2)
    assert found.undetermined
    assert np.isfinite(found.scale_errors).all() and np.isfinite(found.weight_errors).all()


def test_fit_is_exported():
    assert translucid.fit is fit


def test_pickles_of_fits_come_back():
    r = np.geomspace(0.01, 10.0, 60)
    profile = Profile(surface_albedo=0.8, mfp=1.0)
    names = ("family", "surface_albedo", "surface_albedo_error", "chi_square", "degrees_of_freedom", "l1_error", "undetermined")
    for found in (fit(r, profile.eval(r), 0.01 * profile.eval(r)), fit(profile, family="gaussians")):
        again = pickle.loads(pickle.dumps(found))
        for name in names:
            assert getattr(again, name) == getattr(found, name)
        for name in ("weights", "weight_errors", "scales", "scale_errors"):
            assert np.array_equal(getattr(again, name), getattr(found, name))
        assert np.array_equal(again.profile.eval(r), found.profile.eval(r))
