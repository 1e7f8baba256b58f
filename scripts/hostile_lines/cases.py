"""The cases of scripts/hostile, kind by kind."""

import functools
import itertools
import json
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from .inputs import (
    BARE, CURVE, DEVIATION, FINE, INERTIA, KEY_VALUES, LOG, MACHINE, NAMES, NEEDS, NEVER_TAKEN, NUMBERS, ONES, OPTION_VALUES, PART, QUICK, READ, SERVO,
    SETTINGS, SLASHED, TARGET, TOO_LONG, TRIGONOMETRIC, WRITTEN, commands, contents, filled, lines_of, samples, special, with_line, with_number, without,
)  # fmt: skip
from .watched_run import LONG_WORD, MARK, STATUSES, Case, is_being_written, words_of

REFUSED, ANY, DONE = frozenset({2}), frozenset(STATUSES), frozenset(STATUSES - {2})
DRAWN_PAIRS, DRAWN_NUMBERS, DRAWN_VALUES = 200, 24, 3


class Program:
    """The program, asked for its commands, options and keys."""

    def __init__(self, binary):
        self.binary = str(binary)

    def ask(self, arguments, files):
        """What it prints, what it says, and the files that it makes."""
        with tempfile.TemporaryDirectory() as folder:
            for name, content in files.items():
                (Path(folder) / name).write_bytes(content)
            ended = subprocess.run([self.binary, *arguments], cwd=folder, capture_output=True, stdin=subprocess.DEVNULL)
            made = {str(path.relative_to(folder)): path.read_bytes() for path in Path(folder).rglob("*") if path.is_file()}
            return ended.stdout.decode(), words_of(ended.stderr), {name: text for name, text in made.items() if name not in files}

    @functools.cached_property
    def commands(self):
        text = self.ask(["--help"], {})[0].split("Commands:")[1].split("Options:")[0]
        return [name for name in re.findall(r"^  (\w+)", text, re.M) if name != "help"]

    @functools.cache
    def options(self, command):
        """Options of a command, each with the name of its value; an empty one if it takes none."""
        text = self.ask([command, "--help"], {})[0]
        return dict(re.findall(r"^ {2,6}(?:-\w, )?(--[a-z][a-z0-9-]*)(?:[ =]<([^>]+)>)?", text, re.M))

    def keys(self, arguments, files, name, text, header):
        """The keys of a table, as the program lists them beside one that it does not know."""
        text = text.replace(header + "\n", f"{header}\nnot_a_key_at_all = 1\n", 1) if header else "not_a_key_at_all = 1\n" + text
        said = self.ask(arguments, {**files, name: text.encode()})[1]
        listed = re.search(r"expected:? (?:one of )?((?:`?\w+`?(?:, | or |,? and ))*`?\w+`?)", said)
        return set(re.findall(r"\w+", listed[1])) - {"or", "and"} if listed else set()

    @functools.cached_property
    def results(self):
        """Files that commands write of the bare part: to read again, and whose names a report takes."""
        found = {}
        made = {"compare --json": "compare.json", "size --json": "size.json", "judge --json": "judge.json", "sweep": "sweep.jsonl"}
        for line, as_name in made.items():
            name = "out." + as_name.split(".")[1]
            found[as_name] = self.ask(commands()[line][0], BARE)[2][name]
        return found

    @functools.cache
    def files_of(self, line):
        """The names of the files that a command line writes."""
        return sorted(self.ask(commands()[line][0], {**BARE, **self.results})[2])


def shown(value):
    """A value in a title."""
    text = value if isinstance(value, str) else repr(value)
    return repr(text)[1:-1] if len(text) < 60 else f"{text[:12]}… of {len(text)} characters"


def case(kind, title, command, files=BARE, **more):
    words, outputs = command
    return Case(kind, title, words, dict(files), outputs, **more)


def key_files():
    """The kinds of files with keys: the name of one, its texts, and the commands that read it."""
    servo, compare = commands()["servo"][0], commands()["compare"][0]
    curves = commands("part.toml")
    return [
        ("keys of a machine", "machine.toml", [MACHINE, DEVIATION], [commands()[name] for name in QUICK]),
        ("keys of a drive", "servo.toml", [SERVO, INERTIA], [([*servo, "--servo", "servo.toml"], ())]),
        (
            "keys of a target",
            "target.toml",
            [TARGET],
            [(["targets", "mine", "--target-file", "target.toml"], ()), ([*compare, "--target-file", "target.toml"], ())],
        ),
        ("keys of a curve", "part.toml", [CURVE, TRIGONOMETRIC], [curves[name] for name in ("check", "plan", "compare", "convert --to g06.2", "interpolate")]),
    ]


