"""Contact with friction between two surfaces, skin and turn or turn and turn.

Start from `point_to_surface.Contact`; `law.ContactLaw` has the tractions.
"""
