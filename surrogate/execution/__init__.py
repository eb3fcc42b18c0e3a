"""Design points x solver, through local processes or any executor, into the journal.

Start from `execute.execute`; `workers` is what runs in a worker process.
"""
