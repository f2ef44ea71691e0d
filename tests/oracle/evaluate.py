"""Evaluates fuzzy systems by pyfuzzylite, for host-sim's test fuzzy_oracle.

In: JSON, a list of {"fll": text, "points": [[one value an input], ...]}. Out: JSON, as many of {"outputs": [[...], ...],
"rules": [[...], ...]}, a row a point; null where fuzzylite has no number. Run by `tests/oracle/install`'s interpreter.
"""

import json
import sys

import fuzzylite as fl
import numpy as np


def rows(columns, count):
    """One row a point; a rule that asks about no input still has a column as long as the others."""
    full = [np.broadcast_to(np.asarray(column, dtype=float).reshape(-1), (count,)) for column in columns]
    return [[float(x) if np.isfinite(x) else None for x in row] for row in np.stack(full, axis=1)]


def evaluate(case):
    engine = fl.FllImporter().from_string(case["fll"])
    errors = []
    if not engine.is_ready(errors):
        raise SystemExit(f"fuzzylite is not ready: {errors}\n{case['fll']}")
    points = np.asarray(case["points"], dtype=float)
    engine.input_values = points
    # Rules of degree zero and sums of nothing are 0/0, as fuzzylite means it.
    with np.errstate(all="ignore"):
        engine.process()
    rules = [rule.activation_degree for block in engine.rule_blocks for rule in block.rules]
    return {
        "outputs": rows([output.value for output in engine.output_variables], len(points)),
        "rules": rows(rules, len(points)),
    }


json.dump([evaluate(case) for case in json.load(sys.stdin)], sys.stdout)
