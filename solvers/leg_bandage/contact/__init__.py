"""Contact with friction between two surfaces, skin and turn or turn and turn.

Start from `contact.Contact`; `friction.ContactLaw` has the tractions.
"""
