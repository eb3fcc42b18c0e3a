"""
A finite element program of industry: CalculiX
==============================================

A plate with a hole under tension. A script makes the mesh, CalculiX solves it, patterns find the
largest stress. The runs ship, so that this page needs no CalculiX.

.. code-block:: console

   $ surrogate run studies/calculix_plate.yaml
"""

import matplotlib.pyplot as plt
import numpy as np

from surrogate import Study

study = Study.from_yaml("../../studies/calculix_plate.yaml")
runs = study.stored()

# %%
# Handbooks give the stress concentration, largest stress over the mean stress of the net section,
# as a function of the hole's share of the width (Heywood's fit of Howland's values). The program
# knows nothing of it; its runs lie on the curve.

share = runs["diameter"] / runs["width"]
net = runs["force"] / ((runs["width"] - runs["diameter"]) * runs["thickness"])
line = np.linspace(share.min().item(), share.max().item(), 50)
fig, axis = plt.subplots(figsize=(6, 3.6))
axis.plot(share, runs["peak_stress"] / net, "o", markersize=4, label="CalculiX, 84 runs")
axis.plot(line, 2 + (1 - line) ** 3, label="2 + (1 - d/w)³")
axis.set(xlabel="diameter over width", ylabel="stress concentration (net)")
axis.legend()
plt.show()

# %%
# Which inputs decide the stress, and which may be frozen?

fits = study.fit(runs)
table = study.compare(fits, runs)
indices = study.sensitivity(fits, runs, table)
print("\n".join(study.screening(fits, table, indices).sentences))
