"""Any external program as a solver: see `solvers.command.solver.Command`."""

from solvers.command.solver import Command

__all__ = ["Command"]
