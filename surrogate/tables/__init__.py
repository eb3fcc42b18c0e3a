"""Tables of other people's runs and measurements: read as they are, understood or told.

Start from `table.read`, which gives a `Table` of typed `columns.Column`s.
"""
