"""The talk's figure: profiles against the exact solution and Monte Carlo, in 20 lines."""

import sys

import numpy as np
from matplotlib import pyplot as plt

import translucid
from translucid import reference

albedos, r = (0.2, 0.5, 0.8), np.linspace(0.05, 8.0, 160)
bins = np.linspace(0.25, 8.0, 32)
figure, axes = plt.subplots(1, 3, figsize=(12, 4), layout="constrained", sharey=True)
for albedo, ax in zip(albedos, axes):
    words = {"surface_albedo": albedo, "configuration": "searchlight"}
    walk = reference.walk(2_000_000, radii=bins, **words)
    value, error = walk.eval(bins, surface_albedo=albedo)
    ax.errorbar(bins, value * bins, 2 * error * bins, fmt=".", color="gray", label="Monte Carlo, 2 errors")
    truth, _ = reference.exact(r, **words)
    ax.plot(r, truth * r, "k", lw=1, label="exact")
    for model in ("normalized-diffusion", "normalized-diffusion-refined", "dipole", "photon-beam-diffusion"):
        profile = translucid.Profile(model, mfp=1.0, **words)
        ax.plot(r, profile.eval(r) * r, lw=1, label=model)
        off = np.abs(profile.eval(r) - truth) @ r / (truth @ r)
        print(f"A = {albedo}: {model:<29} off by {100 * off:5.2f} %")
    chi_square = np.mean(((value - reference.exact(bins, **words)[0]) / error) ** 2)
    print(f"A = {albedo}: Monte Carlo against exact, chi-square {chi_square:.2f} for each radius")
    ax.set(title=f"surface albedo {albedo}", xlabel="r / mfp", ylabel="r R(r)", yscale="log")
axes[2].legend(loc="lower left", fontsize="small")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "profile_against_truth.png", dpi=80)
