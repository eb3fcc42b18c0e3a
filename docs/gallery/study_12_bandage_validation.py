"""
Reduced models on legs that nobody has seen
===========================================

Surrogates of the bandage know a leg by its length and four shape coordinates. Here they, and
Laplace's law, are set beside finite elements on the own sections of the 38 legs.

.. code-block:: console

   $ surrogate run studies/bandage_validation.yaml
"""

import matplotlib.pyplot as plt

from surrogate import Study

study = Study.from_yaml("../../studies/bandage_validation.yaml")
fits = study.fit(study.stored())
cases = Study.from_yaml("../../studies/bandage_patients.yaml").stored()
found = study.validate(fits, cases).sel(output="pressure_b1")
inside = found["inside"].values
print(f"{(~inside).sum()} of {len(inside)} cases lie outside of the ranges and are set aside")

# %%
# Differences over means, with the limits of agreement of Bland and Altman (1986): 95 % of the
# differences lie between the dashed lines.

fig, axes = plt.subplots(1, 3, figsize=(10, 3.5), sharex=True, sharey=True)
for axis, name in zip(axes, found["model"].values, strict=True):
    truth = found["reference"].values[inside]
    value = found["prediction"].sel(model=name).values[inside]
    difference = value - truth
    centre, half = difference.mean(), 1.96 * difference.std(ddof=1)
    axis.plot((value + truth) / 2, difference, "o", markersize=4)
    for height, style in ((centre, "-"), (centre - half, "--"), (centre + half, "--")):
        axis.axhline(height, color="0.3", linestyle=style, linewidth=1)
    axis.set(title=str(name), xlabel="mean of both (mmHg)")
axes[0].set_ylabel("model minus finite elements (mmHg)")
plt.show()
