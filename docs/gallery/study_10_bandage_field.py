"""
A whole pressure field
======================

The same runs, but the output is the pressure on the whole skin, 72 × 51 places. Fields are split
into modes by proper orthogonal decomposition, and a surrogate learns the amplitude of each:
:doc:`/explanation/fields`.

.. code-block:: console

   $ surrogate run studies/bandage_field.yaml
"""

from dataclasses import replace

import matplotlib.pyplot as plt

from surrogate import Study

study = Study.from_yaml("../../studies/bandage_field.yaml").with_surrogates(["gp"])
study = replace(study, outputs=("pressure_field",))
runs = study.stored()
fits = study.fit(runs)
table = study.compare(fits, runs).sel(surrogate="gp", output="pressure_field")
print(f"{int(table['modes'])} modes, Q² {float(table['q2_test']):.3f} on the test design")

# %%
# The pressure of one held-out run beside its prediction. The surrogate meets the level and blurs
# the edges of the turns, which move with the shape of the leg.

test = runs.isel(run=(runs["design"] == "test").values).isel(run=0)
predicted = fits["gp"]["pressure_field"].predict(test["coded"].values[None])[0]
truth = test["pressure_field"]
fig, axes = plt.subplots(1, 2, figsize=(9, 4), sharey=True)
for axis, field, title in ((axes[0], truth.values, "finite elements"), (axes[1], predicted, "gp")):
    image = axis.pcolormesh(
        truth["theta"], truth["height"], field.T, vmin=0, vmax=float(truth.max()), cmap="cividis"
    )
    axis.set(title=title, xlabel="angle around the leg (°)")
    axis.grid(False)
axes[0].set_ylabel("height (share of the leg)")
fig.colorbar(image, ax=axes, label="pressure (mmHg)")
plt.show()
