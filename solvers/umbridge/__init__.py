"""A model behind a UM-Bridge server as a solver: see `solver.UMBridge`.

`client` speaks the protocol, version 1.0 (Seelinger et al. 2023, J. Open Source Software
8(83), 4748, doi 10.21105/joss.04748).
"""
