"""The evidence of credibility of a study, under the headings of ASME V&V 40 (2018).

Start from `Dossier`. Each other module makes the chapters of one question from what is `Known`.
"""

from surrogate.report.dossier.dossier import Dossier
from surrogate.report.dossier.known import Known

__all__ = ["Dossier", "Known"]
