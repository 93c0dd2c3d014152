"""A second implementation of rule sets, from the formulas of docs/rule-sets.md, with numbers of 80 digits.

python mpmath_peer.py FILE: each line of the file is an object with a rule set, points, and the values there.
"""

import json
import re
import sys
from multiprocessing import Pool

from mpmath import cos, exp, mp, mpf, pi, sqrt
from mpmath.calculus.quadrature import GaussLegendre

mp.dps = 80  # near the middle of a flat bell, degrees differ by the sixth power of the distance
LARGEST = mpf("1e-9")  # difference, of an output's range
LEAST = mpf("1e-12")  # minimum strength that fires; tolerance of operators with a step, and of ties of maxima
GRID = 48  # intervals of a piece that are searched for roots
NODES = GaussLegendre(mp).calc_nodes(3, 200)  # 12 nodes on [-1, 1]


# Membership functions: the degree at x, and the positions at which it is not smooth.


def polyline(points):
    def degree(x):
        before = [p for p in points if p[0] <= x]
        after = [p for p in points if p[0] > x]
        if not before or not after:
            return (before[-1] if before else after[0])[1]
        (a, ya), (b, yb) = before[-1], after[0]
        return ya + (yb - ya) * (x - a) / (b - a)

    return degree, [x for x, _ in points]


def s_shape(a, b):
    def degree(x):
        if x <= a or x >= b:
            return mpf(x >= b)
        t = (x - a) / (b - a)
        return 2 * t**2 if t < 0.5 else 1 - 2 * (1 - t) ** 2

    return degree, [a, (a + b) / 2, b]


def z_shape(a, b):
    rising, kinks = s_shape(a, b)
    return lambda x: 1 - rising(x), kinks


def gaussian(mean, sd):
    return lambda x: exp(-((x - mean) ** 2) / (2 * sd**2)), [mean]


def gaussian2(left_mean, left_sd, right_mean, right_sd):
    left, right = gaussian(left_mean, left_sd)[0], gaussian(right_mean, right_sd)[0]

    def degree(x):
        return (left(x) if x < left_mean else 1) * (right(x) if x > right_mean else 1)

    return degree, [left_mean, right_mean]


def sigmoid(inflection, slope):
    return lambda x: 1 / (1 + exp(-slope * (x - inflection))), []


def sigmoid_difference(a, slope_a, b, slope_b):
    left, right = sigmoid(a, slope_a)[0], sigmoid(b, slope_b)[0]
    crossing = [(slope_a * a - slope_b * b) / (slope_a - slope_b)] if slope_a != slope_b else []
    return lambda x: abs(left(x) - right(x)), crossing


def sigmoid_product(a, slope_a, b, slope_b):
    left, right = sigmoid(a, slope_a)[0], sigmoid(b, slope_b)[0]
    return lambda x: left(x) * right(x), []


def pi_shape(a, b, c, d):
    (up, first), (down, second) = s_shape(a, b), z_shape(c, d)
    return lambda x: up(x) if x < b else down(x), first + second


def cosine(center, width):
    def degree(x):
        return (1 + cos(2 * pi * (x - center) / width)) / 2 if abs(x - center) <= width / 2 else mpf(0)

    return degree, [center - width / 2, center, center + width / 2]


def concave(inflection, end):
    sign = 1 if end >= inflection else -1

    def degree(x):
        return mpf(1) if sign * (x - end) >= 0 else (end - inflection) / (2 * end - inflection - x)

    return degree, [end]


def arc(start, end):
    def degree(x):
        t = min(max((x - start) / (end - start), mpf(0)), mpf(1))
        return sqrt(t * (2 - t))

    return degree, [start, end]


def semi_ellipse(left, right):
    def degree(x):
        t = min(max((x - left) / (right - left), mpf(0)), mpf(1))
        return 2 * sqrt(t * (1 - t))

    return degree, [left, (left + right) / 2, right]


