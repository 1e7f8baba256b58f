"""Lines and arcs of a part program, by a small reader that refuses what it does not know."""

import math
import re

import numpy

WORD = re.compile(r"\s*([A-Z])\s*([-+]?(?:\d+\.?\d*|\.\d+))")
# Words that change neither the path nor its feed.
IDLE = {"G": {4, 9, 40, 43, 43.1, 49, 54, 55, 56, 57, 58, 59, 61, 64, 80, 91.1, 92.1, 94, 98, 99}, "M": {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 30, 48, 49}}
PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}


class UnreadError(Exception):
    """What this reader does not know."""


class Moves:
    """Lines and arcs, one after the other: begin, end and, of an arc, how it turns; lengths in mm, feeds in mm/s."""

    def __init__(self, moves):
        column = lambda key, width=None: numpy.array([move[key] for move in moves], float).reshape((len(moves), *([width] if width else [])))
        self.length_of, self.feeds = column("length"), column("feed")
        self.ends = numpy.cumsum(self.length_of)
        self.begins, self.length = self.ends - self.length_of, self.ends[-1]
        # The tangent is `level (cos φ p + sin φ q) + rise`, with φ = first + rate s; of a line the rate is 0.
        self.p, self.q, self.rise = (column(key, 3) for key in ("p", "q", "rise"))
        self.first, self.rate, self.level = (column(key) for key in ("first", "rate", "level"))
        self.is_gap = column("gap")

    def numbers(self, place):
        return numpy.clip(numpy.searchsorted(self.ends, place, side="left"), 0, len(self.ends) - 1)

    def bends_of(self, number, along):
        """Tangent, curvature vector and its derivative at ways along moves."""
        angle, wide = self.first[number] + self.rate[number] * along, lambda x: x[:, None]
        cos, sin = wide(numpy.cos(angle)), wide(numpy.sin(angle))
        p, q, level, rate = self.p[number], self.q[number], wide(self.level[number]), wide(self.rate[number])
        tangent = level * (cos * p + sin * q) + self.rise[number]
        bend = level * rate * (cos * q - sin * p)
        return tangent, bend, -level * rate**2 * (cos * p + sin * q)

    def bends_anywhere(self, place):
        """The same at arc lengths."""
        number = self.numbers(place)
        return self.bends_of(number, numpy.clip(place - self.begins[number], 0, self.length_of[number]))

    def commanded(self, place):
        """The commanded feed at arc lengths; a joint belongs to the move before it."""
        return self.feeds[self.numbers(place)]

    def joints(self):
        """The arc lengths to the joints of moves, with tangent and curvature vector before and after; behind a gap is none."""
        count = len(self.ends)
        before, after = numpy.arange(count - 1), numpy.arange(1, count)
        ends, begins = self.bends_of(before, self.length_of[:-1]), self.bends_of(after, numpy.zeros(count - 1))
        keep = self.is_gap[1:] == 0
        return self.ends[:-1][keep], [x[keep] for x in ends[:2]], [x[keep] for x in begins[:2]]

    def gaps(self):
        """Places at which a rapid move was left out."""
        return self.begins[1:][self.is_gap[1:] != 0]


def line(begin, end, feed, gap):
    way = [b - a for a, b in zip(begin, end)]
    length = math.hypot(*way)
    tangent = [x / length for x in way]
    return {"length": length, "feed": feed, "p": tangent, "q": [0.0] * 3, "rise": [0.0] * 3, "first": 0.0, "rate": 0.0, "level": 1.0, "gap": gap}


