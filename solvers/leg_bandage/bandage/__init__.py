"""The bandage: its fabric, its shell, and the products that are sold.

Start from `fabric.Fabric` (energy and tension); `shell.Shell` is its finite element.
"""
