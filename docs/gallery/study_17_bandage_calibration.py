"""
Which tension law does the fabric have?
=======================================

Ten bandages on the mean leg, two sensors: tension, exponent of the law and friction are learnt
from the pressures. The measurements are synthetic, so that the answer is known.

.. code-block:: console

   $ surrogate run studies/bandage_calibration.yaml
"""

import runpy

import matplotlib.pyplot as plt
import numpy as np

from surrogate import Study

study = Study.from_yaml("../../studies/bandage_calibration.yaml")
runs = study.stored()
fits = study.fit(runs)
found = study.calibrate(fits, study.compare(fits, runs))
print(found)
print(found.convergence)

# %%
# Prior and posterior of each unknown. The vertical line is the value that made the measurements.

truth = runpy.run_path("../../studies/bandage_calibration/measure.py")["TRUTH"]
labels = {
    "tension": "tension (N/mm)",
    "exponent": "exponent (–)",
    "mu_skin": "friction on the skin (–)",
}
fig, axes = plt.subplots(1, 3, figsize=(10, 3))
for axis, (name, label) in zip(axes, labels.items(), strict=True):
    for group, style in (("prior", ":"), ("posterior", "-")):
        draws = found.draws(name, group)
        axis.hist(draws, bins=40, density=True, histtype="step", linestyle=style, label=group)
    axis.axvline(truth[name], color="0.3", linewidth=1)
    axis.set(xlabel=label, yticks=[])
axes[0].legend()
plt.show()

# %%
# Measured pressures beside what the posterior expects of new measurements, with 95 % intervals.

fig, axis = plt.subplots(figsize=(6, 4))
predictive = found.tree["posterior_predictive"]
for one, symbol in zip(found.problem.measured, ("o", "^"), strict=True):
    drawn = predictive[one.output].values
    drawn = drawn.reshape(-1, drawn.shape[-1])
    mean = drawn.mean(axis=0)
    ends = np.quantile(drawn, (0.025, 0.975), axis=0)
    axis.errorbar(
        one.values, mean, np.abs(ends - mean), fmt=symbol, linewidth=0.8, label=one.output
    )
axis.axline((40, 40), slope=1, color="0.6", linewidth=1)
axis.set(xlabel="measured (mmHg)", ylabel="expected of a new measurement (mmHg)")
axis.legend()
plt.show()
