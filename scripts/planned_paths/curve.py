"""A NURBS curve by its arc length: tangent, curvature vector and its change, by de Boor's scheme span by span, in numpy."""

import numpy

# Nodes and weights of Gauss and Legendre's rule over a cell from 0 to 1.
NODES, GAUSS = numpy.polynomial.legendre.leggauss(6)
NODES, GAUSS = (NODES + 1) / 2, GAUSS / 2


class Curve:
    """A clamped NURBS curve in the plane or in space; `cells` is into how many parts of even parameter each span is cut for its length."""

    def __init__(self, degree, knots, points, weights, cells):
        weights = numpy.array(weights, float)[:, None]
        points = numpy.array(points, float)
        space = numpy.zeros((len(points), 3))
        space[:, : points.shape[1]] = points
        self.degree, knots = degree, numpy.array(knots, float)
        # Control points of the homogeneous curve and of its derivatives, each with its knots.
        self.levels = [(knots, numpy.hstack([space * weights, weights]))]
        for p in range(degree, max(degree - 3, 0), -1):
            t, control = self.levels[-1]
            gaps = t[p + 1 : p + len(control)] - t[1 : len(control)]
            rise = p * numpy.diff(control, axis=0) / numpy.where(gaps > 0, gaps, 1)[:, None]
            self.levels.append((t[1:-1], rise))
        self.spans = [k for k in range(degree, len(points)) if knots[k] < knots[k + 1]]
        # Of each span: the parameters of its cells' ends, and the arc lengths to them.
        self.cells, at = [], 0.0
        for span in self.spans:
            u = numpy.linspace(knots[span], knots[span + 1], cells + 1)
            s = at + numpy.concatenate([[0.0], numpy.cumsum(self.lengths(span, u[:-1], u[1:]))])
            self.cells.append((u, s))
            at = s[-1]
        self.length = at

    def homogeneous(self, span, order, u):
        """The derivative of this order of (w x, w y, w z, w) at parameters of a span, by the span's own polynomial."""
        if order > self.degree:
            return numpy.zeros((len(u), 4))
        (t, control), p, k = self.levels[order], self.degree - order, span - order
        d = [numpy.broadcast_to(control[k - p + i], (len(u), 4)) for i in range(p + 1)]
        for level in range(1, p + 1):
            for i in range(p, level - 1, -1):
                low, high = t[k - p + i], t[k + 1 + i - level]
                share = ((u - low) / (high - low))[:, None]
                d[i] = (1 - share) * d[i - 1] + share * d[i]
        return d[p]

    def derivatives(self, span, u, most=3):
        """The point and its derivatives to this order."""
        return projected([self.homogeneous(span, order, u) for order in range(most + 1)])

    def lengths(self, span, begin, end):
        """The arc lengths from parameters to parameters of a span."""
        width = end - begin
        total = numpy.zeros(len(width))
        for node, weight in zip(NODES, GAUSS):
            total += weight * numpy.linalg.norm(self.derivatives(span, begin + node * width, 1)[1], axis=1)
        return width * total

    def parameters(self, number, place):
        """The parameters at arc lengths within the span of this number."""
        (u, s), span = self.cells[number], self.spans[number]
        cell = numpy.clip(numpy.searchsorted(s, place, side="right") - 1, 0, len(u) - 2)
        low, high, begin = u[cell], u[cell + 1], s[cell]
        found = low + (high - low) * numpy.clip((place - begin) / (s[cell + 1] - begin), 0, 1)
        for _ in range(2):
            speed = numpy.linalg.norm(self.derivatives(span, found, 1)[1], axis=1)
            found = numpy.clip(found - (begin + self.lengths(span, low, found) - place) / speed, low, high)
        return found

    def bends(self, number, place):
        """Tangent, curvature vector and its derivative by the arc length, at arc lengths within the span of this number."""
        return self.bends_at(number, self.parameters(number, place))

    def bends_at(self, number, u):
        """The same at parameters."""
        return bends(*self.derivatives(self.spans[number], u)[1:])

    def numbers(self, place):
        """Which span places lie in; a knot belongs to the one before it."""
        return numpy.clip(numpy.searchsorted([s[-1] for _, s in self.cells], place, side="left"), 0, len(self.cells) - 1)

    def bends_anywhere(self, place):
        """Tangent, curvature vector and its derivative at arc lengths."""
        number, found = self.numbers(place), numpy.zeros((3, len(place), 3))
        for span in numpy.unique(number):
            found[:, number == span] = self.bends(span, place[number == span])
        return found

    def gaps(self):
        """A curve has none."""
        return numpy.empty(0)

    def joints(self):
        """The arc lengths to the knots inside, with tangent and curvature vector before and after."""
        inner = range(len(self.cells) - 1)
        before = [self.bends_at(k, self.cells[k][0][-1:]) for k in inner]
        after = [self.bends_at(k + 1, self.cells[k + 1][0][:1]) for k in inner]
        sides = [[numpy.array([bend[i][0] for bend in bends]).reshape(-1, 3) for i in range(2)] for bends in (before, after)]
        return numpy.array([self.cells[k][1][-1] for k in inner]), *sides


BINOMIAL = [[1], [1, 1], [1, 2, 1], [1, 3, 3, 1]]


def projected(lifted):
    """Point and derivatives of a curve whose homogeneous points and derivatives these are."""
    w, found = [level[:, 3:] for level in lifted], []
    for order, level in enumerate(lifted):
        rest = level[:, :3]
        for k in range(1, order + 1):
            rest = rest - BINOMIAL[order][k] * w[k] * found[order - k]
        found.append(rest / w[0])
    return found


def bends(first, second, third):
    """Tangent, curvature vector and its derivative by the arc length, from derivatives by a parameter."""
    along = lambda a, b: numpy.sum(a * b, axis=1, keepdims=True)
    speed = numpy.linalg.norm(first, axis=1, keepdims=True)
    tangent = first / speed
    rise = along(tangent, second)
    bend = (second - rise * tangent) / speed**2
    # Of the second derivative of the speed: t' is the speed times the curvature vector.
    gain = speed * along(bend, second) + along(tangent, third)
    change = (third - gain * tangent - rise * speed * bend) / speed**3 - 2 * rise / speed**2 * bend
    return tangent, bend, change
