"""Evaluates interval type-2 rule sets with PyIT2FLS, with more and more samples, and compares the intervals.

python pyit2fls_type2_peer.py FOLDER: each NAME.json has the membership functions of two inputs and an output as triangles
[left, peak, right, height], rules as pairs of terms and a term, and points with the ends of their intervals. The error of
PyIT2FLS must shrink with the distance of its samples.
"""

import json
import pathlib
import sys

from numpy import linspace
from pyit2fls import IT2FS, IT2Mamdani, max_s_norm, min_t_norm, product_t_norm, tri_mf

SAMPLES = [101, 1001, 10001, 100001]
LARGEST = 2.0  # times the distance of two samples, as a share of the range


def errors(path, samples):
    system = json.loads(path.read_text())
    domain = linspace(0.0, 10.0, samples)
    of_bounds = lambda upper, lower: IT2FS(domain, tri_mf, upper, tri_mf, lower)
    terms = {key: [of_bounds(*term) for term in system[key]] for key in ("a", "b", "y")}
    norm = product_t_norm if system["product"] else min_t_norm
    mamdani = IT2Mamdani(norm, max_s_norm, method="Centroid", algorithm="EIASC")
    mamdani.add_input_variable("a")
    mamdani.add_input_variable("b")
    mamdani.add_output_variable("y")
    for a, b, y in system["rules"]:
        mamdani.add_rule([("a", terms["a"][a]), ("b", terms["b"][b])], [("y", terms["y"][y])])
    for a, b, low, high in system["points"]:
        _, reduced = mamdani.evaluate({"a": a, "b": b})
        for theirs, ours in zip(reduced["y"], (low, high)):
            yield abs(theirs - ours) / 10.0


paths = sorted(pathlib.Path(sys.argv[1]).glob("*.json"))
wrong = 0
for samples in SAMPLES:
    worst = max(error for path in paths for error in errors(path, samples))
    wrong += worst > LARGEST / (samples - 1)
    print(f"{samples} samples: at most {worst:.2g} of the range from the exact interval")
print(f"{len(paths)} rule sets, {wrong} numbers of samples with other intervals")
sys.exit(1 if wrong or not paths else 0)
