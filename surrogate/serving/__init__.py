"""A model offered to other programs over HTTP, by the UM-Bridge protocol, version 1.0.

Start from `protocol.Model` (what is served) and `server.serve`. Protocol: Seelinger et al.
2023, J. Open Source Software 8(83), 4748, doi 10.21105/joss.04748.
"""
