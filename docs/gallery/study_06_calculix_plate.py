"""
A finite element program of industry: CalculiX
==============================================

A plate with a hole under tension. A script makes the mesh, CalculiX solves it, patterns find the
largest stress. The runs ship, so that this page needs no CalculiX.

.. code-block:: console

   $ surrogate run studies/calculix_plate.yaml
"""

import matplotlib.pyplot as plt

from surrogate import Study

study = Study.from_yaml("../../studies/calculix_plate.yaml")
runs = study.stored()

# %%
# Handbooks give the largest stress over the mean stress far from the hole, as a function of the
# hole's share of the width (Howland 1930, doi 10.1098/rsta.1930.0002). The program knows nothing
# of it. Its runs lie on the curve, at most 1 % above it: these plates are solids with a thickness.

share = runs["diameter"] / runs["width"]
mean = runs["force"] / (runs["width"] * runs["thickness"])
fig, axis = plt.subplots(figsize=(6, 3.6))
axis.plot(share, runs["peak_stress"] / mean, "o", markersize=4, label="CalculiX, 84 runs")
axis.plot([0.1, 0.2, 0.3, 0.4, 0.5], [3.03, 3.14, 3.36, 3.74, 4.32], label="Howland")
axis.set(xlabel="diameter over width", ylabel="stress concentration")
axis.legend()
plt.show()

# %%
# Which inputs decide the stress, and which may be frozen?

fits = study.fit(runs)
table = study.compare(fits, runs)
indices = study.sensitivity(fits, runs, table)
print("\n".join(study.screening(fits, table, indices).sentences))
