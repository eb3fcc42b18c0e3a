"""
Operator, leg or fabric: whose doing is the scatter?
====================================================

Twelve parameters in three groups. Shapley effects sum to one, so those of a group add up to the
group's share of the variance, with an interval of its own.

.. code-block:: console

   $ surrogate run studies/bandage_variability.yaml
"""

import matplotlib.pyplot as plt
import numpy as np

from surrogate import Study

study = Study.from_yaml("../../studies/bandage_variability.yaml")
runs = study.stored()
fits = study.fit(runs)
table = study.compare(fits, runs)
indices = study.sensitivity(fits, runs, table).sel(output="pressure_b1")

fig, axes = plt.subplots(1, 2, figsize=(10, 4), width_ratios=[1, 2])
for axis, name, dimension in (
    (axes[0], "group_shapley", "group"),
    (axes[1], "shapley", "parameter"),
):
    order = np.argsort(-indices[name].values)
    low, value, high = (indices[name + end].values[order] for end in ("_low", "", "_high"))
    axis.barh(np.arange(len(order)), value, xerr=[value - low, high - value])
    axis.set_yticks(np.arange(len(order)), indices[dimension].values[order])
    axis.set_xlabel("share of the variance")
    axis.invert_yaxis()
plt.show()

# %%
# Ranges of the operator are assumed, not measured; the comments of the study say which.
