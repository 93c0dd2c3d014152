"""Computes the intervals of interval type-2 rule sets with fractions, to 40 digits, and compares them.

python type2_peer.py FOLDER: each NAME.json has the rule sets of pyit2fls_type2_peer.py. Only Python's own library is used.
"""

import json
import pathlib
import sys
from fractions import Fraction
from itertools import combinations

LARGEST = Fraction(1, 10**14)  # of the range
LOW, HIGH = Fraction(0), Fraction(10)


def degree(triangle, x):
    left, peak, right, height = triangle
    if not left < x < right:
        return Fraction(0)
    return height * min((x - left) / (peak - left), (right - x) / (right - peak))


def implied(triangle, strength, is_product):
    """The term at a firing strength: its degree at a value, and the values where it has a kink."""
    left, peak, right, height = triangle
    if is_product:
        return lambda x: strength * degree(triangle, x), [left, peak, right]
    part = min(strength / height, Fraction(1))
    kinks = [left, left + part * (peak - left), right - part * (right - peak), right]
    return lambda x: min(strength, degree(triangle, x)), kinks


def aggregated(functions):
    """The maximum as a list of points between which it is straight."""
    places = {LOW, HIGH}
    for _, kinks in functions:
        places.update(x for x in kinks if LOW < x < HIGH)
    ordered = sorted(places)
    for a, b in zip(ordered, ordered[1:]):
        for (f, _), (g, _) in combinations(functions, 2):
            before, after = f(a) - g(a), f(b) - g(b)
            if before * after < 0:
                places.add(a + (b - a) * before / (before - after))
    return [(x, max(f(x) for f, _ in functions)) for x in sorted(places)]


def moment(points, c, low, high):
    """The integral of (x - c) over a part of a set. Simpson's rule is exact for parabolas."""
    sum_ = Fraction(0)
    for (a, left), (b, right) in zip(points, points[1:]):
        start, end = max(a, low), min(b, high)
        if start < end:
            value = lambda x: (x - c) * (left + (right - left) * (x - a) / (b - a))
            sum_ += (end - start) / 6 * (value(start) + 4 * value((start + end) / 2) + value(end))
    return sum_


def ends(lower, upper):
    for below, above in ((upper, lower), (lower, upper)):
        a, b = LOW, HIGH
        while b - a > Fraction(1, 10**40):
            c = (a + b) / 2
            if moment(below, c, LOW, c) + moment(above, c, c, HIGH) > 0:
                a = c
            else:
                b = c
        yield a


def fraction(values):
    return [Fraction(value) for value in values]


worst, count = Fraction(0), 0
for path in sorted(pathlib.Path(sys.argv[1]).glob("*.json")):
    system = json.loads(path.read_text())
    norm = (lambda a, b: a * b) if system["product"] else min
    for point in system["points"]:
        a_value, b_value, *ours = fraction(point)
        sets = []
        for side in (1, 0):  # the lower one, then the upper one
            terms = {key: [fraction(term[side]) for term in system[key]] for key in ("a", "b", "y")}
            strengths = [Fraction(0)] * len(terms["y"])
            for a, b, y in system["rules"]:
                strength = norm(degree(terms["a"][a], a_value), degree(terms["b"][b], b_value))
                strengths[y] = max(strengths[y], strength)
            fired = zip(terms["y"], strengths)
            sets.append(aggregated([implied(*one, system["product"]) for one in fired]))
        for theirs, end in zip(ends(*sets), ours):
            worst, count = max(worst, abs(theirs - end) / (HIGH - LOW)), count + 1
print(f"{count} ends of intervals, at most {float(worst):.2g} of the range from the exact ones")
sys.exit(0 if count and worst <= LARGEST else 1)