def quoted(value):
    """A value as refusals quote what was written, the begin of a long one: it is a place too."""
    return [quote + (value[:40] if isinstance(value, str) and len(value) > LONG_WORD else shown(value)) for quote in "\"'`"]


def beside(statuses, *places):
    """Further places that a refusal may name: what is within its domain may still not go with the rest."""
    return () if statuses is REFUSED else (*places, "part.nc")


def wrong_spellings(key):
    return {f"{key}x", key.upper(), re.sub(r"_(mm|ms|per|hz|percent)\b.*", "", key), key.replace("_mm", "_m"), key.replace("_ms", "_s")} - {key}


def key_cases(program):
    for kind, name, texts, of in key_files():
        turn = itertools.cycle(of)
        files = {**BARE, "part.toml": CURVE.encode()}
        tried = {(header, key) for text in texts for _, header, key, _ in lines_of(text)}
        for number, text in enumerate(texts, 1):
            make = lambda title, changed, *named, statuses=ANY: case(
                kind,
                f"{name} {number}: {title}",
                next(turn),
                {**files, name: changed},
                named=(*named, *beside(statuses, name, *(key for _, key in tried), *(key for _, _, key, _ in lines_of(SERVO)))),
                statuses=statuses,
            )
            given = list(lines_of(text))
            for header in dict.fromkeys(header for _, header, _, _ in given):
                place = next(place for place, at, _, _ in given if at == header)
                listed = program.keys(of[0][0], files, name, text, header)
                if len(listed) < 2 and header != "[operation.cycles]":  # where a word may stand too
                    sys.exit(f"scripts/hostile: the program does not list the keys of {header or 'the top'} in {name}")
                # A key that no text here has is tried too.
                for key, value in itertools.product(sorted(key for key in listed if (header, key) not in tried), KEY_VALUES):
                    added = with_line(text, place, f"{key} = ", value, f"\n{text.splitlines()[place]}")
                    yield make(f"{header} new {key} = {shown(value)}", added, key)
            for place, header, key, value in given:
                at, line = f"{header} {key}", f"{key} = {value}"
                for hostile in KEY_VALUES:
                    changed = with_line(text, place, f"{key} = ", hostile)
                    yield make(f"{at} = {shown(hostile)}", changed, key, statuses=REFUSED if hostile in NEVER_TAKEN else ANY)
                yield make(f"{at} is missing", with_line(text, place), key, name)
                yield make(f"{at} twice", with_line(text, place, f"{line}\n{line}"), key, statuses=REFUSED)
                for wrong in sorted(wrong_spellings(key) - {one for _, one in tried}):
                    yield make(f"{at} as {wrong}", with_line(text, place, f"{wrong} = {value}"), wrong, key, statuses=REFUSED)
                for factor in (1e-3, 1e3, 1e6) if re.fullmatch(r"[\d.]+(e-?\d+)?", value) else ():
                    changed = with_line(text, place, f"{key} = {float(value) * factor!r}")
                    yield make(f"{at} times {factor:g}", changed, key)


def line_for(command, option=""):
    """A command line in which an option of a command can be tried, without that option."""
    name, more = NEEDS.get(f"{command} {option}", (command, []))
    words, outputs = commands().get(name, ([command], ()))
    return [*without(words, [option]), *more], outputs


