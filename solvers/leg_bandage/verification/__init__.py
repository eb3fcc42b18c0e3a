"""Boundary value problems with known answers, for the tests and the benchmarks."""
