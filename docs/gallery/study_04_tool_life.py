"""
A table in place of a solver
============================

Fifty-two turning tests from a workshop (made up): the life of a tool by speed, feed, depth and
coating. Nothing is simulated. Some tests are replicates; feed and depth go together, because
operators take less depth at more feed.

.. code-block:: console

   $ surrogate run studies/tool_life.yaml

How to bring a table of your own: :doc:`/how_to/table`.
"""

import matplotlib.pyplot as plt
import numpy as np

from surrogate import Study

study = Study.from_yaml("../../studies/tool_life.yaml")
runs = study.stored()
fig, axis = plt.subplots(figsize=(5.5, 3.6))
points = axis.scatter(runs["feed"], runs["depth"], c=runs["life"], cmap="viridis")
axis.set(xlabel="feed (mm)", ylabel="depth (mm)")
fig.colorbar(points, label="life (min)")
plt.show()

# %%
# The upper right corner is empty: no surrogate knows what happens there, and predictions there
# are marked. Inputs are dependent, so the study takes Shapley effects, which sum to 1.

fits = study.fit(runs)
table = study.compare(fits, runs)
indices = study.sensitivity(fits, runs, table).sel(output="life")
place = np.arange(indices.sizes["parameter"])
fig, axis = plt.subplots(figsize=(6.5, 3.2))
for shift, name, label in (
    (-0.1, "shapley", "Shapley effect"),
    (0.1, "independent_total", "what it alone brings"),
):
    low, value, high = (indices[name + end].values for end in ("_low", "", "_high"))
    spread = [value - low, high - value]
    axis.errorbar(place + shift, value, spread, fmt="o", capsize=4, label=label)
axis.set_xticks(place, indices["parameter"].values)
axis.set(ylabel="share of the variance", ylim=(0, None))
axis.legend()
plt.show()
