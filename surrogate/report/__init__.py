"""The report: datasets in, one self-contained HTML page out."""

from surrogate.report.content import Content
from surrogate.report.page import Page, build

__all__ = ["Content", "Page", "build"]
