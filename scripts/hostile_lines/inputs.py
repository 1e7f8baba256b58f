"""The command lines, files, numbers and names of which scripts/hostile makes its cases."""

import functools
import math
import os
import re
import stat

from .watched_run import MARK, ROOT

PART = b"G21 G90\nG0 X0 Y0\nG1 X3 F900\nG2 X5 Y2 J2\nG1 Y4\nM2\n"
# A quarter of a circle in moves of one degree.
FINE = b"G21 G90\nG0 X10 Y0\nF900\n" + b"".join(
    b"G1 X%.5f Y%.5f\n" % (10 * math.cos(math.radians(degrees)), 10 * math.sin(math.radians(degrees))) for degrees in range(1, 91)
)
MACHINE = """[machine]
interpolation_period_ms = 1
feedrate_mm_per_s = 20
acceleration_mm_per_s2 = 1000
jerk_mm_per_s3 = 40000
chord_error_mm = 0.001
fluctuation_limit = 1e-4
parameter_tolerance = 1e-10
max_iterations = 8
s_stops = true
position_increment_mm = 1e-5
centripetal_acceleration_mm_per_s2 = 900
junction = "velocity-jump"
[machine.axes.x]
velocity_mm_per_s = 100
acceleration_mm_per_s2 = 1500
jerk_mm_per_s3 = 50000
velocity_jump_mm_per_s = 2
"""
DEVIATION = MACHINE.replace('"velocity-jump"', '"deviation"\njunction_deviation_mm = 0.01').replace("velocity_jump_mm_per_s = 2\n", "")
CURVE = """[curve]
shape = "nurbs"
move = "feed"
feedrate_mm_per_s = 15
exact_stop = true
degree = 3
control_points_mm = [[0, 0], [1, 2.5], [3, 1], [4, 0], [5, 2]]
weights = [1, 2, 0.5, 1, 1]
knots = [0, 0, 0, 0, 0.5, 1, 1, 1, 1]
"""
TRIGONOMETRIC = '[curve]\nshape = "trigonometric"\ncontrol_points_mm = [[0, 0], [1, 3], [4, 3.5], [5, 0.5]]\nlambda = 1.0\nk = -0.5\n'
SERVO = (ROOT / "data" / "servo.toml").read_text()
INERTIA = "[servo]\nposition_gain_per_s = 50\nvelocity_lag_ms = 0.4\nload_inertia_256ths = 512\n"
TARGET = """name = "mine"
title = "my own"
kind = "fpga"
measure = "cycles"
issue_per_cycle = 1
calibrated = false
[[clock]]
max_bits = 32
mhz = 96
source = "me"
[[unit]]
name = "multiplier"
count = 1
[[operation]]
name = "mul"
numbers = "fixed"
max_bits = 64
per_bit = 0
per_fraction_bit = 0
busy = 1
unit = "multiplier"
dsp_blocks = 1
source = "me"
confidence = "low"
[operation.cycles]
low = 1
typical = 1
high = 2
"""
# Rows of a log, every 3 ms, whose axes stand, go and stand.
LOG = "time,x,y,z,line\n" + "".join(f"{0.003 * row:.3f},{min(max(row - 9, 0), 30) * 0.01:.4f},0,0,2\n" for row in range(60))
SETTINGS = "$11=0.010\n$100=80\n$101=80\n$110=5000\n$111=5000\n$112=500\n$120=400\n$121=400\n$122=100\n"
BARE = {"part.nc": PART, "machine.toml": MACHINE.encode(), "target.toml": TARGET.encode(), "servo.toml": SERVO.encode()}
BARE |= {"log.csv": LOG.encode(), "settings.txt": SETTINGS.encode(), "other.nc": PART.replace(b"Y4", b"Y3")}

