"""
How much time does a coarse mesh save?
======================================

24 runs at a medium mesh, and 152 at a coarse one, which takes a fifth of the time. Co-kriging
learns from both; a Gaussian process from the medium runs alone.

.. code-block:: console

   $ surrogate run studies/bandage_fidelity.yaml
"""

import matplotlib.pyplot as plt

from surrogate import Study
from surrogate.runs.dataset import at_level
from surrogate.runs.levels import cost_sentences

study = Study.from_yaml("../../studies/bandage_fidelity.yaml")
runs = study.stored()
print("\n".join(cost_sentences(runs)))

# %%
# Predictions of held-out medium runs.

fits = study.fit(runs)
held_out = at_level(runs).query(run="design == 'test'")
fig, axis = plt.subplots(figsize=(5, 4))
for name, symbol in (("cokriging", "o"), ("gp", "^")):
    predicted = fits[name]["pressure_b1"].predict(held_out["coded"].values)
    axis.plot(held_out["pressure_b1"], predicted, symbol, label=name)
axis.axline((30, 30), slope=1, color="0.6", linewidth=1)
axis.set(xlabel="medium mesh (mmHg)", ylabel="surrogate (mmHg)")
axis.legend()
plt.show()

# %%
# The accuracy of both.

table = study.compare(fits, runs)
print(table[["rmse_test", "q2_test"]].to_dataframe().round(4).to_string())
