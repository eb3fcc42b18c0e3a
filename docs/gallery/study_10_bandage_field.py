"""
A whole pressure field
======================

The same runs, but the output is the pressure on the whole skin, 72 × 51 places. Fields are split
into modes by proper orthogonal decomposition, and a surrogate learns the amplitude of each.
``aligned`` moves the fields along the leg first, so that the edges of turns stand still:
:doc:`/explanation/fields`.

.. code-block:: console

   $ surrogate run studies/bandage_field.yaml
"""

from dataclasses import replace

import matplotlib.pyplot as plt

from surrogate import Study

study = Study.from_yaml("../../studies/bandage_field.yaml").with_surrogates(["gp", "aligned"])
study = replace(study, outputs=("pressure_field",))
runs = study.stored()
fits = study.fit(runs)
table = study.compare(fits, runs).sel(output="pressure_field")
for name in fits:
    print(f"{name}: Q² {float(table['q2_test'].sel(surrogate=name)):.3f} on the test design")

# %%
# The pressure of one held-out run beside its predictions. By modes alone the edges of the turns,
# which move with the length of the leg and as the bandage slips, are blurred; aligned they are
# sharper.

test = runs.isel(run=(runs["design"] == "test").values).isel(run=0)
truth = test["pressure_field"]
shown = {"finite elements": truth.values} | {
    name: fits[name]["pressure_field"].predict(test["coded"].values[None])[0] for name in fits
}
fig, axes = plt.subplots(1, 3, figsize=(12, 4), sharey=True)
for axis, (title, field) in zip(axes, shown.items(), strict=True):
    image = axis.pcolormesh(
        truth["theta"], truth["height"], field.T, vmin=0, vmax=float(truth.max()), cmap="cividis"
    )
    axis.set(title=title, xlabel="angle around the leg (°)")
    axis.grid(False)
axes[0].set_ylabel("height (share of the leg)")
fig.colorbar(image, ax=axes, label="pressure (mmHg)")
plt.show()