MANY_DIGITS = "9" * 10**6
NUMBERS = ["0", "-1", "-0.0", "5e-324", "1e-320", "1e-300", "1e-9", "1e9", "1e300", "1.7976931348623157e308", "4294967296"]
NO_NUMBERS = ["1e999", "inf", "-inf", "nan"]
KEY_VALUES = NUMBERS + NO_NUMBERS + ['"text"', "true", "[]", "[[1]]", "{}", "1979-05-27", "0x10", "18446744073709551616"]
KEY_VALUES += [MANY_DIGITS, f"0.{'0' * 10**6}1", f'"{"x" * 10**6}"']
OPTION_VALUES = NUMBERS + ["1e999", "inf", "nan", "", "text", "x" * 100_000, "9" * 100_000, "1e3", "0x10", "1,1", "1..2", "0..0"]
OPTION_VALUES += ["1e-300..1e300/1000", "0.5..1/1001", "0:100", "0:0,1e300:100", "0:1e-9", "0:0", "1/18446744073709551615", "0/1"]
OPTION_VALUES += ["nan,nan,nan", "1e300,1e300,1e300", "I1F0", "I4F28" + ",I4F28" * 9999, "Q99999999999999999999.1", b"\xff", "a\nb"]
NEVER_TAKEN = (*NO_NUMBERS, "{}", "1979-05-27", b"\xff")

NAMES = {  # of a part, each of which is harmless as a name
    "end of a comment": rf"x*\ int {MARK}(void){{return 666;}} \*.nc",
    "end of a comment, by folders": f"x*/int {MARK};/*.nc",
    "trigraph": f"x*??/int {MARK};.nc",
    "no UTF-8": b"\xff" + MARK.encode() + b".nc",
    "newline": f"a\nint {MARK};\n{MARK} = 1\n.nc",
    "carriage return": f"a\rint {MARK};.nc",
    "script": f'"><script>{MARK}</script>.nc',
    "formula": f"=1+{MARK}.nc",
    "at": f"@{MARK}.nc",
    "option": f"./-rf {MARK}.nc",
    "blanks and quotes": f"a b' \" `{MARK}` $({MARK}) %s %n {{}} \\.nc",
    "G-code": f"x) G0 Z-666 ({MARK}.nc",
    "terminal": f"\x1b]0;{MARK}\x07.nc",
    "direction": f"\u202e{MARK}\u2028{MARK}.nc",
    "long": f"{MARK}{'n' * 240}.nc",
}
TOO_LONG = "n" * 300
SLASHED = [f"a/{MARK}", f"../{MARK}", "/dev/null", f"*/ int {MARK}; /*", f"<script>{MARK}</script>", f"=1+{MARK}", f"a\\n{MARK}", "n" * 300, ".", "-"]


