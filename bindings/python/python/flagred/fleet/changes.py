"""Changes of the risk: in the whole fleet, with a new firmware, a new part or from a week on; and in single vehicles, as a
step or a trend.

Each vehicle is compared with itself. P values are those of permutation tests that shuffle the days of each vehicle,
adjusted for all tests of the fleet by the maximum statistic of Westfall and Young.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from .history import MEASURES, History, Reals, histories, marks
from .permutation import Sum, p_values, shuffled, student

__all__ = ["MIN_DAYS", "LEVEL", "Change", "find_changes"]

LEVEL = 0.01
"""The probability that a change is found in a fleet without changes."""
FAMILIES = 3
"""Marks, weeks and vehicles are three families of tests; each gets a third of ``LEVEL``."""
SIDE = 4
"""The minimum number of days of a vehicle before and after a change."""
MIN_DAYS = 2 * SIDE
"""The minimum number of days of a vehicle that is compared with itself."""
AGREEMENT = 2 / 3
"""The minimum share of vehicles that must change in the same direction for a change of the fleet."""
MAX_WEEKS = 104
"""The latest weeks that are searched for a change of the whole fleet."""
CLEAR = 6.0
"""The minimum difference of the Bayesian information criterion to distinguish a step from a slope: odds of 20 to 1."""
SHUFFLES, FEWER_SHUFFLES, MANY_DAYS = 999, 399, 50_000
SEED = 20_260_105
MEAN, HIGHEST, WARNED = range(len(MEASURES))


@dataclass(frozen=True)
class Change:
    """A change of the risk that is statistically significant. All differences are adjusted to equal wind and equal time in the
    air."""

    kind: Literal["step", "slope"]
    """A step at a time, or a steady slope."""
    is_clear: bool
    """Whether the other kind explains the days much worse."""
    cause: str | None
    """The firmware or part that was changed then; None if it is unknown."""
    is_fleet: bool
    """Whether it was tested on the fleet as a whole."""
    vehicles: tuple[str, ...]
    """The vehicles in which it was found."""
    since_s: float
    """The time of the first flight after a step, or of the first flight of a slope, in seconds since 1970."""
    measure: str
    """The measure with the clearest change: ``risk_mean_pct``, ``risk_max_pct`` or ``warned_pct``."""
    change_pct: float
    """The change of this measure in percent (points): after a step, or over all weeks of a slope."""
    low_pct: float
    """The lower end of its 95 % interval."""
    high_pct: float
    slope_pct_week: float | None
    """The slope, in percent per week."""
    p: float
    """The probability of such a change in a fleet without changes, adjusted for all tests of the fleet."""
    flights: tuple[int, int]
    """The numbers of flights before and after; for a slope 0 and all."""
    warned_pct: tuple[float, float]
    """The share of flights that warned, before and after; for a slope, in its first and last third."""
    others: tuple[float, float, float] | None
    """The simultaneous change of the vehicles that do not have the cause, with its interval; None if too few of them flew."""


def find_changes(connection: Any, parts: Mapping[str, Sequence[tuple[float, str]]] | None = None, level: float = LEVEL) -> list[Change]:
    """Finds the changes of a fleet: those of the whole fleet first, then those of vehicles, the largest rise first.

    Parameters
    ----------
    connection
        The connection returned by :func:`open_dataset`.
    parts
        Changed parts: for each vehicle, the times in seconds since 1970 and the parts.
    level
        The probability that a change is found in a fleet without changes.
    """
    fleet, _ = histories(connection)
    fleet = [history for history in fleet if len(history) >= MIN_DAYS]
    chance = np.random.default_rng(SEED)
    shuffles = SHUFFLES if sum(map(len, fleet)) <= MANY_DAYS else FEWER_SHUFFLES
    of_parts = {vehicle: list(some) for vehicle, some in (parts or {}).items()}
    found: list[Change] = []
    for cut in (lambda fleet: _by_mark(fleet, of_parts), _by_week):
        changes = _of_fleet(cut(fleet), fleet, shuffles, chance, level)
        found += [change for change, _ in changes]
        # A change of the fleet is not reported again for each of its vehicles.
        fleet = _without(fleet, [of for _, of in changes])
    found.sort(key=lambda change: -change.change_pct)
    of_vehicles = _of_vehicles(fleet, of_parts, shuffles, chance, level)
    return found + sorted(of_vehicles, key=lambda change: -change.change_pct)


@dataclass(frozen=True)
class _Split:
    """Some days of a vehicle, of which the first ``before`` precede a change."""

    history: History
    begin: int
    end: int
    at: int

    @property
    def values(self) -> Reals:
        return self.history.values[self.begin : self.end]

    @property
    def before(self) -> int:
        return self.at - self.begin

    @property
    def after(self) -> int:
        return self.end - self.at


Splits = dict[tuple[float, str | None], list[_Split]]
"""For each change, the split of each vehicle. The key is (0, name) for a firmware or part, and (start, None) for a week."""


def _by_mark(fleet: Sequence[History], parts: dict[str, list[tuple[float, str]]]) -> Splits:
    """Firmware and parts of at least two vehicles, each with the days from the previous change to the next.

    A change of a single vehicle is found by the models of its risk, which distinguish a step from wear.
    """
    splits: Splits = defaultdict(list)
    for history in fleet:
        rows = marks(history, parts)
        ends = [0, *(row for row, _ in rows), len(history)]
        for (row, name), begin, end in zip(rows, ends, ends[2:]):
            if row - begin >= SIDE and end - row >= SIDE:
                splits[0.0, name].append(_Split(history, begin, end, row))
    return {key: of for key, of in splits.items() if len({split.history.vehicle for split in of}) >= 2}


def _by_week(fleet: Sequence[History]) -> Splits:
    """The splits at the start of each week, if at least three vehicles have enough days before and after it."""
    if not fleet:
        return {}
    last = max(history.start_s[-1] for history in fleet)
    week_s = 7 * 86_400
    # 1 January 1970 was a Thursday.
    monday = np.floor((last - 4 * 86_400) / week_s) * week_s + 4 * 86_400
    splits: Splits = {}
    for number in range(min(MAX_WEEKS, int((monday - min(history.start_s[0] for history in fleet)) // week_s) + 1)):
        since_s = monday - number * week_s
        rows = [(history, int(np.searchsorted(history.start_s, since_s))) for history in fleet]
        cut = [_Split(history, 0, len(history), row) for history, row in rows if SIDE <= row <= len(history) - SIDE]
        if len(cut) >= 3:
            splits[since_s, None] = cut
    return splits


def _of_fleet(
    splits: Splits, fleet: Sequence[History], shuffles: int, chance: np.random.Generator, level: float
) -> list[tuple[Change, list[_Split]]]:
    """The significant changes, each with its splits. If the splits are weeks, only the clearest change is returned."""
    if not splits:
        return []
    sums = {key: Sum(shuffles + 1, len(of)) for key, of in splits.items()}
    by_days: dict[tuple[int, int, int], list[tuple[Sum, _Split]]] = defaultdict(list)
    for key, of in splits.items():
        for split in of:
            by_days[id(split.history), split.begin, split.end].append((sums[key], split))
    for some in by_days.values():
        total = shuffled(some[0][1].values, shuffles, chance)
        for sum, split in some:
            sum.add(total[:, split.before - 1], split.values, split.before)
    scores = np.stack([sum.scores() for sum in sums.values()])
    found = []
    for (key, of), p, score in zip(splits.items(), FAMILIES * p_values(scores), scores[:, 0]):
        measure = int(score.argmax())
        if p[measure] <= level and sums[key].agreement(measure) >= AGREEMENT:
            found.append((sums[key].fit(), _step(of, key, measure, float(p[measure]), fleet), of))
    if found and found[0][1].cause is None:
        found = [max(found, key=lambda one: one[0])]
    return [(change, of) for _, change, of in found]


def _step(splits: Sequence[_Split], key: tuple[float, str | None], measure: int, p: float, fleet: Sequence[History]) -> Change:
    change, low, high = _pooled(splits, measure)
    since_s = min(float(split.history.start_s[split.at]) for split in splits)
    with_it = {split.history.vehicle for split in splits}
    middle_s = float(np.median([split.history.start_s[split.at] for split in splits]))
    rest = [(history, int(np.searchsorted(history.start_s, middle_s))) for history in fleet if history.vehicle not in with_it]
    others = [_Split(history, 0, len(history), row) for history, row in rest if SIDE <= row <= len(history) - SIDE]
    return Change(
        "step",
        True,
        key[1],
        True,
        tuple(sorted(with_it)),
        since_s,
        MEASURES[measure],
        change,
        low,
        high,
        None,
        p,
        *_counts([(split.history, split.begin, split.at, split.end) for split in splits]),
        _pooled(others, measure) if others and key[1] is not None else None,
    )


def _counts(spans: Sequence[tuple[History, int, int, int]]) -> tuple[tuple[int, int], tuple[float, float]]:
    """The numbers of flights before and after, and the shares of them that warned."""
    flights, shares = [], []
    for late in (0, 1):
        parts = [(of, slice(span[late], span[late + 1])) for of, *span in spans]
        count = sum(int(of.flights[part].sum()) for of, part in parts)
        flights.append(count)
        shares.append(100 * float(sum(of.warned[part].sum() for of, part in parts)) / max(1, count))
    return (flights[0], flights[1]), (shares[0], shares[1])


def _pooled(splits: Sequence[_Split], measure: int) -> tuple[float, float, float]:
    """The mean difference of vehicles, after minus before, with its 95 % interval: random effects, after DerSimonian and Laird."""
    pairs = [(split.values[: split.before, measure], split.values[split.before :, measure]) for split in splits]
    d = np.array([after.mean() - before.mean() for before, after in pairs])
    left = sum(((side - side.mean()) ** 2).sum() for pair in pairs for side in pair)
    freedom = sum(len(before) + len(after) - 2 for before, after in pairs)
    # One variance of days for all vehicles, because a vehicle that never warned has none.
    v = max(left / freedom, 1e-9) * np.array([1 / len(before) + 1 / len(after) for before, after in pairs])
    w = 1 / v
    spread = float((w * (d - (w * d).sum() / w.sum()) ** 2).sum())
    between = max(0.0, (spread - len(d) + 1) / (w.sum() - (w**2).sum() / w.sum())) if len(d) > 1 else 0.0
    w = 1 / (v + between)
    mean = float((w * d).sum() / w.sum())
    half = student(freedom) * float(np.sqrt(1 / w.sum()))
    return mean, mean - half, mean + half


def _without(fleet: Sequence[History], explained: Sequence[Sequence[_Split]]) -> list[History]:
    """The fleet without the effect of the found steps: from each step on, its mean size over its vehicles is subtracted."""
    values = {history.vehicle: history.values.copy() for history in fleet}
    for splits in explained:
        rise = np.array([_pooled(splits, measure)[0] for measure in range(len(MEASURES))])
        for split in splits:
            values[split.history.vehicle][split.at :] -= rise
    return [replace(history, values=values[history.vehicle]) for history in fleet]


def _of_vehicles(
    fleet: Sequence[History], parts: dict[str, list[tuple[float, str]]], shuffles: int, chance: np.random.Generator, level: float
) -> list[Change]:
    """The vehicles whose risk has a step or a slope, each once: by the model that explains its days best."""
    if not fleet:
        return []
    scores = np.stack([_vehicle_scores(history, shuffles, chance) for history in fleet])
    found = []
    for history, p, score in zip(fleet, FAMILIES * p_values(scores), scores[:, 0]):
        measure = int(score.argmax())
        if p[measure] <= level:
            found.append(_of_vehicle(history, measure, float(p[measure]), marks(history, parts)))
    return found


def _vehicle_scores(history: History, shuffles: int, chance: np.random.Generator) -> Reals:
    """How well the best step or the slope explains the risk, as standard normal scores for each shuffling and measure. The
    measures are the mean and the highest risk; the share of flights that warned is too coarse for a single vehicle."""
    values = history.values[:, :WARNED]
    n = len(values)
    total = shuffled(values, shuffles, chance)
    before = np.arange(SIDE, n - SIDE + 1)
    squares = np.maximum(((values - values.mean(axis=0)) ** 2).sum(axis=0), 1e-12)
    steps = (total[:, before - 1] ** 2 * (n / (before * (n - before)))[:, None]).max(axis=1)
    weeks = history.weeks - history.weeks.mean()
    # Sums of products with the times, for each split.
    slopes = np.einsum("rnm,n->rm", total[:, :-1], weeks[:-1] - weeks[1:]) ** 2 / (weeks**2).sum()
    explained = np.minimum(np.maximum(steps, slopes) / squares, 0.999999)
    freedom = n - 2
    # Converts Student's t to a normal score, after Wallace.
    scores: Reals = (8 * freedom + 1) / (8 * freedom + 3) * np.sqrt(-freedom * np.log1p(-explained))
    return scores


def _of_vehicle(history: History, measure: int, p: float, of: Sequence[tuple[int, str]]) -> Change:
    y, n = history.values[:, measure], len(history)
    weeks = history.weeks - history.weeks.mean()
    slope = float((weeks * y).sum() / (weeks**2).sum())
    left = float(((y - y.mean() - slope * weeks) ** 2).sum())

    def criterion(squares: float, parameters: int) -> float:
        return n * float(np.log(max(squares, 1e-9) / n)) + parameters * float(np.log(n))

    def squares(row: int) -> float:
        return float(sum(((side - side.mean()) ** 2).sum() for side in (y[:row], y[row:])))

    rows = range(SIDE, n - SIDE + 1)
    best = min(rows, key=squares)
    # The time of a step is a parameter, unlike the time of a known change.
    steps = [(criterion(squares(best), 3), best, None)] + [(criterion(squares(row), 2), row, name) for row, name in of if row in rows]
    quality, row, cause = min(steps, key=lambda step: step[0])
    of_vehicle = (history.vehicle,)
    of_slope = criterion(left, 2)
    is_clear = abs(of_slope - quality) >= CLEAR
    if of_slope <= quality:
        span = float(history.weeks[-1] - history.weeks[0])
        half = student(n - 2) * float(np.sqrt(left / (n - 2) / (weeks**2).sum()))
        third = n // 3
        (early, _), (late, _) = (_counts([(history, begin, begin + third, n)])[1] for begin in (0, n - third))
        ends = (slope * span, (slope - half) * span, (slope + half) * span)
        counts = ((0, int(history.flights.sum())), (early, late))
        return Change("slope", is_clear, None, False, of_vehicle, float(history.start_s[0]), MEASURES[measure], *ends, slope, p, *counts, None)
    split = _Split(history, 0, n, row)
    since_s = float(history.start_s[row])
    effect, counts = _pooled([split], measure), _counts([(history, 0, row, n)])
    return Change("step", is_clear, cause, False, of_vehicle, since_s, MEASURES[measure], *effect, None, p, *counts, None)
