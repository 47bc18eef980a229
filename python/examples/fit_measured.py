"""A profile fitted to measured data, with error bars."""

import sys

import numpy as np
from matplotlib import pyplot as plt

import translucid

# What an instrument would read off marble: 40 radii in millimeters, noise of 5 % and of 1e-6 per square millimeter
marble = translucid.Profile.from_medium(0.0071, 3.00, model="exact", configuration="searchlight")
r = np.geomspace(0.05, 20.0, 40)
error = np.hypot(0.05 * marble.eval(r), 1e-6)
measured = np.random.default_rng(1).normal(marble.eval(r), error)

figure, (above, below) = plt.subplots(
    2, 1, figsize=(7, 6), layout="constrained", sharex=True, height_ratios=(2, 1)
)
above.errorbar(r, measured, 2 * error, fmt=".", color="gray", label="measured, 2 errors")
for family, terms in (("normalized-diffusion", 1), ("exponentials", 2), ("exponentials", 3), ("gaussians", 3)):
    fit = translucid.fit(r, measured, error, family=family, terms=terms)
    reduced = fit.chi_square / fit.degrees_of_freedom
    print(f"{family}, {terms}: chi-square {reduced:.2f} for each degree of freedom")
    print(f"  surface albedo {fit.surface_albedo:.4f} +- {fit.surface_albedo_error:.4f}")
    for weight, dw, scale, ds in zip(fit.weights, fit.weight_errors, fit.scales, fit.scale_errors):
        print(f"  weight {weight:.3f} +- {dw:.3f}, scale {scale:.3f} +- {ds:.3f} mm")
    if fit.undetermined:
        print(f"  not determined: {', '.join(fit.undetermined)}")
    above.plot(r, fit.profile.eval(r), lw=1, label=f"{family}, {terms}")
    below.plot(r, fit.residuals, ".-", lw=0.5)
print(f"truth: surface albedo {marble.total:.4f}")
above.set(yscale="log", ylabel="R(r) [1/mm²]", ylim=(1e-8, 10))
below.set(xscale="log", xlabel="r [mm]", ylabel="(fit − R)/error", ylim=(-8, 8))
above.legend()
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "fit_measured.png", dpi=80)
