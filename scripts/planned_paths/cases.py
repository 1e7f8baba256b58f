"""The published curves and those drawn by a seed, each with a machine, and the part files that the command reads."""

import math
import random

SEED, DRAWN, WITH_AXES = 63, 50, 20
PERIOD, FEED, ACCELERATION, JERK = "interpolation_period_ms", "feedrate_mm_per_s", "acceleration_mm_per_s2", "jerk_mm_per_s3"
CHORD_ERROR, ACROSS = "chord_error_mm", "centripetal_acceleration_mm_per_s2"
AXIS_KEYS = ["velocity_mm_per_s", ACCELERATION, JERK]
# Curve, period in ms, acceleration in mm/s², jerk in mm/s³.
PUBLISHED = [
    ("seed-000", 3, 5e3, 4e5),
    ("seed-000", 3, 5e3, 4e4),
    ("seed-000", 3, 5e3, 4e6),
    ("seed-000", 1, 5e3, 4e5),
    ("seed-000", 1, 5e3, 4e4),
    ("seed-003", 3, 5e3, 4e5),
    ("seed-003", 3, 5e3, 4e4),
    ("seed-003", 3, 5e3, 4e6),
    ("seed-003", 3, 1e3, 2e4),
    ("seed-003", 3, 1e3, 2e3),
    ("circle", 3, 5e3, 4e5),
    ("circle", 3, 5e3, 4e4),
]
HALF = math.sqrt(0.5)
# data/seed-000.toml, data/seed-003.nc, and a full circle of four quarters.
CURVES = {
    "seed-000": {
        "degree": 3,
        "knots": [0, 0, 0, 0, 0.25, 0.5, 0.75, 1, 1, 1, 1],
        "control_points_mm": [[150, 150], [0, 0], [0, 300], [150, 150], [300, 0], [300, 300], [150, 150]],
        "weights": [1] * 7,
    },
    "seed-003": {
        "degree": 3,
        "knots": [0, 0, 0, 0, 0.1836, 0.2781, 0.3837, 0.5474, 0.7104, 0.8049, 1, 1, 1, 1],
        "control_points_mm": [
            [0, 15], [10, 34.1], [20, 10.1], [30, 16.1], [40, 0.9], [50, 38], [60, 2.9], [65, 8.9], [70, 26.1], [80, 5.9],
        ],
        "weights": [1, 2, 1.5, 1, 1, 2, 1, 1, 2, 1],
    },
    "circle": {
        "degree": 2,
        "knots": [0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1],
        "control_points_mm": [[10, 0], [10, 10], [0, 10], [-10, 10], [-10, 0], [-10, -10], [0, -10], [10, -10], [10, 0]],
        "weights": [1, HALF, 1, HALF, 1, HALF, 1, HALF, 1],
    },
}  # fmt: skip


class Case:
    """A curve and a machine by the keys of their tables in a part file, under a name."""

    def __init__(self, name, curve, machine):
        self.name, self.curve, self.machine = name, curve, machine

    def text(self):
        """The part file."""
        axes = self.machine.get("axes", {})
        lines = ["[curve]", *(f"{key} = {value}" for key, value in self.curve.items()), "", "[machine]"]
        lines += [f"{key} = {value!r}" for key, value in self.machine.items() if key != "axes"]
        for axis, limits in axes.items():
            lines += [f"[machine.axes.{axis}]", *(f"{key} = {value!r}" for key, value in limits.items())]
        return "\n".join(lines) + "\n"

    def write(self, folder):
        path = folder / f"{self.name}.toml"
        path.write_text(self.text(), encoding="utf-8")
        return path


def published():
    for number, (name, period, acceleration, jerk) in enumerate(PUBLISHED, 1):
        machine = {PERIOD: period, FEED: 200.0, ACCELERATION: acceleration, JERK: jerk, CHORD_ERROR: 5e-4}
        yield Case(f"published-{number:02}", CURVES[name], machine)


