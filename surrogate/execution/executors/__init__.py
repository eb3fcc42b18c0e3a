"""Executors: where runs are carried out, one a file, behind `surrogate.execution.backend`.

Each is a function (settings, *, its options) that gives a `Backend`; a study names it under
`execution: {executor: ...}` by its entry point (group `surrogate.executors`).
"""
