"""
Nine runs and a plane, against sixty
====================================

The pressure under a compression bandage by Laplace's law, over friction, tension, length and
shape of the leg. The study sets the seven-parameter method of Chassagne et al. 2018, nine runs
and a linear model, against a design that fills the space and against better surrogates.

.. code-block:: console

   $ surrogate run studies/bandage_laplace.yaml
"""

from pathlib import Path
from tempfile import mkdtemp

import matplotlib.pyplot as plt

from surrogate import Study

study = Study.from_yaml("../../studies/bandage_laplace.yaml")
runs = study.run(results=Path(mkdtemp()))
fits = study.fit(runs)
table = study.compare(fits, runs)

# %%
# Errors on the 30 held-out runs. The linear model of nine runs fits its own runs almost exactly.

test = runs.isel(run=(runs["design"] == "test").values)
truth = test["pressure_b1"].values
fig, axis = plt.subplots()
for k, name in enumerate(fits):
    error = fits[name]["pressure_b1"].predict(test["coded"].values) - truth
    axis.plot([k] * len(error), error, "o", alpha=0.5)
    axis.annotate(f"RMSE {(error**2).mean() ** 0.5:.2f}", (k, 6.3), ha="center")
axis.axhline(0, color="0.4", linewidth=1)
axis.set_xticks(range(len(fits)), list(fits))
axis.set(ylabel="predicted minus simulated (mmHg)", ylim=(-7, 7))
plt.show()

# %%
# By Laplace's law friction plays no part, and its index is zero.

indices = study.sensitivity(fits, runs, table)
for sentence in study.screening(fits, table, indices).sentences:
    print(sentence)
