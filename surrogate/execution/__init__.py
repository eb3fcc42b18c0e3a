"""Design points x solver, through local processes or any executor, into the journal."""

from surrogate.execution.execute import Progress, cores, execute
from surrogate.execution.fresh import execute_fresh, interrupted

__all__ = ["Progress", "cores", "execute", "execute_fresh", "interrupted"]
