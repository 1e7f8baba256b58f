"""The shortest time along a curve from rest to rest, by IPOPT.

The sum of the times h of the cells of the path is least. Jerk is constant over a cell: `s' = s + v h + a h²/2 + j h³/6`,
`v' = v + a h + j h²/2`, `a' = a + j h`. Everywhere `|a| ≤ A` and `|j| ≤ J`, and at the ends of cells `v ≤ V`, where V is the least of the
commanded feed F, of `(2/T) √(E (2ρ - E))` at the radius ρ (2ρ/T below E), and of √(C ρ) for a limit C across the path. With limits of axes,
e the tangent, k the curvature vector and c its derivative by the arc length, at both ends of each cell
`|eᵢ v| ≤ vᵢ`, `|eᵢ a + kᵢ v²| ≤ aᵢ` and `|eᵢ j + 3 kᵢ v a + cᵢ v³| ≤ jᵢ`; and where k steps by Δk at a knot, `|Δkᵢ| v² ≤ ⅔ jᵢ T`.
"""

from dataclasses import dataclass

import casadi
import numpy

from .curve import Curve
from .limits import Limits

# Parts of even parameter into which all spans together are cut, and how often a cell is looked at afterwards.
SAMPLES, LOOKS = 100_000, 8
# Where a limit is level, many motions near the fastest differ by less than IPOPT resolves: then it ends at the second tolerance.
SETTINGS = {
    "print_time": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.max_iter": 1500,
    "ipopt.max_cpu_time": 200.0,
    "ipopt.tol": 1e-9,
    "ipopt.acceptable_tol": 1e-7,
    "ipopt.acceptable_iter": 8,
}


@dataclass
class Found:
    """A time in s, and the time that the same motion takes if it is slowed down until it keeps every limit inside cells too."""

    time: float
    feasible: float


