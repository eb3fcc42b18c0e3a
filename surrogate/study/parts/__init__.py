"""The parts of a study file: which keys each has, what they mean, what kind of value each takes.

Description and example of a key go into the JSON Schema, from which editors complete and the
documentation is made. Whether names exist, units convert and ranges hold is decided in
`surrogate.study.reading`, where names become objects. Start from `study.StudyPart`.
"""
