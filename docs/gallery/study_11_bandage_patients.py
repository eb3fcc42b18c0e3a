"""
Thirty-eight legs under two bandages
====================================

Legs that are not in the shape basis, each solved with its own sections: the cases by which reduced
models are judged on the next page. Parameters are names here, and the design is a full factorial.

.. code-block:: console

   $ surrogate run studies/bandage_patients.yaml
"""

import matplotlib.pyplot as plt

from surrogate import Study

study = Study.from_yaml("../../studies/bandage_patients.yaml")
runs = study.stored()
fig, axis = plt.subplots(figsize=(6, 3.8))
for name, symbol in (("biflex_16", "o"), ("biflex_17", "^")):
    some = runs.isel(run=(runs["bandage"] == name).values)
    axis.plot(some["pressure_laplace"], some["pressure_b1"], symbol, label=name)
axis.axline((25, 25), slope=1, color="0.6", linewidth=1)
axis.set(xlabel="Laplace's law (mmHg)", ylabel="finite elements (mmHg)")
axis.legend()
plt.show()

# %%
# Laplace's law takes the curvature of the leg under the sensor. With that it is close to the finite
# elements: shape decides more than what the law leaves out.
