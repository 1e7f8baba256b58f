"""A compiled part, as `feedbits compile` writes it: the constants of a period, and the same part with more runs that are hard on it."""

import random
import re

PERIOD = 1 << 32


class Part:
    def __init__(self, text):
        self.text = text
        number = re.search(r"pub type Number = (?:real::FixedPoint<real::fixed::types::(\w+)>|(f\d+));", text)
        self.format = number[1] or number[2]
        self.fraction = int(re.match(r"I\d+F(\d+)", self.format)[1]) if number[1] else None
        self.evaluations = int(re.search(r"max_evaluations: (\d+)", text)[1])
        self.degree = int(re.search(r"degree: (\d+)", text)[1])
        self.rational = not re.search(r"weights: &\[\s*\]", text)
        self.dimension = int(re.search(r"PieceInterpolator<'static, Number, (\d)>", text)[1])
        self.pieces = [self.piece(m) for m in re.finditer(r"Piece \{ .*? \},", text)]
        self.stages = [
            (int(m[1]), self.number(m[2]), self.number(m[3]))
            for m in re.finditer(r"LengthStage \{ duration: (\d+),.*?feed: ([^,]*), change: ([^,]*),", text)
        ]
        self.sections = [tuple(map(int, m)) for m in re.findall(r"Section \{ pieces: (\d+)\.\.(\d+), stages: (\d+)\.\.(\d+) \}", text)]
        self.landing_step = self.number(re.search(r"landing_step: ([^,]*),", text)[1])

    def number(self, text):
        cut = re.fullmatch(r"\w+\((-?\d+)\)", text)
        return int(cut[1]) / 2**self.fraction if cut else float(text)

    def written(self, value):
        return f"{self.format.lower()}({round(value * 2**self.fraction)})" if self.fraction else repr(float(value))

    def piece(self, found):
        """The step over the whole piece, the least and the greatest step per chord, and how the next piece joins."""
        whole = 1.0 if self.fraction is None else 2.0 ** int(re.search(r" step_exponent: (-?\d+)", found[0])[1])
        least, greatest = (self.number(n) for n in re.search(r"step_per_chord: \[(.*), (.*)\]", found[0]).groups())
        return whole, (least, greatest), re.search(r"Joint::(\w+)", found[0])[1]

    @property
    def longest(self):
        """The longest chord of a period, in chord units: the plan's greatest feed, and in its last period a landing step more."""
        return max(max(feed, feed + change) for _, feed, change in self.stages) + self.landing_step

    @property
    def joints(self):
        """J: the most joints that a period may touch, the end of the path among them. A piece is passed from end to end only by a chord
        that is longer than the piece's whole step over its greatest step per chord."""
        shares = [whole / greatest / self.longest for whole, (_, greatest), _ in self.pieces]
        most = 0
        for first in range(len(shares)):
            count, left = 0, 1.0
            while first + count < len(shares) and shares[first + count] <= left:
                left -= shares[first + count]
                count += 1
            most = max(most, count)
        return 1 + most

    @property
    def stages_in_last_period(self):
        """S: the most stages that the last period of a section may touch. All other periods read from the table what they cross."""
        most = 0
        for _, _, first, last in self.sections:
            durations = [duration for duration, _, _ in self.stages[first:last]]
            left, count = (sum(durations) - 1) % PERIOD + 1, 0
            while left > 0:
                count += 1
                left -= durations[-count]
            most = max(most, count)
        return most

    @property
    def properties(self):
        """What a fact may not hold with."""
        found = set()
        if "StageShape::Cosine" in self.text:
            found.add("cosine")
        if any(joint == "Breaks" for _, _, joint in self.pieces):
            found.add("corners")
        if self.rational or self.degree != 3:
            found.add("other than plain cubics")
        return found

    def with_hard_runs(self, runs, seed):
        """The same part with more runs: from the begin of a piece over its end and that of the next one, mostly where the polynomial
        changes there, at feeds that jump and phases that are drawn. Some schedules end before the way does. No residual is small
        enough, so that a period ends its evaluations only where they change nothing any more, or when all are used up."""
        draw = random.Random(seed)
        stages, crossings, sections = [], [], []
        inner = range(len(self.pieces) - 1)
        hard = [index for index in inner if self.pieces[index][2] != "Continues"] or inner
        for _ in range(runs):
            begin = draw.choice(hard if draw.random() < 0.7 else inner)
            end = min(begin + draw.choice([2, 3]), len(self.pieces))
            way = sum(2 * whole / (least + greatest) for whole, (least, greatest), _ in self.pieces[begin:end])
            start = len(self.stages) + len(stages)
            # The rest of the way is travelled in landing steps, which are short and many.
            share = 0.9 if draw.random() < 0.1 else 1.3
            drawn = draw_stages(draw, share * way, self.longest - self.landing_step)
            stages += [self.stage(*stage) for stage in drawn]
            crossings += [self.crossing(*crossing) for crossing in crossings_of(drawn)]
            sections.append(f"    Section {{ pieces: {begin}..{end}, stages: {start}..{start + len(drawn)} }},\n")
        text = self.text
        for name in ("residual", "growth", "fluctuation"):
            text = re.sub(rf"(?<= {name}: )[^,]*", self.written(0), text)
        text = insert(text, "        stages: &[\n", "        ],\n", stages)
        text = insert(text, "        crossings: &[\n", "        ],\n", crossings)
        count = len(self.sections) + len(sections)
        text = re.sub(r"(SECTIONS: \[Section; )\d+", rf"\g<1>{count}", text)
        return insert(text, f"SECTIONS: [Section; {count}] = [\n", "];\n", sections)

    def stage(self, duration, feed):
        exponent = duration.bit_length() - 1
        reciprocal = min((1 << (64 + exponent)) // duration, 2**64 - 1)
        share = self.written(min(PERIOD / duration, 1 - 2.0**-20))
        numbers = f"period_share: {share}, feed: {self.written(feed)}, change: {self.written(0)}, shape: StageShape::Steady"
        return f"            LengthStage {{ duration: {duration}, reciprocal: {reciprocal}, reciprocal_exponent: {exponent}, {numbers} }},\n"

    def crossing(self, rest, time, distance):
        stages = 1 if rest else 0
        numbers = f"rest: {max(rest - 1, 0)}, time: {time}, stages: {stages}, distance: {self.written(distance)}"
        return f"            Crossing {{ {numbers} }},\n"


def draw_stages(draw, way, longest):
    """Stages of constant feed, each of more than a period, that together lead over a way."""
    found, left = [], way
    while left > 0:
        feed = longest * draw.choice([draw.random(), draw.random() ** 3, 1.0])
        duration = int(PERIOD * (1 + draw.random() ** 3 * draw.choice([2, 40])))
        found.append((duration, feed))
        left -= duration / PERIOD * feed
    return found


def crossings_of(stages):
    """For each stage: what is left of it where its last period begins, the time of the next stage behind that, and the distance."""
    time, found = 0, []
    for index, (duration, feed) in enumerate(stages):
        rest = (duration - time) % PERIOD or PERIOD
        if index + 1 == len(stages):
            found.append((0, 0, 0))
            break
        time = PERIOD - rest
        found.append((rest, time, feed * rest / PERIOD + stages[index + 1][1] * time / PERIOD))
    return found


def insert(text, after, before, lines):
    """Puts lines at the end of a list."""
    start = text.index(after)
    end = text.index(before, start)
    return text[:end] + "".join(lines) + text[end:]