def shape(name, p):
    """The degree and the kinks of a membership function with its parameters."""
    number = lambda x: [list(map(mpf, one)) if isinstance(one, list) else mpf(one) for one in x]
    p = number(p if isinstance(p, list) else p.values() if isinstance(p, dict) else [p])
    straight = {
        "triangle": lambda a, b, c: [(a, 0), (b, 1), (c, 0)],
        "trapezoid": lambda a, b, c, d: [(a, 0), (b, 1), (c, 1), (d, 0)],
        "left_shoulder": lambda a, b: [(a, 1), (b, 0)],
        "right_shoulder": lambda a, b: [(a, 0), (b, 1)],
        "rectangle": lambda a, b: [(a, 0), (a, 1), (b, 1), (b, 0)],
        "piecewise": lambda *points: points,
        "constant": lambda degree: [(mpf(0), degree)],
    }
    curved = {
        "s_shape": s_shape,
        "z_shape": z_shape,
        "pi_shape": pi_shape,
        "gaussian": gaussian,
        "gaussian2": gaussian2,
        "bell": lambda c, w, s: (lambda x: 1 / (1 + abs((x - c) / w) ** (2 * s)), [c]),
        "sigmoid": sigmoid,
        "sigmoid_difference": sigmoid_difference,
        "sigmoid_product": sigmoid_product,
        "cosine": cosine,
        "spike": lambda c, w: (lambda x: exp(-abs(10 * (x - c) / w)), [c]),
        "concave": concave,
        "arc": arc,
        "semi_ellipse": semi_ellipse,
    }
    if name in straight:
        return polyline([(x, mpf(y)) for x, y in straight[name](*p)])
    degree, kinks = curved[name](*p)
    if name in ("gaussian", "bell", "cosine", "spike", "semi_ellipse", "sigmoid", "sigmoid_difference", "sigmoid_product"):
        # These shapes reach 1 at a single position at most, but near it, 80 digits would round to 1.
        return lambda x: min(degree(x), 1 - mpf("1e-78")), kinks
    return degree, kinks


def term(document):
    height = mpf(document.get("height", 1))
    ((name, parameters),) = [(k, v) for k, v in document.items() if k != "height"]
    degree, kinks = shape(name, parameters)
    return (lambda x: height * degree(x)), kinks


# Operators, named as in rule sets.


def nilpotent_minimum(a, b):
    return min(a, b) if a + b - 1 > LEAST or max(a, b) == 1 else mpf(0)


def nilpotent_maximum(a, b):
    return max(a, b) if 1 - a - b > LEAST or min(a, b) == 0 else mpf(1)


AND = {
    "minimum": min,
    "product": lambda a, b: a * b,
    "bounded_difference": lambda a, b: max(mpf(0), a + b - 1),
    "drastic": lambda a, b: min(a, b) if max(a, b) >= 1 - LEAST else mpf(0),
    "einstein": lambda a, b: a * b / (2 - (a + b - a * b)),
    "hamacher": lambda a, b: a * b / (a + b - a * b) if a or b else mpf(0),
    "nilpotent_minimum": nilpotent_minimum,
}
IMPLICATION = AND | {
    # If the strength cuts off a term, only intervals of the term with the degree 1 remain.
    "drastic": lambda h, m: m if h >= 1 - LEAST else h if m == 1 else mpf(0),
}
OR = {
    "maximum": max,
    "probabilistic_sum": lambda a, b: a + b - a * b,
    "bounded_sum": lambda a, b: min(mpf(1), a + b),
    "drastic": lambda a, b: max(a, b) if min(a, b) <= LEAST else mpf(1),
    "einstein": lambda a, b: (a + b) / (1 + a * b),
    # Avoids the cancellation of (a + b - 2 a b) / (1 - a b) near 1.
    "hamacher": lambda a, b: (a * (1 - b) + b * (1 - a)) / (1 - a * b) if max(a, b) < 1 else mpf(1),
    "nilpotent_maximum": nilpotent_maximum,
    "sum": lambda a, b: a + b,
}


def condition(words, is_so, join, loosest="OR"):
    """The degree of a condition in words, which are removed from the list."""
    if loosest is None:
        if words[0] == "NOT":
            words.pop(0)
            return 1 - condition(words, is_so, join, None)
        if words[0] == "(":
            words.pop(0)
            degree = condition(words, is_so, join)
            words.pop(0)
            return degree
        variable, _, name = words.pop(0), words.pop(0), words.pop(0)
        return is_so(variable, name)
    tighter = "AND" if loosest == "OR" else None
    degree = condition(words, is_so, join, tighter)
    while words and words[0] == loosest:
        words.pop(0)
        degree = join[loosest](degree, condition(words, is_so, join, tighter))
    return degree


