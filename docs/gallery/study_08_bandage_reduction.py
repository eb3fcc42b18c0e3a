"""
Which coefficients survive more runs?
=====================================

Nine runs find eight coefficients only by mixing each with three two-factor interactions. Eight
more runs with all signs reversed part main effects from them; 24 that fill the space let each
interaction be seen.

.. code-block:: console

   $ surrogate run studies/bandage_reduction.yaml

How to read which effects are mixed: :doc:`/how_to/alias_table`.
"""

import matplotlib.pyplot as plt
import numpy as np

from surrogate import Study

study = Study.from_yaml("../../studies/bandage_reduction.yaml")
runs = study.stored()
print(dict(study.aliases["train"].table)["mu_skin"], "share the column of mu_skin in nine runs")

# %%
# Coefficients of the pressure at B1 with 95 % confidence intervals. The solver is deterministic, so
# intervals show lack of fit and no noise, and know nothing of aliases: that of friction from nine
# runs is narrow and wrong.

tables = study.regressions(study.fit(runs))
names = list(study.space.names)
fig, axis = plt.subplots(figsize=(8.5, 3.8))
shown = (
    ("linear", "9 runs", "o"),
    ("linear_folded", "17 runs, folded over", "^"),
    ("interactions", "41 runs", "s"),
)
for k, (name, label, symbol) in enumerate(shown):
    rows = tables[name]["pressure_b1"].sel(term=names)
    value, half = rows["coefficient"], (rows["high"] - rows["low"]) / 2
    place = np.arange(len(names)) + 0.2 * (k - 1)
    axis.errorbar(place, value, half, fmt=symbol, capsize=4, label=label)
axis.axhline(0, color="0.4", linewidth=1)
axis.set_xticks(range(len(names)), names)
axis.set_ylabel("coefficient (mmHg per half range)")
axis.legend()
plt.show()