def arc(begin, end, words, clockwise, plane, scale, feed, gap):
    """An arc or a helix about the centre that I, J and K or R say."""
    one, other, normal = plane
    if "R" in words:
        radius, chord = words["R"] * scale, [end[one] - begin[one], end[other] - begin[other]]
        half = math.hypot(*chord) / 2
        if half == 0 or half > abs(radius) * (1 + 1e-3):
            raise UnreadError("an arc that its radius does not reach")
        height = math.sqrt(max(radius**2 - half**2, 0.0)) * (1 if clockwise == (radius < 0) else -1)
        aside = height / (2 * half)
        centre = [(begin[one] + end[one]) / 2 - aside * chord[1], (begin[other] + end[other]) / 2 + aside * chord[0]]
    else:
        centre = [begin[axis] + words.get("IJK"[axis], 0.0) * scale for axis in (one, other)]
    from_centre = [begin[one] - centre[0], begin[other] - centre[1]]
    to_centre = [end[one] - centre[0], end[other] - centre[1]]
    radius = math.hypot(*from_centre)
    if radius == 0 or abs(math.hypot(*to_centre) - radius) > 1e-9 + 1e-7 * radius:
        raise UnreadError("an arc whose ends are not equally far from its centre")
    first = math.atan2(from_centre[1], from_centre[0])
    turn = (math.atan2(to_centre[1], to_centre[0]) - first) * (-1 if clockwise else 1) % (2 * math.pi)
    if turn * radius < 1e-6:
        turn += 2 * math.pi
    if words.get("P", 1) != 1:
        raise UnreadError("an arc of several turns")
    way, sense = radius * turn, -1 if clockwise else 1
    up = end[normal] - begin[normal]
    length = math.hypot(way, up)
    unit = lambda axis: [float(k == axis) for k in range(3)]
    rise = [x * up / length for x in unit(normal)]
    return {
        "length": length, "feed": feed, "p": unit(one), "q": unit(other), "rise": rise, "first": first + sense * math.pi / 2,
        "rate": sense * turn / length, "level": way / length, "gap": gap,
    }  # fmt: skip


def blocks(text):
    """The words of each block, without comments."""
    for row in text.upper().splitlines():
        row = re.sub(r"\([^)]*\)", "", row).split(";")[0].strip()
        if row in ("", "%") or re.fullmatch(r"[O:]\d+", row):
            continue
        if row.startswith("/"):
            raise UnreadError("a block that may be left out")
        words, at = [], 0
        while at < len(row):
            match = WORD.match(row, at)
            if not match:
                raise UnreadError(f"`{row[at:][:20]}`")
            words.append((match[1], float(match[2])))
            at = match.end()
        yield words


def read(text, machine_feed):
    """The moves of a program at feed; one from a place that the program has not said is left out."""
    place, motion, plane, scale, is_relative, feed, gap = [None] * 3, None, PLANES[17], 1.0, False, machine_feed, 1.0
    moves = []
    for words in blocks(text):
        codes = [value for letter, value in words if letter == "G"]
        rest = {letter: value for letter, value in words if letter not in "DGHMNST"}
        is_home = False
        for code in codes:
            if code in (0, 1, 2, 3):
                motion = code
            elif code in PLANES:
                plane = PLANES[code]
            elif code in (20, 21):
                scale = 25.4 if code == 20 else 1.0
            elif code in (90, 91):
                is_relative = code == 91
            elif code in (28, 30):
                is_home = True
            elif code not in IDLE["G"]:
                raise UnreadError(f"G{code:g}")
        for letter, value in words:
            if letter == "M" and value not in IDLE["M"]:
                raise UnreadError(f"M{value:g}")
        unknown = set(rest) - set("XYZIJKRFP")
        if unknown:
            raise UnreadError(f"the word {min(unknown)}")
        if "F" in rest:
            feed = rest["F"] * scale / 60 or machine_feed
        if is_home:
            # These axes begin anew.
            named = set("XYZ") & set(rest) or set("XYZ")
            place, gap = [None if letter in named else at for letter, at in zip("XYZ", place)], 1.0
            continue
        if 4 in codes or not set("XYZIJ") & set(rest):
            continue
        to = list(place)
        for axis, letter in enumerate("XYZ"):
            if letter in rest:
                if is_relative and place[axis] is None:
                    raise UnreadError("a way from a place that is not said")
                to[axis] = rest[letter] * scale + (place[axis] if is_relative else 0.0)
        if motion is None:
            raise UnreadError("a place without a motion")
        # Where an axis has not been said, it stands still.
        known = [axis for axis in range(3) if to[axis] is not None]
        is_new = any(place[axis] is None for axis in known)
        if motion == 0 or is_new:
            gap = 1.0 if motion == 0 and to != place or is_new else gap
        else:
            begin, end = [x or 0.0 for x in place], [x or 0.0 for x in to]
            if motion == 1:
                if begin != end:
                    moves.append(line(begin, end, feed, gap))
                    gap = 0.0
            else:
                moves.append(arc(begin, end, rest, motion == 2, plane, scale, feed, gap))
                gap = 0.0
        place = to
        if any(letter == "M" and value in (2, 30) for letter, value in words):
            break
    if not moves:
        raise UnreadError("no move at feed")
    return Moves(moves)
