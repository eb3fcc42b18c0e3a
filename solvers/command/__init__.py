"""Any external program as a solver: see `surrogate_solvers.command.solver.Command`."""

from .solver import Command

__all__ = ["Command"]
