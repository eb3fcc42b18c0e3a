"""A compression bandage on a lower leg: geometry, mechanics, contact."""
