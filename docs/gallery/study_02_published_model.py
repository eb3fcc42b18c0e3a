"""
Nine runs of a known linear model
=================================

The published reduced model of Chassagne et al. 2018 stands in for the solver. Their nine-run
design must give back the coefficients of their Table III, and the Sobol' indices of a linear
model are :math:`\\beta_i^2 / \\sum \\beta^2`. A check of the whole way.

.. code-block:: console

   $ surrogate run studies/published_model.yaml
"""

from pathlib import Path
from tempfile import mkdtemp

import matplotlib.pyplot as plt

from surrogate import Study

study = Study.from_yaml("../../studies/published_model.yaml")
runs = study.run(results=Path(mkdtemp()), workers=1)
fits = study.fit(runs)
table = study.regressions(fits)["linear"]["pressure_b1"]
print(table["coefficient"].to_series().round(3).to_string())

# %%
# What a parameter explains grows with the square of its coefficient: the shares of two parameters
# with coefficients 11.5 and 2.7 are as 18 to 1.

indices = study.sensitivity(fits, runs).sel(output="pressure_b1")
size = abs(table["coefficient"].to_series().drop("1"))
fig, axes = plt.subplots(1, 2, figsize=(9, 3.2), sharey=True)
axes[0].barh(size.index, size)
axes[0].set_xlabel("|coefficient| (mmHg per half range)")
axes[1].barh(size.index, indices["total"].sel(parameter=size.index), color="#e07a1f")
axes[1].set_xlabel("total index (share of the variance)")
axes[0].invert_yaxis()
plt.show()
