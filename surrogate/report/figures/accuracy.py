"""Q2 of the surrogates beside one another."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

from surrogate.report import digits
from surrogate.report.drawing import (
    WIDTH,
    Scale,
    drawing,
    label_room,
    line,
    mark,
    shortened,
    text,
)

ROW = 24.0
LOWEST = 0.0


def accuracy_plot(names, q2_cv, q2_test, output: str) -> Markup:
    """A row a surrogate: cross-validated Q2 hollow, held-out Q2 filled.

    Values below the scale stand at its left end as an arrow's worth of text.
    """
    left = label_room(names, 120.0)
    both = np.concatenate([np.asarray(q2_cv, float), np.asarray(q2_test, float)])
    finite = both[np.isfinite(both)]
    lowest = max(LOWEST, min(0.9, float(finite.min()) - 0.02)) if finite.size else LOWEST
    x = Scale(lowest, 1.0, left, WIDTH - 16)
    top = 12.0
    floor = top + ROW * len(names)
    marks = [line(x(v), top, x(v), floor, "grid") for v in x.ticks(4)]
    marks += [text(x(v), floor + 14, words, "tick", "middle")
              for v, words in zip(x.ticks(4), x.tick_words(4), strict=True)]
    for k, name in enumerate(names):
        y = top + ROW * (k + 0.5)
        marks.append(text(left - 8, y + 4, shortened(name, left - 8), "name", "end"))
        for kind, value, how in (("hollow", q2_cv[k], "cross-validated"),
                                 ("filled", q2_test[k], "held-out runs")):
            if not np.isfinite(value):
                continue
            tip = f"{name}\nQ² {how}: {digits.score(value)}"
            if value < lowest:
                words = f"‹ {digits.figure(value)} ({how.split()[0]})"
                shift = 4 if kind == "hollow" else 110
                marks.append(text(left + shift, y + 4, words, "small"))
            else:
                marks.append(mark(kind, x(value), y, 4.2, data_tip=tip))
    marks.append(text((left + WIDTH) / 2, floor + 31, "Q² (–), 1 is perfect", "label", "middle"))
    return drawing(WIDTH, floor + 40, *marks, says=f"Q2 of {len(names)} surrogates for {output}")