def option_cases(program, draw):
    """Every value for an option of one command; for the same option of further commands, some."""
    files, seen = {**BARE, **program.results}, set()
    for command in program.commands:
        for option, value in program.options(command).items():
            words, outputs = line_for(command, option)
            make = lambda title, more, statuses=ANY: case(
                "options",
                f"{command}: {title}",
                ([*words, *more], outputs),
                files,
                # The value as it was written is a place too.
                named=(option, *itertools.chain(*map(quoted, more[1:])), *beside(statuses)),
                statuses=statuses,
            )
            yield make(f"{option}x", [f"{option}x"], REFUSED)
            if option in ("--help", "--version"):
                continue
            if not value:
                yield make(f"{option} twice", [option, option])
                yield make(f"{option}=1", [f"{option}=1"], REFUSED)
                continue
            yield make(f"{option} without a value", [option], REFUSED)
            if value in READ or value in WRITTEN:
                continue
            for hostile in draw.sample(OPTION_VALUES, DRAWN_VALUES) if option in seen else OPTION_VALUES:
                statuses = REFUSED if hostile in NEVER_TAKEN else ANY
                yield make(f"{option} {shown(hostile)}", [option, hostile], statuses)
            seen.add(option)
        for hostile in ("", "text", "x" * 100_000, b"\xff", "a\nb", "0", "-", "--", "."):
            words, outputs = line_for(command)
            yield case("options", f"{command}: {shown(hostile)} in addition", ([*words, hostile], outputs), files)


def numbers_of(text):
    return list(re.finditer(rb"(?<![A-Za-z_\d.])-?\d+\.?\d*(?:e-?\d+)?|(?<=[A-Z=#])-?\d+\.?\d*", text))


def number_cases(draw):
    """A hostile number in place of one in a part."""
    numbers = [*NUMBERS, "nan", "inf", "9" * 10**5, f"0.{'0' * 10**5}1", "1e-400", "-7"]
    for name, path in samples().items():
        text = path.read_bytes()
        for _ in range(DRAWN_NUMBERS):
            found, number = draw.choice(numbers_of(text)), draw.choice(numbers)
            line = draw.choice(["check", "check --json", "plan", "compare", "convert --to g06.2", "convert --to toml", "smooth", "compile"])
            changed = with_number(text, found, number)
            title = f"{line}: {shown(number)} for byte {found.start()} of {name}"
            yield case("numbers of a part", title, commands(name)[line], {**BARE, name: changed}, named=(name,))


def twists(program, draw, command):
    """Each changes the words and files of a case in one way, and returns the places of it and a title."""
    numeric = [one for one, value in program.options(command).items() if value and value not in READ + WRITTEN]

    def machine_key(words, files):
        text = files["machine.toml"].decode()
        place, header, key, _ = draw.choice(list(lines_of(text)))
        value = draw.choice(NUMBERS)
        files["machine.toml"] = b"".join(with_line(text, place, f"{key} = {value}"))
        return (key,), f"{key} = {value}"

    def option(words, files):
        one, value = draw.choice(numeric), draw.choice(OPTION_VALUES)
        words[:] = [*without(words, [one]), one, value]
        return (one, *quoted(value)), f"{one} {shown(value)}"

    def number(words, files):
        found, value = draw.choice(numbers_of(files["part.nc"])), draw.choice(NUMBERS)
        files["part.nc"] = b"".join(with_number(files["part.nc"], found, value))
        return ("part.nc",), f"{value} at byte {found.start()} of the part"

    return [machine_key, option, number] if numeric else [machine_key, number]


def pair_cases(program, draw):
    names = [name for name in commands() if name not in ("merge", "papers", "zoo", "machine --from")]
    for _ in range(DRAWN_PAIRS):
        name = draw.choice(names)
        words, outputs = commands()[name]
        words, files = list(words), {**BARE, **program.results}
        made = [draw.choice(twists(program, draw, words[0]))(words, files) for _ in range(2)]
        named, titles = zip(*made)
        yield case("pairs", f"{name}: {', '.join(titles)}", (words, outputs), files, named=(*itertools.chain(*named), "part.nc"))


def readers(program):
    """Command lines that read a file: of which option, the words before its name, what is right in it, and what they write."""
    of = lambda line: commands()[line][0]
    return [
        ("part", ["check"], PART, ()),
        ("part", ["plan", "--machine", "machine.toml"], PART, ()),
        ("part", ["convert", "--to", "toml"], PART, ()),
        ("--machine", ["plan", "part.nc", "--machine"], MACHINE.encode(), ()),
        ("--servo", [*of("servo"), "--servo"], SERVO.encode(), ()),
        ("--target-file", ["targets", "--target-file"], TARGET.encode(), ()),
        ("--baseline", [*of("compare"), "--baseline"], program.results["compare.json"], ()),
        ("--baseline", [*of("size"), "--baseline"], program.results["size.json"], ()),
        ("--baseline", [*of("judge"), "--baseline"], program.results["judge.json"], ()),
        ("log", ["judge", "--machine", "machine.toml"], LOG.encode(), ()),
        ("--machine", ["judge", "log.csv", "--machine"], MACHINE.encode(), ()),
        ("--part", ["judge", "log.csv", "--machine", "machine.toml", "--part"], PART, ()),
        ("--from", ["machine", "--from"], SETTINGS.encode(), ()),
        ("sweeps", ["merge", "--out", "out.jsonl"], program.results["sweep.jsonl"], ("out.jsonl",)),
        ("--out of a sweep", [*without(of("sweep"), ["--out"]), "--out"], program.results["sweep.jsonl"], ("FILE",)),
    ]