def drawn():
    """Each curve by a seed of its own, so that none depends on how many there are."""
    for number in range(1, DRAWN + 1):
        yield drawn_case(random.Random(f"{SEED} curve {number}"), f"drawn-{number:02}", number, False)
    for number in range(1, WITH_AXES + 1):
        yield drawn_case(random.Random(f"{SEED} axes {number}"), f"axes-{number:02}", number, True)


def drawn_case(draw, name, number, with_axes):
    """A curve whose degree, weights, dimensions and shape go through all their values in turn, and whose figures are drawn."""
    degree, is_rational, in_space = 2 + number % 4, number // 4 % 2 == 1, number // 8 % 2 == 1
    size = log_uniform(draw, 8, 300)
    count = degree + 1 + round(log_uniform(draw, 2, 50))
    shape = [scattered, zigzag, loops][number % 3]
    points = [[round(x, 4) for x in point[: 3 if in_space else 2]] for point in shape(draw, count, size)]
    inner = count - degree
    steps = [1.0] * inner if number // 2 % 2 else [draw.uniform(0.4, 1.6) for _ in range(inner)]
    knots = [round(sum(steps[:k]) / sum(steps), 6) for k in range(1, inner)]
    weights = [round(log_uniform(draw, 0.4, 2.5), 3) if is_rational else 1.0 for _ in range(count)]
    curve = {
        "degree": degree,
        "control_points_mm": points,
        "weights": weights,
        "knots": [0.0] * (degree + 1) + knots + [1.0] * (degree + 1),
    }
    acceleration = three_digits(log_uniform(draw, 500, 10000))
    machine = {
        PERIOD: draw.choice([0.5, 1.0, 2.0, 3.0]),
        FEED: three_digits(log_uniform(draw, 30, 400)),
        ACCELERATION: acceleration,
        JERK: three_digits(acceleration * log_uniform(draw, 4, 800)),
        CHORD_ERROR: draw.choice([2e-4, 5e-4, 1e-3, 5e-3]),
    }
    if draw.random() < 0.2:
        machine[ACROSS] = three_digits(acceleration * log_uniform(draw, 0.2, 2))
    if with_axes:
        machine["axes"] = drawn_axes(draw, machine, len(points[0]))
    return Case(name, curve, machine)


def drawn_axes(draw, machine, dimensions):
    """Limits of one axis or of all, of some kinds or of all, from far below those of the path to a little above."""
    all_axes = draw.random() < 0.7
    found = {}
    for axis in "xyz"[:dimensions] if all_axes else draw.choice("xyz"[:dimensions]):
        kinds = AXIS_KEYS if draw.random() < 0.7 else [draw.choice(AXIS_KEYS)]
        of_path = dict(zip(AXIS_KEYS, (machine[FEED], machine[ACCELERATION], machine[JERK])))
        found[axis] = {key: three_digits(of_path[key] * log_uniform(draw, 0.15, 1.5)) for key in kinds}
    if dimensions == 2 and draw.random() < 0.3:
        # An axis that stands still.
        found["z"] = {ACCELERATION: 10.0, JERK: 100.0}
    return found


def scattered(draw, count, size):
    return [[draw.uniform(0, size) for _ in range(3)] for _ in range(count)]


def zigzag(draw, count, size):
    step = size / count
    return [[step * (k + draw.uniform(-0.4, 0.4)), draw.uniform(0, size / 4), draw.uniform(0, size / 4)] for k in range(count)]


def loops(draw, count, size):
    """A spiral, somewhat disturbed."""
    turns = draw.uniform(0.3, 0.9)
    for k in range(count):
        radius, angle = size / 2 * (0.3 + 0.7 * k / count) * draw.uniform(0.85, 1.15), turns * k
        yield [radius * math.cos(angle), radius * math.sin(angle), size * k / count / 3]


def log_uniform(draw, low, high):
    return math.exp(draw.uniform(math.log(low), math.log(high)))


def three_digits(value):
    return float(f"{value:.3g}")
