"""
Which parameters may be frozen?
===============================

The screening step of Chassagne et al. 2018 on a finite element contact model of a bandage: four
parameters on the mean leg. The paper moved one at a time and kept what explains 93 % of the
change. Here Sobol' indices with intervals stand beside that rule, and decide.

.. code-block:: console

   $ surrogate run studies/bandage_screening.yaml
"""

import matplotlib.pyplot as plt
import numpy as np

from surrogate import Study

study = Study.from_yaml("../../studies/bandage_screening.yaml")
runs = study.stored()
fits = study.fit(runs)
table = study.compare(fits, runs)
indices = study.sensitivity(fits, runs, table)
screening = study.screening(fits, table, indices)
print("\n".join(screening.sentences))

# %%
# Shares of one-at-a-time effects overrate small parameters: friction has 11 % of the effects and
# 2 % of the variance.

of_b1 = indices.sel(output="pressure_b1")
low, total, high = (of_b1[name].values for name in ("total_low", "total", "total_high"))
place = np.arange(len(total))
fig, axis = plt.subplots(figsize=(6.5, 3.4))
axis.errorbar(place, total, [total - low, high - total], fmt="o", capsize=5, label="total index")
old = [verdict.one_at_a_time for verdict in screening.verdicts]
axis.plot(place, old, "s", mfc="none", label="share of one-at-a-time effects")
axis.axhline(0.02, color="0.4", linewidth=1)
axis.annotate("freeze below 0.02", (2.5, 0.023), color="0.3")
axis.set_xticks(place, of_b1["parameter"].values)
axis.set(yscale="log", ylabel="share", ylim=(1e-3, 2))
axis.legend(loc="upper left")
plt.show()