def content_cases(program):
    for option, words, valid, outputs in readers(program):
        outputs = tuple(output.replace("FILE", "file") for output in outputs)
        title = f"{words[0]}, {option}"
        for what, content in contents(valid).items():
            yield case("contents", f"{title}: {what}", ([*words, "file"], outputs), {**BARE, "file": content}, named=("file",))
        for what, (make, read, feeder) in special(valid).items():
            setup = lambda work, make=make: make(work / "file")
            feeder = feeder and feeder.replace("NAME", "file")
            yield case(
                "no files", f"{title}: {what}", ([*words, "file"], (*outputs, "nowhere")), setup=setup, read_bytes=read, feeder=feeder, named=("file",)
            )
        for what, name in [("a name of 300 characters", TOO_LONG), ("an empty name", ""), ("below a file", "part.nc/x"), ("a folder's name", "./")]:
            yield case("no files", f"{title}: {what}", ([*words, name], ()), named=(name or option, "''", '""', "[PART]", "<FILE>", "--out <PATH>"), statuses=REFUSED)
    most = filled(ONES, 62 << 8)
    for words in (["check"], ["targets", "--target-file"], ["merge", "--out", "out.jsonl"]):
        yield case("contents", f"{words[0]}: 62 MiB of pairs of ones", ([*words, "file"], ("out.jsonl",)), {"file": most}, named=("file",))
    for what, source in [("without an end", "/dev/zero"), ("nothing", "/dev/null"), ("closed", "closed"), ("a folder", "/"), ("noise", "/dev/urandom")]:
        for line in ("check", "plan", "convert"):
            read = 64 << 20
            yield case("no files", f"{line}, standard input: {what}", commands("-")[line], stdin=source, read_bytes=read, named=("standard input",))
    for other in ("size.json", "sweep.jsonl", "machine.toml", "part.nc"):
        words = [*commands()["compare"][0], "--baseline", other]
        yield case("contents", f"compare: {other} for a baseline", (words, ()), {**BARE, **program.results}, named=(other,), statuses=REFUSED)


def sweep_cases(program, draw):
    """A sweep's file that is cut, or in which a digit is another."""
    whole = program.results["sweep.jsonl"]
    files = {**BARE, "sweep.jsonl": whole}
    merge = (["merge", "file", "--out", "out.jsonl"], ("out.jsonl",))
    resume = ([*without(commands()["sweep"][0], ["--out"]), "--out", "file"], ("file",))
    finished = lambda work: [] if sorted((work / "file").read_bytes().splitlines()) == sorted(whole.splitlines()) else ["the sweep is another one now"]
    for cut in sorted(draw.sample(range(len(whole)), 16)):
        title = f"resume one cut after {cut} bytes"
        yield case("sweeps", title, resume, {**files, "file": whole[:cut]}, named=("file",), statuses=DONE, afterwards=finished)
        yield case("sweeps", f"merge one cut after {cut} bytes", merge, {**files, "file": whole[:cut]}, named=("file", "cells"), statuses=REFUSED)
    digits = [found.start() for found in re.finditer(rb"\d", whole)]
    for place in sorted(draw.sample(digits, 24)):
        other = whole[:place] + bytes([48 + (whole[place] - 48 + draw.randrange(1, 10)) % 10]) + whole[place + 1 :]
        title = f"with another digit at byte {place}"
        yield case("sweeps", f"merge one {title}", merge, {**files, "file": other}, named=("file",), statuses=REFUSED)
        yield case("sweeps", f"resume one {title}", resume, {**files, "file": other}, named=("file",), statuses=REFUSED)


