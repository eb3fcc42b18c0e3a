"""Portable surrogates in other languages: evaluators of the documents of a `Fit`.

`javascript/` holds ES modules without a page; `joined.script` makes one script of them, and
`packing.packed` writes a document's numbers as base64. Start at `javascript/surrogate.js`.
"""
