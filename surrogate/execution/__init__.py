"""Design points x solver, through local processes or any executor, into the journal."""

from surrogate.execution.execute import Progress, cores, execute

__all__ = ["Progress", "cores", "execute"]