def name_cases(program):
    for (what, name), (line, (words, outputs)) in itertools.product(NAMES.items(), commands("PART").items()):
        if line in ("merge", "papers", "zoo", "machine --from"):
            continue
        put = [name if word == "PART" else word for word in words]
        yield case("names", f"{line} of a part: {what}", (put, outputs), {**BARE, name: PART}, named=(MARK,))
    for (what, name), (option, words, valid, outputs) in itertools.product(NAMES.items(), readers(program)):
        outputs = tuple(name if output == "FILE" else output for output in outputs)
        yield case("names", f"{words[0]}, {option}: {what}", ([*words, name], outputs), {**BARE, name: valid}, named=(MARK,))
    for (what, name), command in itertools.product(NAMES.items(), program.commands):
        for option in outputs_of(program, command):
            words, outputs = line_for(command, option)
            folder = os.path.dirname(os.fsencode(name))
            setup = lambda work, folder=folder: os.makedirs(os.path.join(os.fsencode(work), folder), exist_ok=True)
            places = (*outputs, name, *(os.fsencode(name).removesuffix(b".nc") + ending for ending in (b".nc.c", b".nc.h", b".c", b".h")))
            yield case("names", f"{command} {option}: {what}", ([*words, option, name], places), {**BARE, **program.results}, setup=setup, named=(MARK, option))
    for (what, name), line in itertools.product(NAMES.items(), ("compare --report", "size --types c", "compile c", "convert", "smooth to moves")):
        comment = os.fsencode(name).replace(b"\n", b" ").replace(b"(", b"[").replace(b")", b"]")
        text = PART.replace(b"G1 Y4", b"(" + comment + b")\nG1 Y4 ;" + comment)
        yield case("names", f"{line}: a comment of the part: {what}", commands()[line], {**BARE, "part.nc": text}, named=("part.nc",))
    for key, name in itertools.product(("name", "title", "source"), [*SLASHED, *(name for name in NAMES.values() if isinstance(name, str))]):
        text = re.sub(f"^{key} = .*$", lambda _: f"{key} = {json.dumps(name, ensure_ascii=False)}".replace("\x7f", ""), TARGET, flags=re.M)
        words, outputs = commands()["compare --report"]
        files = {**BARE, "target.toml": text.encode()}
        yield case("names", f"compare: target with {key} {shown(name)}", ([*words, "--target-file", "target.toml"], outputs), files, named=("target.toml",))


def outputs_of(program, command):
    """The options that name what a command writes."""
    return [option for option, value in program.options(command).items() if value in WRITTEN]


def aliases(name):
    """Other spellings of a file, each with what makes it."""
    link = lambda make: lambda work: make(work / name, work / "alias")
    nothing = lambda work: None
    return {
        "itself": (name, nothing),
        "with ./": (f"./{name}", nothing),
        "through ..": (f"sub/../{name}", lambda work: (work / "sub").mkdir()),
        "through the folder's name": (f"../work/{name}", nothing),
        "through a link to the folder": (f"alias/{name}", lambda work: (work / "alias").symlink_to(".")),
        "a link": ("alias", link(lambda target, alias: alias.symlink_to(target.name))),
        "a link to a link": ("again", lambda work: ((work / "alias").symlink_to(name), (work / "again").symlink_to("alias"))),
        "a hard link": ("alias", link(os.link)),
    }