# The aggregated set, cut into pieces on which it is smooth.


def root(f, a, b):
    """A root of a function that changes its sign, by bisection and regula falsi."""
    fa, fb = f(a), f(b)
    if (fa > 0) == (fb > 0):
        return a if abs(fa) < abs(fb) else b
    for step in range(400):
        x = b - fb * (b - a) / (fb - fa)
        if step % 3 == 2 or not a < x < b:
            x = (a + b) / 2
        if not a < x < b or b - a < abs(a + b) * mpf("1e-70"):
            break
        fx = f(x)
        if fx == 0:
            return x
        if (fx > 0) == (fb > 0):
            fa, b, fb = (fa / 2 if (b - x) * 2 < b - a else fa), x, fx
        else:
            fb, a, fa = (fb / 2 if (x - a) * 2 < b - a else fb), x, fx
    return (a + b) / 2


class AggregatedSet:
    def __init__(self, low, high, fired, implication, aggregation):
        self.low, self.high = low, high
        self.implication, self.aggregation = IMPLICATION[implication], OR[aggregation]
        # (strength, degree, kinks, whether the strength cuts nothing off)
        self.fired = [(h, *term, self.is_whole(h, term, implication)) for h, term in fired]
        self.cuts = sorted({low, high, *(x for _, (_, kinks) in fired for x in kinks if low < x < high)})
        for switches in [self.levels(implication), self.crossings(aggregation)]:
            new = [root(f, a, b) for f in switches for a, b in self.grid(f)]
            self.cuts = sorted({*self.cuts, *new})
        # Two roots at one position, which differ in their last digits.
        narrow = (high - low) * mpf("1e-38")
        self.cuts = [low, *(b for a, b in zip(self.cuts, self.cuts[1:]) if b - a > narrow)]
        self.pieces = list(zip(self.cuts, self.cuts[1:]))

    def is_whole(self, strength, term, implication):
        """Whether a strength is at least the highest degree of a term, except for rounding."""
        if implication not in ("minimum", "nilpotent_minimum"):
            return False
        degree, kinks = term
        places = [self.low + (self.high - self.low) * i / 200 for i in range(201)]
        about = max(degree(x) for x in places + [x for x in kinks if self.low <= x <= self.high])
        if strength < about * (1 - LEAST):
            return False
        if strength > about * mpf("1.01"):
            return True
        tops = AggregatedSet(self.low, self.high, [(mpf(1), term)], "product", "maximum").tops()
        return strength >= max(y for *_, y in tops) * (1 - LEAST)

    def grid(self, f):
        """Intervals in which a function changes its sign."""
        for from_, to in zip(self.cuts, self.cuts[1:]):
            inside = (to - from_) * mpf("1e-30")
            xs = [from_ + inside + (to - from_ - 2 * inside) * i / GRID for i in range(GRID + 1)]
            ys = [f(x) for x in xs]
            yield from ((a, b) for a, b, p, q in zip(xs, xs[1:], ys, ys[1:]) if (p > 0) != (q > 0) and p and q)

    def levels(self, implication):
        """Functions that change their sign where an implication has a kink or a step."""
        of = {
            "minimum": lambda h: [h],
            "bounded_difference": lambda h: [1 - h],
            "nilpotent_minimum": lambda h: [h, 1 - h + LEAST],
        }.get(implication, lambda h: [])
        return [
            lambda x, degree=degree, level=level: degree(x) - level
            for strength, degree, _, whole in self.fired
            for level in of(strength)
            if level != strength or not whole
        ]

    def crossings(self, aggregation):
        """Functions that change their sign where an aggregation has a kink or a step."""
        parts = [self.part(one) for one in self.fired]
        switches = []
        for i, part in enumerate(parts):
            before = lambda x, i=i: self.joined(parts[:i], x)
            if aggregation in ("maximum", "nilpotent_maximum"):
                switches += [lambda x, p=part, q=q: p(x) - q(x) for q in parts[:i]]
            if aggregation == "nilpotent_maximum" and i > 0:
                switches += [lambda x, p=part, q=before: 1 - p(x) - q(x) - LEAST if p(x) and q(x) else 1]
            if aggregation == "bounded_sum":
                switches += [lambda x, i=i: sum(p(x) for p in parts[: i + 1]) - 1]
            if aggregation == "drastic":
                switches += [lambda x, p=p: p(x) - LEAST for p in [part, before]]
        return switches

    def part(self, one):
        strength, degree, _, whole = one
        if whole:
            return lambda x: degree(x) if self.implication(strength, degree(x)) > 0 else mpf(0)
        return lambda x: self.implication(strength, degree(x))

    def joined(self, parts, x):
        y = mpf(0)
        for part in parts:
            y = self.aggregation(y, part(x))
        return y

    def degree(self, x):
        return self.joined([self.part(one) for one in self.fired], x)

    def gauss(self, from_, to):
        middle, half = (from_ + to) / 2, (to - from_) / 2
        area = moment = mpf(0)
        for node, weight in NODES:
            x = middle + half * node
            y = half * weight * self.degree(x)
            area, moment = area + y, moment + y * (x - self.low)
        return area, moment

    def integral(self, from_, to, allowed, whole=None):
        """Area and moment from the lower end of the range, by halving until nothing changes."""
        whole = whole or self.gauss(from_, to)
        middle = (from_ + to) / 2
        halves = self.gauss(from_, middle), self.gauss(middle, to)
        area, moment = (a + b for a, b in zip(*halves))
        if abs(area - whole[0]) <= allowed:
            return area, moment
        left = self.integral(from_, middle, allowed, halves[0])
        right = self.integral(middle, to, allowed, halves[1])
        return left[0] + right[0], left[1] + right[1]

    def value(self, defuzzifier):
        if "maxima" in defuzzifier:
            return self.maxima(defuzzifier)
        allowed = mpf("1e-17") * sum(self.gauss(*piece)[0] for piece in self.pieces)
        integrals = [self.integral(*piece, allowed) for piece in self.pieces]
        area = sum(area for area, _ in integrals)
        if area <= 0:
            return None
        if defuzzifier == "centroid":
            return self.low + sum(moment for _, moment in integrals) / area
        rest = area / 2
        for (from_, to), (area, _) in zip(self.pieces, integrals):
            if area >= rest > 0:
                return root(lambda x: self.integral(from_, x, allowed)[0] - rest if x > from_ else -rest, from_, to)
            rest -= area
        return self.high

    def tops(self):
        """Peaks, and intervals with their lowest degree: (from, to, degree)."""
        tops, before = [], (-1, False)  # the degree at the end of the preceding piece, and whether it rises to it
        for from_, to in self.pieces:
            inside = (to - from_) * mpf("1e-30")
            xs = [from_ + inside + (to - from_ - 2 * inside) * i / GRID for i in range(GRID + 1)]
            ys = [self.degree(x) for x in xs]
            tops.append((from_, to, min(ys)))
            if max(ys) - min(ys) <= mpf("1e-25") * max(ys):
                ends = (False, False)
            else:
                step = (to - from_) * mpf("1e-14")
                slope = lambda x: self.degree(x + step) - self.degree(x - step)
                xs[0], xs[-1] = from_ + 2 * step, to - 2 * step
                slopes = [slope(x) for x in xs]
                for a, b, p, q in zip(xs, xs[1:], slopes, slopes[1:]):
                    if p > 0 >= q:
                        x = root(slope, a, b)
                        tops.append((x, x, self.degree(x)))
                ends = (slopes[0] < 0, slopes[-1] > 0)
            # There is a peak at the cut between two pieces if the set rises to it and then falls or steps down, or if it
            # steps up at the cut and then falls.
            left, right = before[0], ys[0]
            is_step = abs(left - right) > mpf("1e-35") * max(left, right)
            if (left > right if is_step else ends[0]) and before[1] or (ends[0] and is_step and right > left):
                tops.append((from_, from_, max(left, right)))
            before = (ys[-1], ends[1])
        if before[1]:
            tops.append((self.high, self.high, before[0]))
        return tops

    def maxima(self, defuzzifier):
        tops = self.tops()
        highest = max(degree for *_, degree in tops)
        if highest <= 0:
            return None
        highs = [(a, b) for a, b, degree in tops if degree >= highest * (1 - LEAST)]
        if defuzzifier == "smallest_of_maxima":
            return min(a for a, _ in highs)
        if defuzzifier == "largest_of_maxima":
            return max(b for _, b in highs)
        length = sum(b - a for a, b in highs)
        if length > 0:
            return sum((a + b) / 2 * (b - a) for a, b in highs) / length
        return sum(a for a, _ in highs) / len(highs)