def commands(part="part.nc", machine="machine.toml"):
    """Command lines by name, each with the files that it writes."""
    of, small = [part, "--machine", machine], ["--formats", "I4F28", "--evaluate", "pieces"]
    compiled, smoothed = ["compile", *of, "--format", "I4F28"], ["smooth", *of, "--tolerance", "0.01"]
    sweep = ["sweep", *of, *small, "--feed", "10..20/2", "--out", "out.jsonl"]
    types = {
        f"size --types {language}": (["size", *of, "--types", language, "--out", f"out.{ending}"], (f"out.{ending}",))
        for language, ending in [("vhdl", "vhd"), ("hls", "hpp"), ("matlab", "m"), ("rust", "rs"), ("c", "h")]
    }
    return {
        "check": (["check", *of], ()),
        "check --json": (["check", *of, "--json", "--out", "out.json"], ("out.json",)),
        "plan": (["plan", *of], ()),
        "plan --out": (["plan", *of, "--out", "out.csv"], ("out.csv",)),
        "plan --json": (["plan", *of, "--json", "--out", "out.json"], ("out.json",)),
        "compare": (["compare", *of, *small], ()),
        "compare --json": (["compare", *of, *small, "--json", "--out", "out.json"], ("out.json",)),
        "compare --report": (["compare", *of, *small, "--report", "out"], ("out",)),
        "interpolate": (["interpolate", *of, "--format", "I4F28", "--out", "out.csv"], ("out.csv",)),
        "interpolate --json": (["interpolate", *of, "--json", "--out", "out.json"], ("out.json",)),
        "interpolate --vectors": (["interpolate", *of, "--format", "I4F28", "--vectors", "out"], ("out",)),
        "compile": ([*compiled, "--out", "out.rs"], ("out.rs",)),
        "compile c": ([*compiled, "--language", "c", "--out", "out"], ("out.c", "out.h")),
        "compile --stream": ([*compiled, "--stream", "--out", "out.stream"], ("out.stream",)),
        "size": (["size", *of], ()),
        "size --json": (["size", *of, "--json", "--out", "out.json"], ("out.json",)),
        **types,
        "sweep": (sweep, ("out.jsonl",)),
        "sweep --report": ([*sweep, "--report", "out"], ("out.jsonl", "out")),
        "servo": (["servo", *of, *small], ()),
        "servo --json": (["servo", *of, *small, "--json", "--out", "out.json", "--plot", "out.svg"], ("out.json", "out.svg")),
        "convert": (["convert", *of, "--to", "g1", "--out", "out.nc"], ("out.nc",)),
        "convert --to g06.2": (["convert", *of, "--to", "g06.2", "--out", "out.nc"], ("out.nc",)),
        "convert --to toml": (["convert", *of, "--to", "toml", "--out", "out.toml"], ("out.toml",)),
        "convert --fit": (["convert", *of, "--fit", "0.01", "--out", "out.nc"], ("out.nc",)),
        "smooth": ([*smoothed, "--out", "out.toml"], ("out.toml",)),
        "smooth to moves": ([*smoothed, "--out", "out.nc"], ("out.nc",)),
        "smooth --json": ([*smoothed, "--json"], ()),
        "merge": (["merge", "sweep.jsonl", "--out", "out.jsonl", "--report", "out"], ("out.jsonl", "out")),
        "papers": (["papers", "--contour"], ()),
        "judge": (["judge", "log.csv", "--machine", machine, "--part", part], ()),
        "judge --json": (["judge", "log.csv", "--machine", machine, "--part", part, "--json", "--out", "out.json"], ("out.json",)),
        "zoo": (["zoo"], ()),
        "machine --from": (["machine", "--from", "settings.txt", "--out", "out.toml"], ("out.toml",)),
        "compare a set": (["compare", part, "other.nc", "--machine", machine, *small], ()),
        "size a set": (["size", part, "other.nc", "--machine", machine, "--json", "--out", "out.json"], ("out.json",)),
    }


# In turn these read a file whose numbers are hostile: the cheap ones of each way through the program.
QUICK = ["plan", "check", "compare", "interpolate", "compile c", "servo", "plan --json", "smooth", "convert", "sweep", "compile --stream"]
# What an option needs beside it: the command line that it is tried in, and words more.
NEEDS = {
    "compile --feed-override": ("compile c", []),
    "compile --reserve": ("compile c", ["--feed-override", "150"]),
    "compile --buffer": ("compile --stream", []),
    "interpolate --reserve": ("interpolate", ["--override", "0:100"]),
    "plan --oversample": ("plan --out", []),
    "compare --worse-by": ("compare", ["--baseline", "compare.json"]),
    "size --worse-by": ("size", ["--baseline", "size.json"]),
    "judge --worse-by": ("judge", ["--baseline", "judge.json"]),
    "convert --corner": ("convert --fit", []),
    "convert --fit": ("convert --fit", []),
    "convert --ratios": ("convert --to g06.2", []),
    **{f"{command} --{units}": (command, ["--targets", "dsp48"]) for command in ("compare", "size", "sweep") for units in ("multipliers", "dividers")},
}
# Values of options that name a file to read, and a file or folder to write.
READ, WRITTEN = ("FILE", "NAME|FILE"), ("PATH", "DIR", "FOLDER", "FILE.svg")


# What is larger than this is made in the file and kept nowhere else: what a worker holds counts as its commands' memory.
SMALL = 1 << 12


