"""What a machine file limits, in mm and s, by the formulas of the book."""

import math

import numpy

from .cases import ACCELERATION, ACROSS, AXIS_KEYS, CHORD_ERROR, FEED, JERK, PERIOD


class Limits:
    """The limits of a machine, in mm and s."""

    def __init__(self, machine):
        self.period, self.error = machine[PERIOD] / 1000, machine.get(CHORD_ERROR, 0.001)
        self.feed, self.acceleration, self.jerk, self.across = machine[FEED], machine[ACCELERATION], machine[JERK], machine.get(ACROSS)
        self.junction, self.deviation = machine.get("junction", "stop"), machine.get("junction_deviation_mm")
        self.axes = [[machine.get("axes", {}).get(axis, {}).get(key) for key in AXIS_KEYS] for axis in "xyz"]

    def feeds(self, tangent, bend, commanded):
        """Each largest feed, by its name, at places with these tangents, curvature vectors and commanded feeds."""
        with numpy.errstate(divide="ignore"):
            radius = 1 / numpy.linalg.norm(bend, axis=1)
            half_chord = numpy.sqrt(self.error * numpy.maximum(2 * radius - self.error, 0))
            yield "feed", numpy.broadcast_to(commanded, radius.shape)
            yield "chord error", 2 / self.period * numpy.where(radius > self.error, half_chord, radius)
            if self.across is not None:
                yield "acceleration across", numpy.sqrt(self.across * radius)
            for i, (velocity, _, _) in enumerate(self.axes):
                if velocity is not None:
                    yield f"velocity of {'XYZ'[i]}", velocity / numpy.abs(tangent[:, i])

    def most(self, tangent, bend):
        """V, the least of them at the machine's feed."""
        return numpy.minimum.reduce([feed for _, feed in self.feeds(tangent, bend, self.feed)])

    def of_axes(self, geometry, motion):
        """What each axis takes of its acceleration and jerk, as a share, along tangent, curvature vector and change with feed, acceleration and
        jerk along the path."""
        (e, k, c), (v, a, j) = geometry, motion
        for i, (_, acceleration, jerk) in enumerate(self.axes):
            if acceleration is not None:
                yield f"acceleration of {'XYZ'[i]}", numpy.abs(e[:, i] * a + k[:, i] * v**2) / acceleration
            if jerk is not None:
                yield f"jerk of {'XYZ'[i]}", numpy.abs(e[:, i] * j + 3 * k[:, i] * v * a + c[:, i] * v**3) / jerk

    def slow(self, feed, bend, change):
        """A lower feed, where single axes would take all of their acceleration and jerk for turning: only for the width of cells."""
        with numpy.errstate(divide="ignore"):
            for i, (_, acceleration, jerk) in enumerate(self.axes):
                if acceleration is not None:
                    feed = numpy.minimum(feed, numpy.sqrt(acceleration / numpy.abs(bend[:, i])))
                if jerk is not None:
                    feed = numpy.minimum(feed, numpy.cbrt(jerk / numpy.abs(change[:, i])))
        return feed

    def over_step(self, step):
        """The largest feed at a knot where the curvature vector steps by so much."""
        rows = [(jerk, abs(by)) for (_, _, jerk), by in zip(self.axes, step) if jerk is not None and abs(by) > 1e-9]
        return min((math.sqrt(2 / 3 * jerk * self.period / by) for jerk, by in rows), default=math.inf)

    def over_corners(self, turn):
        """The largest feed over corners that turn by so many radians: a rest where a corner is none to pass."""
        if self.junction == "deviation":
            # As if rounded within the deviation, at the acceleration along the path or that across, whichever is less.
            cos = numpy.cos(turn / 2)
            return numpy.sqrt(min(self.acceleration, self.across or math.inf) * self.deviation * cos / (1 - cos))
        even = min(4 * self.error / (self.feed * self.period), self.acceleration * self.period / self.feed)
        return numpy.where(turn > even, 0.0, math.inf)