def number(document, values):
    """The number of a Takagi-Sugeno term."""
    if "constant" in document:
        return mpf(document["constant"])
    linear = dict(document["linear"])
    constant = mpf(linear.pop("constant", 0))
    return constant + sum(mpf(factor) * values[name] for name, factor in linear.items())


def evaluate(model, point, rounding=mpf(1)):
    """The value of a rule set's only output at a point, with all weights multiplied by `rounding`, a number close to 1."""
    ((output_name, output),) = model["outputs"].items()
    operators, values = model["operators"], {}
    for (name, variable), x in zip(model["inputs"].items(), point):
        low, high = variable["range"]
        values[name] = mpf(min(max(x, low), high))
    is_so = lambda variable, name: term(model["inputs"][variable]["terms"][name])[0](values[variable])
    join = {"AND": AND[operators["and"]], "OR": OR[operators["or"]]}
    fired = []
    for text in model["rules"]:
        words = re.findall(r"[()]|[^\s()]+", text)[1:]
        strength = condition(words, is_so, join)
        _, _, _, name, *weight = words  # THEN output IS term [WITH weight]
        strength *= rounding * (mpf(float(weight[1])) if weight else 1)
        if strength >= LEAST:
            fired.append((strength, output["terms"][name]))
    if not fired:
        return None
    defuzzifier = output.get("defuzzifier", "centroid")
    if defuzzifier in ("weighted_average", "weighted_sum"):
        total = sum(strength * number(document, values) for strength, document in fired)
        return total if defuzzifier == "weighted_sum" else total / sum(strength for strength, _ in fired)
    low, high = map(mpf, output["range"])
    fired = [(strength, term(document)) for strength, document in fired]
    aggregation = output.get("aggregation", operators["aggregation"])
    return AggregatedSet(low, high, fired, operators["implication"], aggregation).value(defuzzifier)


