"""
Which stretch and overlap give 40 mmHg?
=======================================

The pressure at B1 of the mean leg is to lie between 35 and 45 mmHg, whatever friction, fabric and
place of the sensor are. Stretch and overlap are free. The finite element model is run at the
answers.

.. code-block:: console

   $ surrogate run studies/bandage_target.yaml
"""

import matplotlib.pyplot as plt
import numpy as np

from surrogate import Study
from surrogate.solving.merit import Merit
from surrogate.solving.outlook import Outlook
from surrogate.stages.candidates import candidates, fits_for

study = Study.from_yaml("../../studies/bandage_target.yaml")
runs = study.stored()
fits = study.fit(runs)
table = study.compare(fits, runs)
goal = study.problems["known_leg"]
chosen = fits_for(goal, fits, table)
found = candidates(goal, study.space, False, chosen)
print(found.goal)
for one in found.candidates:
    at = ", ".join(f"{name} {value:.3f}" for name, value in one.inputs.items())
    print(f"{at}: probability {one.probability:.2f}")

# %%
# The probability of each stretch and overlap, by the Gaussian process: its own error and the four
# uncertain inputs are drawn.

space = study.space
free, uncertain = (
    [space.names.index(name) for name in some] for some in (goal.free, goal.uncertain)
)
grid = np.linspace(-1, 1, 25)
points = np.zeros((grid.size**2, space.size))  # the mean leg: its parameters are in the middle
points[:, free] = np.stack(np.meshgrid(grid, grid, indexing="ij"), axis=-1).reshape(-1, 2)
outlook = Outlook(space, chosen, tuple(uncertain), inputs=1024, errors=4, seed=0)
probability = Merit(goal, outlook).judge(points).probability.reshape(grid.size, grid.size)

fig, axis = plt.subplots(figsize=(6, 4))
axes_values = [space[name].decode(grid) for name in goal.free]
filled = axis.contourf(*axes_values, probability.T, levels=np.linspace(0, 1, 11), cmap="Greys")
fig.colorbar(filled, label="probability of 35 to 45 mmHg")
axis.plot(*([one.inputs[name] for one in found.candidates] for name in goal.free), "o")
axis.set(xlabel="stretch (–)", ylabel="overlap (–)")
plt.show()

# %%
# The finite element model at an answer, friction, fabric and place of the sensor drawn 20 times.

stored = study.stored_runs[0].runs
checked = stored.isel(run=stored["design"].values == "verified_known_leg")
values = np.sort(checked["pressure_b1"].values)
fig, axis = plt.subplots(figsize=(6, 2.6))
axis.axvspan(35, 45, color="0.9")
axis.plot(values, (np.arange(values.size) + 0.5) / values.size, "o")
axis.set(xlabel="pressure at B1, finite elements (mmHg)", ylabel="share of the runs")
plt.show()
at = ", ".join(f"{name} {checked[name].values[0]:.3f}" for name in goal.free)
print(f"{at}: {((values >= 35) & (values <= 45)).sum()} of {values.size} runs meet the goal")