ONES = b"[[1," + b"1," * (SMALL // 2 - 2)


def filled(piece, count, begin=b"", end=b""):
    """Writes a piece over and over."""

    def write(path):
        with open(path, "wb") as file:
            file.write(begin)
            for _ in range(count):
                file.write(piece)
            file.write(end)

    return write


def with_keys(path):
    path.write_text("".join(f"k{number} = 1\n" for number in range(100_000)))


def contents(valid):
    """What may be in a file instead of what is expected; `valid` is that."""
    half = len(valid) // 2
    noise = bytes((place * 2654435761 >> 23) & 255 for place in range(SMALL))
    return {
        "nothing": b"",
        "zeros": filled(bytes(1 << 10), 1 << 10),
        "noise": noise,
        "a program": b"\x7fELF\x02\x01\x01" + noise,
        "UTF-16": valid.decode().encode("utf-16"),
        "a mark of byte order": b"\xef\xbb\xbf" + valid,
        "lone carriage returns": valid.replace(b"\n", b"\r"),
        "a byte that is no UTF-8": valid[:half] + b"\xff\xfe" + valid[half:],
        "a byte of zero": valid[:half] + b"\0" + valid[half:],
        "half": valid[:half],
        "the same twice": valid + valid,
        "blank lines": filled(b"\n" * SMALL, 1 << 11),
        "one long line": filled(b"X1" * SMALL, 1 << 9),
        "digits": filled(b"9" * SMALL, 1 << 10),
        "open brackets": filled(b"[", 200_000),
        "open braces": filled(b'{"a":', 100_000),
        "open parentheses": filled(b"(", 1_000_000),
        "an array in arrays": filled(b"[", 100_000, begin=b"a = ", end=b"]" * 100_000),
        "dotted keys": filled(b"a.", 100_000, end=b"a = 1\n"),
        "tables": filled(b"[[curve]]\n", 200_000),
        "keys": with_keys,
        "pairs of ones": filled(ONES, 8 << 8),
        "a sum without an end": filled(b"[1+", 100_000, begin=b"#1="),
        "a text without an end": filled(b"x" * (1 << 10), 1 << 10, begin=b'a = "'),
    }


def hole(path):
    with open(path, "wb") as file:
        file.truncate(16 << 30)


def special(valid):
    """What may be in a file's place; each makes it at a path. With it: bytes that are read, and a shell's line beside it."""
    missing = lambda path: None
    return {
        "missing": (missing, 0, None),
        "a folder": (os.mkdir, 0, None),
        "a hole of 16 GiB": (hole, 0, None),
        "a link to nothing": (lambda path: os.symlink("nowhere", path), 0, None),
        "a link to itself": (lambda path: os.symlink(path.name, path), 0, None),
        "a link to /dev/zero": (lambda path: os.symlink("/dev/zero", path), 64 << 20, None),
        "a link to memory": (lambda path: os.symlink("/proc/self/mem", path), 0, None),
        "a file that may not be read": (lambda path: (path.write_bytes(valid), path.chmod(0)), 0, None),
        "a socket": (lambda path: os.mknod(path, stat.S_IFSOCK | 0o600), 0, None),
        "a pipe without an end": (os.mkfifo, 64 << 20, "yes 'G1 X1' > NAME"),
        "a slow pipe": (os.mkfifo, 1 << 10, "(printf 'G1 '; sleep 0.3; printf 'X1\\n') > NAME"),
        "a pipe with nothing": (os.mkfifo, 0, ": > NAME"),
    }


def lines_of(text):
    """Place, header, key and value of each line of a TOML text that has a key."""
    header = ""
    for place, line in enumerate(text.splitlines()):
        if line.startswith("["):
            header = line
        elif found := re.match(r"(\w+) = (.*)$", line):
            yield place, header, found[1], found[2].split(" #")[0].strip()


@functools.cache
def encoded(text):
    """The bytes of a text, which all cases with it share."""
    return text.encode()


def with_line(text, place, *line):
    """The pieces of a text with another line at a place, or with none there."""
    lines = text.encode().splitlines(keepends=True)
    return [*lines[:place], *map(encoded, line), b"\n" if line else b"", *lines[place + 1 :]]


def with_number(text, found, number):
    """The pieces of a text with another number where one was found."""
    return [text[: found.start()], encoded(number), text[found.end() :]]


def without(words, options):
    """A command line without these options and their values."""
    kept, words = [], iter(words)
    for word in words:
        if word in options:
            next(words, None)
        else:
            kept.append(word)
    return kept


def samples():
    """A text of each format of parts, by its name."""
    folders = ["canon", "dxf", "fanuc", "siemens", "linuxcnc", "json", "toml"]
    return {path.name: path for folder in folders for path in sorted((ROOT / "fuzz" / "seeds" / folder).iterdir())}