class Path:
    """A curve under limits: samples of it, and the fastest motion without a limit of jerk, along which cells are even."""

    def __init__(self, case):
        spline = case.curve
        spans = len(set(spline["knots"])) - 1
        self.curve = Curve(spline["degree"], spline["knots"], spline["control_points_mm"], spline["weights"], -(-SAMPLES // spans))
        self.limits = Limits(case.machine)
        self.begins = [s[0] for _, s in self.curve.cells]
        bends = [self.curve.bends_at(number, u) for number, (u, _) in enumerate(self.curve.cells)]
        self.place = numpy.concatenate([s for _, s in self.curve.cells])
        feeds = [self.limits.most(tangent, bend) for tangent, bend, _ in bends]
        self.feed = numpy.concatenate(feeds)
        self.slow = numpy.concatenate([self.limits.slow(feed, bend, change) for feed, (_, bend, change) in zip(feeds, bends)])
        # The largest feed at each knot inside.
        self.at_knots = [
            min(before[-1], after[0], self.limits.over_step(b[1][-1] - a[1][0]))
            for before, after, b, a in zip(feeds, feeds[1:], bends, bends[1:])
        ]

    def jerk_free(self):
        """The feed of the fastest motion without a limit of jerk at each sample, and the time that it takes to there."""
        square = self.slow**2
        square[0] = square[-1] = 0.0
        rise = 2 * self.limits.acceleration * numpy.diff(self.place)
        for k in range(len(rise)):
            square[k + 1] = min(square[k + 1], square[k] + rise[k])
        for k in reversed(range(len(rise))):
            square[k] = min(square[k], square[k + 1] + rise[k])
        feed = numpy.sqrt(square)
        with numpy.errstate(divide="ignore", invalid="ignore"):
            steps = 2 * numpy.diff(self.place) / (feed[1:] + feed[:-1])
        # A knot is two samples at one place.
        return feed, numpy.concatenate([[0.0], numpy.cumsum(numpy.nan_to_num(steps, posinf=0.0))])

    def ends_of_cells(self, cells):
        """Places at which cells end: three quarters of them even in time, a quarter where V bends; each knot and each least V is one."""
        feed, clock = self.jerk_free()
        turns = numpy.concatenate([[0.0], numpy.cumsum(numpy.abs(numpy.diff(numpy.log(numpy.maximum(self.slow, 1e-3 * self.limits.feed)))))])
        share = 0.75 * clock / clock[-1] + 0.25 * (turns / turns[-1] if turns[-1] > 1e-6 else clock / clock[-1])
        even = numpy.linspace(0.0, 1.0, cells + 1)
        inner = self.feed[1:-1]
        least = numpy.flatnonzero((inner < self.feed[:-2]) & (inner <= self.feed[2:])) + 1
        fixed = sorted({0.0, self.place[-1], *self.begins, *self.place[least]})
        # A cell's end that is near a fixed one gives way.
        at_fixed = numpy.interp(fixed, self.place, share)
        near = numpy.min(numpy.abs(even[:, None] - at_fixed[None, :]), axis=1) < 0.4 / cells
        places = numpy.array(sorted({*fixed, *numpy.interp(even[~near], share, self.place)}))
        close = numpy.diff(places) < 1e-9 * self.place[-1]
        return numpy.concatenate([places[:-1][~close], places[-1:]]), feed, clock

    def at_both_ends(self, places):
        """V at the ends of cells, and tangent, curvature vector and change at the begin and at the end of each cell."""
        number = numpy.searchsorted(self.begins, (places[1:] + places[:-1]) / 2) - 1
        ends = []
        for at in (places[:-1], places[1:]):
            found = numpy.zeros((3, len(at), 3))
            for span in range(len(self.begins)):
                here = number == span
                if here.any():
                    found[:, here] = self.curve.bends(span, at[here])
            ends.append(found)
        (e0, k0, _), (e1, k1, _) = ends
        before, after = self.limits.most(e0, k0), self.limits.most(e1, k1)
        most = numpy.minimum(numpy.concatenate([before, after[-1:]]), numpy.concatenate([before[:1], after]))
        for place, feed in zip(self.begins[1:], self.at_knots):
            near = numpy.argmin(numpy.abs(places - place))
            most[near] = min(most[near], feed)
        return most, ends


def shortest(path, cells):
    """The least time with about so many cells, or why there is none."""
    places, free, clock = path.ends_of_cells(cells)
    cells, limits = len(places) - 1, path.limits
    most, ends = path.at_both_ends(places)
    distance = numpy.diff(places)
    steps = numpy.maximum(numpy.diff(numpy.interp(places, path.place, clock)), distance / limits.feed)
    guess = numpy.minimum(numpy.interp(places, path.place, free), most)
    # In units in which all numbers are near one.
    v, a, j, h = (casadi.MX.sym(what, n) for what, n in (("v", cells + 1), ("a", cells + 1), ("j", cells), ("h", cells)))
    feed, acceleration = limits.feed * v, limits.acceleration * a
    jerk, time = limits.jerk * j, casadi.DM(steps) * h
    v0, a0, a1 = feed[:-1], acceleration[:-1], acceleration[1:]
    moves = [
        (v0 * time + a0 * time**2 / 2 + jerk * time**3 / 6) / casadi.DM(distance) - 1,
        (v0 + a0 * time + jerk * time**2 / 2 - feed[1:]) / limits.feed,
        (a0 + jerk * time - a1) / limits.acceleration,
    ]
    shares = list(shares_of_axes(limits.axes, ends, (feed, acceleration, jerk)))
    rows, bounds = casadi.vertcat(*moves, *shares), numpy.concatenate([numpy.zeros(3 * cells), numpy.ones(cells * len(shares))])
    total = clock[-1]
    problem = {"x": casadi.vertcat(v, a, j, h), "f": casadi.dot(casadi.DM(steps / total), h), "g": rows}
    at_rest = numpy.ones(cells + 1)
    at_rest[[0, -1]] = 0.0
    ones = numpy.ones(cells)
    solver = casadi.nlpsol("fastest", "ipopt", problem, SETTINGS)
    status = None
    for slower in (0.8, 0.4):
        found = solver(
            x0=numpy.concatenate([slower * guess / limits.feed, 0 * at_rest, 0 * ones, ones / slower]),
            lbx=numpy.concatenate([0 * at_rest, -at_rest, -ones, 1e-3 * ones]),
            ubx=numpy.concatenate([most / limits.feed * at_rest, at_rest, ones, 1e4 * ones]),
            lbg=-bounds,
            ubg=bounds,
        )
        status = solver.stats()
        if status["success"]:
            break
    else:
        raise ArithmeticError(status["return_status"])
    x = numpy.array(found["x"]).ravel()
    v, a, j = x[:cells], x[cells + 1 : 2 * cells + 1], x[2 * cells + 2 : 3 * cells + 2]
    motion = limits.feed * v, limits.acceleration * a, limits.jerk * j, steps * x[-cells:]
    time = float(motion[3].sum())
    return Found(time, time * slowed(path, places, motion))


def shares_of_axes(axes, ends, motion):
    """What each axis takes of its acceleration and jerk, at the begins and at the ends of cells."""
    feed, acceleration, jerk = motion
    for (e, k, c), part in zip(ends, (slice(0, -1), slice(1, None))):
        v, a = feed[part], acceleration[part]
        for i, (_, most, most_jerk) in enumerate(axes):
            tangent, bend, change = (casadi.DM(vector[:, i]) for vector in (e, k, c))
            if not (numpy.any(e[:, i]) or numpy.any(k[:, i])):
                continue
            if most is not None:
                yield (tangent * a + bend * v**2) / most
            if most_jerk is not None:
                yield (tangent * jerk + 3 * bend * v * a + change * v**3) / most_jerk


def slowed(path, places, motion):
    """By how much longer the motion must take for keeping every limit inside cells too."""
    limits, worst = path.limits, 1.0
    v, a, j, h = motion
    number = numpy.searchsorted(path.begins, (places[1:] + places[:-1]) / 2) - 1
    for look in range(LOOKS + 1):
        t = h * look / LOOKS
        place = numpy.minimum(places[:-1] + v * t + a * t**2 / 2 + j * t**3 / 6, places[1:])
        feed, acceleration = v + a * t + j * t**2 / 2, a + j * t
        worst = max(worst, (numpy.abs(acceleration) / limits.acceleration).max() ** (1 / 2), (numpy.abs(j) / limits.jerk).max() ** (1 / 3))
        for span in range(len(path.begins)):
            here = number == span
            if not here.any():
                continue
            tangent, bend, change = path.curve.bends(span, place[here])
            f, b, k = feed[here], acceleration[here], j[here]
            worst = max(worst, (f / limits.most(tangent, bend)).max())
            for what, share in limits.of_axes((tangent, bend, change), (f, b, k)):
                worst = max(worst, share.max() ** (1 / 2 if what.startswith("acceleration") else 1 / 3))
    return worst
