"""Surrogates in other languages: one module a format, from one common description.

`description.Description` holds what every format tells; its `formula` is the portable document as
arrays and factors, which C, Python and ONNX write down. Start at `formats.FORMATS`.
"""
