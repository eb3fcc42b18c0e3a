"""The space of parameters: ranges, laws, units; coded and physical values meet here only.

Start from `Space` and `Parameter`.
"""

from surrogate.space.space import Parameter, Space

__all__ = ["Parameter", "Space"]