def output_cases(program):
    everything = {**BARE, **program.results, "out": b"old\n"}
    inputs = {"part.nc": [], "machine.toml": [], "servo.toml": ["--servo"], "target.toml": ["--target-file"], "compare.json": ["--baseline"]}
    places = {
        "a folder": ("place", os.mkdir),
        "in a missing folder": ("missing/place", None),
        "below a file": ("part.nc/place", None),
        "a full device": ("/dev/full", None),
        "where nobody may write": ("/proc/place", None),
        "a link to itself": ("place", lambda path: path.symlink_to("place")),
        "a link into a missing folder": ("place", lambda path: path.symlink_to("missing/place")),
        "a name of 300 characters": (TOO_LONG, None),
        "an empty name": ("", None),
        "a name that ends in a slash": ("place/", None),
        "this folder": (".", None),
        "a folder where nobody may write": ("/proc", None),
    }
    for command in program.commands:
        for option in outputs_of(program, command):
            words, outputs = line_for(command, option)
            # A file has no folder's name.
            files = {name: text for name, text in everything.items() if name != "out" or "--report" not in words}
            make = lambda title, place, more=(), kind="outputs", **also: case(
                kind, f"{command} {option}: {title}", ([*words, *more, option, place], tuple(also.pop("outputs", outputs))), files, **also
            )
            for name, before in inputs.items():
                if not set(before) <= set(program.options(command)) or (not before and name not in words):
                    continue
                for spelling, (place, setup) in aliases(name).items():
                    more = [*before, name] if before else []
                    yield make(f"{name}, {spelling}", place, more, kind="outputs that are inputs", setup=setup, statuses=REFUSED, named=(option, name, place))
            for title, (place, at) in places.items():
                setup = (lambda work, at=at: at(work / "place")) if at else None
                is_folder = program.options(command)[option] in ("DIR", "FOLDER")
                fine = is_folder and title in ("a folder", "in a missing folder", "a name that ends in a slash", "this folder")
                made = [*outputs, place, "missing"] if fine else outputs
                if fine and title == "this folder":
                    continue
                yield make(title, place, setup=setup, outputs=made, statuses=ANY if fine else REFUSED, named=(place or option, option))
            others = [other for other in outputs_of(program, command) if other != option]
            for other in others:
                title, more = f"the same as {other}", [other, "both"]
                words, outputs = line_for(command, option)
                words = without(words, [other])
                yield make(title, "both", more, outputs=outputs, statuses=REFUSED, named=(option, other, "both"))
    for line, (words, outputs) in commands().items():
        old = {name: b"old\n" for name in outputs if name not in ("out", "out.jsonl")}
        # The file of all cells comes before the report, and is whole.
        resumed = outputs[:1] if words[0] in ("sweep", "merge") else ()
        for limit in (0, 1, 100, 512, 4096, 20_000) if outputs else ():
            title = f"{line}: {limit} bytes"
            files = {**BARE, **program.results, **old, **({"part.nc": FINE} if line == "convert --fit" else {})}
            yield case("full disk", title, (words, outputs), files, file_limit=limit, resumed=resumed, named=("out",))
    for line in ("compare --report", "interpolate --vectors", "sweep --report", "merge"):
        for name in program.files_of(line):
            if not name.startswith("out/"):
                continue
            words, outputs = commands(name)[line] if line != "merge" else (["merge", name, "--out", "out.jsonl", "--report", "out"], ("out.jsonl", "out"))
            content = program.results["sweep.jsonl"] if line == "merge" else PART
            outputs = tuple(one for one in outputs if one != "out")
            # The names of a report's files are known once the cells are run, and these are kept.
            kept = outputs[:1] if line.startswith("sweep") else ()
            files = {**BARE, name: content}
            yield case("outputs that are inputs", f"{line}: {name}", (words, outputs), files, statuses=REFUSED, resumed=kept, named=(name, "out"))
    for ending in (".c", ".h"):
        words = [f"out{ending}" if word == "part.nc" else word for word in commands()["compile c"][0]]
        yield case("outputs that are inputs", f"compile c: out{ending}", (words, ()), {**BARE, f"out{ending}": PART}, statuses=REFUSED, named=(f"out{ending}",))


def stream_cases(program):
    for command in program.commands:
        words, outputs = line_for(command)
        if outputs and command not in ("sweep", "merge"):
            words, outputs = without(words, ["--out"]), ()
        printing = command not in ("sweep", "merge") and REFUSED or ANY
        words = words if command != "completions" else ["completions", "bash"]
        full = {"stdout": "/dev/full", "statuses": printing}
        for title, streams in {
            "a full disk": full,
            "a reader that is gone": {"stdout": "gone"},
            "standard output closed": {"stdout": "closed"},
            "errors on a full disk": {"stderr": "/dev/full"},
            "errors closed": {"stderr": "closed"},
            "all three closed": {"stdin": "closed", "stdout": "closed", "stderr": "closed"},
        }.items():
            yield case("streams", f"{command}: {title}", (words, outputs), {**BARE, **program.results}, **streams)
        yield case("streams", f"{command} --help: a full disk", ([command, "--help"], ()), stdout="/dev/full", statuses=REFUSED)
        yield case("streams", f"{command} --help: a reader that is gone", ([command, "--help"], ()), stdout="gone")
    for words in (["--help"], ["--version"], ["help"], ["-h"]):
        yield case("streams", f"{words[0]}: a full disk", (words, ()), stdout="/dev/full", statuses=REFUSED)
        yield case("streams", f"{words[0]}: a reader that is gone", (words, ()), stdout="gone")