def by_name(part):
    """Converts lists of entries with a name to dictionaries. The lists keep the order of entries in formats that sort names."""
    if isinstance(part, dict):
        return {key: by_name(value) for key, value in part.items()}
    if isinstance(part, list) and part and all(isinstance(entry, dict) and "name" in entry for entry in part):
        return {entry["name"]: by_name({k: v for k, v in entry.items() if k != "name"}) for entry in part}
    return part


def compare(line):
    """Compares the values of one line. Returns the number of values, the errors, and the number of values that depend on
    rounding."""
    case = json.loads(line)
    model = by_name(case["model"])
    ((_, output),) = model["outputs"].items()
    defuzzifier = output.get("defuzzifier", "centroid")
    low, high = output["range"]
    width = 1 if defuzzifier.startswith("weighted") else high - low

    def differ(a, b):
        both = a is not None and b is not None
        return not (abs(mpf(a) - b) <= LARGEST * width if both else a is b)

    wrong, ill_conditioned = [], 0
    for point, ours in zip(case["points"], case["values"]):
        exact = evaluate(model, point)
        if not differ(ours, exact):
            continue
        if differ(exact, evaluate(model, point, 1 - mpf("1e-15"))):
            ill_conditioned += 1  # depends on the last digit of the firing strengths
            continue
        told = exact and float(exact)
        wrong.append(f"seed {case['seed']} at {point}: {ours}, not {told}, {defuzzifier} {model['operators']}")
    return len(case["values"]), wrong, ill_conditioned


def main(path):
    values = wrong = ill_conditioned = 0
    with open(path) as lines, Pool() as pool:
        for count, told, undecided in pool.imap(compare, lines):
            values, wrong, ill_conditioned = values + count, wrong + len(told), ill_conditioned + undecided
            print(*told, sep="\n", end="\n" if told else "", flush=True)
    print(f"{values} values, {wrong} wrong, {ill_conditioned} ill-conditioned")
    return 1 if wrong or not values or 100 * ill_conditioned > values else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
