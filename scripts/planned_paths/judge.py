"""A plan against every limit at ten places a period, along a path that this project's code has not computed."""

import math

import numpy

# Samples a period, and samples that are looked at together.
A_PERIOD, TOGETHER = 10, 200_000
# A tangent that turns by less is even, in radians.
EVEN = 2**-12
# How far from the ends of a stage the curve is looked at, in mm.
EDGE = 1e-8
# How far from a rest a joint may be that is rested at, in mm: sums of many lengths are rounded.
AT_REST = 1e-7
# A stage that changes the feed by less than this share of the commanded one only rounds it: with a constant feed in its place nothing is different.
ROUNDED = 1e-12


class Plan:
    """The stages of a plan as `feedbits plan --json` prints them."""

    def __init__(self, plan):
        stages = plan["stages"]
        column = lambda key: numpy.array([stage[key] for stage in stages], float)
        self.time, self.length = column("time_s"), column("length_mm")
        self.start_feed, self.end_feed = column("start_feed_mm_per_s"), column("end_feed_mm_per_s")
        self.is_cosine = numpy.array([stage["coefficients"] is None for stage in stages])
        self.powers = numpy.array([stage["coefficients"] or [0.0] * 4 for stage in stages], float)
        self.begins = numpy.concatenate([[0.0], numpy.cumsum(self.length)[:-1]])
        self.periods, self.total_time, self.path = plan["periods"], plan["time_s"], plan["length_mm"]

    def hastened(self, factor):
        """Makes the same way in less time: what a plan is that keeps no limit that it has used up."""
        self.time = self.time / factor
        self.start_feed, self.end_feed = self.start_feed * factor, self.end_feed * factor
        self.powers = self.powers * factor ** numpy.arange(1, 5)

    def motion(self, stage, time):
        """Place, feed, acceleration and jerk at times within stages."""
        a0, a1, a2, a3 = self.powers[stage].T
        way = time * (a0 + time * (a1 / 2 + time * (a2 / 3 + time * a3 / 4)))
        feed, acceleration, jerk = a0 + time * (a1 + time * (a2 + time * a3)), a1 + time * (2 * a2 + 3 * time * a3), 2 * a2 + 6 * time * a3
        round_ = self.is_cosine[stage]
        if round_.any():
            # V = V_s + (V_e - V_s) (1 - cos πx)/2.
            one, t = stage[round_], time[round_]
            change, rate = (self.end_feed - self.start_feed)[one] / 2, math.pi / self.time[one]
            mean = (self.end_feed + self.start_feed)[one] / 2
            angle = rate * t
            way[round_], feed[round_] = mean * t - change * numpy.sin(angle) / rate, mean - change * numpy.cos(angle)
            acceleration[round_], jerk[round_] = change * rate * numpy.sin(angle), change * rate**2 * numpy.cos(angle)
        return self.begins[stage] + way, feed, acceleration, jerk

    def samples(self, period):
        """Stages and times within them, in parts: ten a period and both ends of each stage."""
        counts = numpy.maximum(numpy.ceil(A_PERIOD * self.time / period).astype(int), 2) + 1
        ends = numpy.cumsum(counts)
        first = 0
        while first < len(counts):
            # A long stage is a part of its own.
            last = max(first + 1, int(numpy.searchsorted(ends, (ends[first - 1] if first else 0) + TOGETHER)))
            stage = numpy.repeat(numpy.arange(first, last), counts[first:last])
            index = numpy.arange(len(stage)) - numpy.repeat(numpy.cumsum(counts[first:last]) - counts[first:last], counts[first:last])
            yield stage, self.time[stage] * (index / (counts[stage] - 1))
            first = last

    def feeds_at(self, place):
        """The feeds at places, by bisection within their stages."""
        stage = numpy.clip(numpy.searchsorted(self.begins, place, side="right") - 1, 0, len(self.begins) - 1)
        low, high = numpy.zeros(len(place)), self.time[stage].copy()
        for _ in range(60):
            middle = (low + high) / 2
            is_before = self.motion(stage, middle)[0] < place
            low, high = numpy.where(is_before, middle, low), numpy.where(is_before, high, middle)
        return numpy.where(self.from_rest(place) < AT_REST, 0, self.motion(stage, low)[1])

    def from_rest(self, place):
        """How far places are from the nearest rest."""
        rests = numpy.concatenate([[0.0], (self.begins + self.length)[self.end_feed == 0], [math.inf]])
        after = numpy.clip(numpy.searchsorted(rests, place), 1, len(rests) - 1)
        return numpy.minimum(numpy.abs(place - rests[after]), numpy.abs(place - rests[after - 1]))