def long_part(moves):
    """Writes a program of so many moves."""

    def write(path):
        with open(path, "wb") as file:
            file.write(b"G21 G90\nG0 X0 Y0\nF900\n")
            for move in range(moves):
                file.write(b"G1 X%d.%d Y%d\n" % (move % 900, move % 7, move * 37 % 11))

    return write


def long_lines():
    """Commands that take long: each with what it reads and writes."""
    machine = {"machine.toml": MACHINE.encode()}
    hours = b"G21 G90\nG0 X0 Y0\n" + b"G1 X900 F60\nG1 X0\n" * 60 + b"M2\n"
    an_hour = hours.replace(b"F60\n", b"F6000\n").replace(b"M2\n", b"G1 X900\nG1 X0\n" * 150 + b"M2\n")
    slow, of = {**machine, "part.nc": hours}, commands()
    # Is planned at once and written for long.
    straight = {**machine, "part.nc": b"G21 G90\nG0 X0 Y0\nG1 X200 F6\nG1 X0\nM2\n"}
    many = lambda moves: {**machine, "part.nc": long_part(moves)}
    return {
        "compare": (of["compare"], slow),
        "compare --plan-in": (([*of["compare"][0], "--plan-in", "same"], ()), many(400_000)),
        "compare --report": (of["compare --report"], slow),
        "interpolate": (of["interpolate"], straight),
        "interpolate --json": (of["interpolate --json"], straight),
        "compile": (of["compile"], slow),
        "compile c": (of["compile c"], slow),
        "compile --stream": (of["compile --stream"], slow),
        "size": (of["size"], slow),
        "servo": (of["servo"], {**machine, "part.nc": an_hour}),
        "sweep": (([*without(of["sweep"][0], ["--feed"]), "--feed", "10..20/1000", "--most-periods", "100000000"], ("out.jsonl",)), slow),
        "plan": (of["plan"], many(400_000)),
        "plan --out": (of["plan --out"], slow),
        "check": (of["check"], many(3_000_000)),
        "convert": (of["convert"], many(3_000_000)),
        "convert --fit": (of["convert --fit"], many(1_000_000)),
        "smooth": (of["smooth"], many(400_000)),
    }


def signal_cases(program):
    for line, (command, files) in long_lines().items():
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL):
            writes = line.startswith("interpolate")
            if number == signal.SIGKILL and not writes:
                continue
            old = {name: b"old\n" for name in command[1] if name not in ("out", "out.jsonl")} if writes else {}
            when = is_being_written if writes else None
            resumed = command[1][:1] if line == "sweep" else ()
            yield case("signals", f"{line}: {number.name}", command, {**files, **old}, signal=number, signal_when=when, resumed=resumed)
    words, outputs = commands()["sweep"]
    words = [*without(words, ["--feed"]), "--feed", "10..20/60"]

    def has_cells(work, least):
        path = work / "out.jsonl"
        return path.exists() and path.read_bytes().count(b"\n") > least

    def goes_on(work):
        """The cells of a run that goes on are those of one that was never stopped."""
        found = []
        for name in ("out.jsonl", "anew.jsonl"):
            again = [program.binary, *without(words, ["--out"]), "--out", name]
            subprocess.run(again, cwd=work, capture_output=True, check=False)
            found.append(sorted((work / name).read_bytes().splitlines()))
        return [] if found[0] == found[1] else ["the sweep that goes on is another one"]

    for least in (0, 1, 7, 30):
        when = lambda work, least=least: has_cells(work, least)
        title = f"sweep: SIGKILL after {least} cells, and once more"
        yield case("signals", title, (words, outputs), signal=signal.SIGKILL, signal_when=when, resumed=outputs, afterwards=goes_on)


def cases(program, seed):
    """All cases; those that are drawn come of the seed."""
    draw = random.Random(seed)
    yield from signal_cases(program)
    yield from key_cases(program)
    yield from option_cases(program, draw)
    yield from pair_cases(program, draw)
    yield from number_cases(draw)
    yield from content_cases(program)
    yield from sweep_cases(program, draw)
    yield from name_cases(program)
    yield from output_cases(program)
    yield from stream_cases(program)
