"""Leg, bandage and contact together, brought to rest.

Start from `model.build`, which makes a `Model`; `loading.solve` finds its equilibrium.
"""