class Taken:
    """The largest share of each limit, and where that is."""

    def __init__(self):
        self.most = {}

    def add(self, what, shares, places):
        if len(shares):
            # A share that is no number is above every other.
            k = int(numpy.argmax(shares))
            if what not in self.most or not shares[k] <= self.most[what][0]:
                self.most[what] = float(shares[k]), float(places[k])


def taken(plan, path, limits, commanded):
    """What a plan takes of each limit; `commanded` is the feed at places."""
    found = Taken()
    for stage, time in plan.samples(limits.period):
        place, feed, acceleration, jerk = plan.motion(stage, time)
        # At the ends of a stage the curve is that within it: what lies behind a knot or a joint is the next one's.
        edge = numpy.minimum(EDGE, plan.length[stage] / 4)
        inside = numpy.clip(place, plan.begins[stage] + edge, plan.begins[stage] + plan.length[stage] - edge)
        geometry = path.bends_anywhere(inside)
        from_rest = plan.from_rest(place)
        for what, most in limits.feeds(geometry[0], geometry[1], commanded(inside)):
            # No chord between two places so near a rest leaves the path by more than E.
            counts = from_rest > limits.error * (1 + 1e-9) if what == "chord error" else slice(None)
            found.add(what, (feed / most)[counts], place[counts])
        is_level = numpy.abs(plan.end_feed - plan.start_feed)[stage] <= ROUNDED * limits.feed
        acceleration, jerk = numpy.where(is_level, 0, acceleration), numpy.where(is_level, 0, jerk)
        found.add("acceleration", numpy.abs(acceleration) / limits.acceleration, place)
        found.add("jerk", numpy.abs(jerk) / limits.jerk, place)
        for what, share in limits.of_axes(geometry, (feed, acceleration, jerk)):
            found.add(what, share, place)
    at_joints(plan, path, limits, found)
    return found.most


def at_joints(plan, path, limits, found):
    """Breaks of the tangent, and steps of the curvature vector, at the feeds there."""
    place, (e0, k0), (e1, k1) = path.joints()
    if not len(place):
        return
    feed = plan.feeds_at(place)
    turn = 2 * numpy.arcsin(numpy.minimum(numpy.linalg.norm(e1 - e0, axis=1) / 2, 1))
    is_even = turn <= EVEN
    for i, (_, _, jerk) in enumerate(limits.axes):
        if jerk is not None:
            step = numpy.abs(k1 - k0)[:, i] * feed**2 / (2 / 3 * jerk * limits.period)
            found.add(f"step of the acceleration of {'XYZ'[i]}", step[is_even], place[is_even])
    broken = numpy.flatnonzero(~is_even)
    most = limits.over_corners(turn[broken])
    with numpy.errstate(divide="ignore", invalid="ignore"):
        found.add("corner", numpy.where(feed[broken] == 0, 0, feed[broken] / most), place[broken])


def inconsistent(plan, limits, path):
    """What of a plan does not fit together: its stages with each other, with its time, and with the path's length and gaps."""
    length = path.length
    if abs(plan.path - length) > 1e-9 * length + 1e-9 or abs(plan.length.sum() - length) > 1e-9 * length + 1e-9:
        yield f"{plan.length.sum()} mm of stages and {plan.path} mm of path, {length} mm here"
    moving = path.gaps()[plan.from_rest(path.gaps()) > AT_REST]
    if len(moving):
        yield f"it goes on where a rapid move is left out, {moving[0]:.6f} mm"
    stage = numpy.arange(len(plan.time))
    place, feed, acceleration, _ = plan.motion(stage, plan.time)
    _, first, start, _ = plan.motion(stage, 0 * plan.time)
    for what, off, unit in [
        ("way", place - plan.begins - plan.length, length),
        ("feed at an end", feed - plan.end_feed, limits.feed),
        ("feed from stage to stage", first[1:] - plan.end_feed[:-1], limits.feed),
        ("acceleration from stage to stage", start[1:] - acceleration[:-1], limits.acceleration),
        ("feed at both ends of the path", numpy.array([first[0], plan.end_feed[-1]]), limits.feed),
        ("acceleration at both ends of the path", numpy.array([start[0], acceleration[-1]]), limits.acceleration),
    ]:
        if len(off) and numpy.abs(off).max() > 1e-7 * unit:
            yield f"{what}: off by {numpy.abs(off).max():.3g} at {place[int(numpy.abs(off).argmax())]:.6f} mm"
    if abs(plan.periods * limits.period - plan.total_time) > 1e-9 * plan.total_time:
        yield f"{plan.periods} periods in {plan.total_time} s"
    # From rest to rest whole periods pass.
    passed = numpy.cumsum(plan.time)[plan.end_feed == 0] / limits.period
    if numpy.abs(passed - numpy.round(passed)).max(initial=0) > 1e-3:
        yield f"a rest at {passed[numpy.abs(passed - numpy.round(passed)).argmax()]} periods"
