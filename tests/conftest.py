"""One thread for linear algebra in tests and in what they start.

Their matrices are small: threads wait for each other, and the processes of pytest-xdist take all
cores already. Two threads a process cost ten times the processor time on two busy cores. What the
environment says comes first.
"""

import os

for name in (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
):
    os.environ.setdefault(name, "1")
