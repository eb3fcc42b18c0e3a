"""
An external program
===================

A cooling fin that loses heat by convection and radiation, solved by an awk script that stands for
your program: its input file is a template, its answers are read from what it prints and from a
CSV file. Nothing of it is Python.

.. code-block:: console

   $ surrogate run studies/external_program.yaml

How to bring a program of your own: :doc:`/how_to/program`.
"""

from pathlib import Path
from tempfile import mkdtemp

import matplotlib.pyplot as plt
import numpy as np

from surrogate import Study

study = Study.from_yaml("../../studies/external_program.yaml")
runs = study.run(results=Path(mkdtemp()))
fits = study.fit(runs)
table = study.compare(fits, runs)
print("\n".join(table["sentence"].values))

# %%
# What decides the heat, and what the temperature of the tip? First-order and total indices; the
# difference is what a parameter does together with others.

indices = study.sensitivity(fits, runs, table)
names = indices["parameter"].values
fig, axes = plt.subplots(1, 2, figsize=(9.5, 3.4), sharey=True)
for axis, output in zip(axes, study.outputs, strict=True):
    of_output = indices.sel(output=output)
    for shift, name in ((-0.17, "first_order"), (0.17, "total")):
        low, value, high = (of_output[name + end].values for end in ("_low", "", "_high"))
        axis.barh(
            np.arange(len(names)) + shift,
            value,
            0.32,
            xerr=[value - low, high - value],
            label=name.replace("_", " "),
        )
    axis.set(title=output, xlabel="share of the variance")
axes[0].set_yticks(np.arange(len(names)), names)
axes[0].invert_yaxis()
axes[1].legend()
plt.show()
