"""
How good can a cheap model be?
==============================

Polynomials and a Gaussian process learn from 128 finite element runs of the bandage and are judged
on the same 40 runs that none has seen; ``reduced`` is the paper's linear model of nine runs.

.. code-block:: console

   $ surrogate run studies/bandage_surrogates.yaml
"""

from dataclasses import replace

import matplotlib.pyplot as plt

from surrogate import Study

study = Study.from_yaml("../../studies/bandage_surrogates.yaml")
study = replace(study, outputs=("pressure_b1",))
runs = study.stored()
fits = study.fit(runs)
table = study.compare(fits, runs)
print("\n".join(table["sentence"].values))

# %%
# Predicted against simulated pressure on the held-out runs, with 95 % intervals.

test = runs.isel(run=(runs["design"] == "test").values)
truth = test["pressure_b1"].values
fig, axes = plt.subplots(1, 3, figsize=(10, 3.5), sharex=True, sharey=True)
for axis, name in zip(axes, ["reduced", "quadratic", "gp"], strict=True):
    fit = fits[name]["pressure_b1"]
    low, high = fit.interval(test["coded"].values)
    value = fit.predict(test["coded"].values)
    axis.axline((30, 30), slope=1, color="0.6", linewidth=1)
    axis.errorbar(truth, value, [value - low, high - value], fmt="o", markersize=3, linewidth=0.8)
    error = float(table["rmse_test"].sel(surrogate=name, output="pressure_b1"))
    axis.set(title=f"{name}: RMSE {error:.2f} mmHg", xlabel="simulated (mmHg)")
axes[0].set_ylabel("predicted (mmHg)")
plt.show()
