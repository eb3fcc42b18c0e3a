"""
Which surrogate to believe
==========================

Ishigami's function has indices that are known by hand: total indices 0.558, 0.442 and 0.244.
Five surrogates learn from the same 128 runs. Those that predict held-out runs well find the
indices; the linear and the quadratic model do not, and their Q² on the test design says so.

.. code-block:: console

   $ surrogate run studies/ishigami.yaml
"""

from pathlib import Path
from tempfile import mkdtemp

import matplotlib.pyplot as plt
import numpy as np

from surrogate import Study

study = Study.from_yaml("../../studies/ishigami.yaml")
runs = study.run(results=Path(mkdtemp()), workers=1)
fits = study.fit(runs)
table = study.compare(fits, runs)

# %%
# Predicted against simulated, on the 50 runs of the test design.

test = runs.isel(run=(runs["design"] == "test").values)
fig, axes = plt.subplots(1, 4, figsize=(10, 3), sharex=True, sharey=True)
for axis, name in zip(axes, ["linear", "quadratic", "forest", "gp"], strict=True):
    axis.axline((0, 0), slope=1, color="0.6", linewidth=1)
    axis.plot(test["y"], fits[name]["y"].predict(test["coded"]), "o", markersize=3)
    axis.set(title=f"{name}: Q² {float(table['q2_test'].sel(surrogate=name, output='y')):.3f}")
    axis.set_xlabel("simulated")
axes[0].set_ylabel("predicted")
plt.show()

# %%
# Total indices from the best surrogate, with their 95 % intervals, beside the true ones.

indices = study.sensitivity(fits, runs, table).sel(output="y")
place = np.arange(3)
low, total, high = (indices[name].values for name in ("total_low", "total", "total_high"))
fig, axis = plt.subplots(figsize=(6, 3))
axis.errorbar(place, total, [total - low, high - total], fmt="o", capsize=5, label="surrogate")
axis.plot(place, [0.5576, 0.4424, 0.2437], "x", markersize=10, label="true")
axis.set_xticks(place, indices["parameter"].values)
axis.set(ylabel="total index (share of the variance)", ylim=(0, None))
axis.legend()
plt.show()
