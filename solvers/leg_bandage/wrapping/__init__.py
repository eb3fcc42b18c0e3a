"""Where each turn of the bandage goes, before anything deforms.

Start from `spiral.Wrap` (how it is wrapped); `lay.lay` puts the strip on a surface.
"""
