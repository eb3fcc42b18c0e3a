"""
Do the simplifications of the model matter?
===========================================

Wrapping turn by turn on the leg as it deforms, against wrapping on the undeformed leg; a curved
tension law, against the secant: both named as limits by Chassagne et al. 2018. Choices of a model
are parameters with levels, in every combination.

.. code-block:: console

   $ surrogate run studies/bandage_modelling.yaml
"""

import matplotlib.pyplot as plt

from surrogate import Study

study = Study.from_yaml("../../studies/bandage_modelling.yaml")
runs = study.stored()
fig, axis = plt.subplots(figsize=(6.5, 3.6))
for wrapping in ("prescribed", "progressive"):
    for law, symbol in (("secant", "o"), ("curved", "^")):
        chosen = (runs["wrapping"] == wrapping) & (runs["tension_law"] == law)
        some = runs.isel(run=chosen.values).sortby("mu_skin")
        axis.plot(some["mu_skin"], some["pressure_b1"], marker=symbol, label=f"{wrapping}, {law}")
axis.set(xlabel="friction on the skin (–)", ylabel="pressure at B1 (mmHg)")
axis.legend()
plt.show()

# %%
# The effect of a level is half of the change, in mmHg, and it hangs on the friction.

table = study.regressions(study.fit(runs))["quadratic"]["pressure_b1"]
print(table[["low", "coefficient", "high"]].to_dataframe().round(2).to_string())
