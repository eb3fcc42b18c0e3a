"""What a scan can be wrong in, as one exception; every message ends with the cure."""

from __future__ import annotations

from surrogate.errors import SurrogateError


class ScanError(SurrogateError):
    """A file that cannot be read as a scan of a lower leg, or an option that does not fit it."""
