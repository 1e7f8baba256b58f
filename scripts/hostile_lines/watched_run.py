"""A command that is run in a folder of its own, and every way in which its end is not as it must be.

A run is right if it ends with a status of the book, within the time and memory that its input allows; if a refusal names its place in
short, on the error stream alone; and if the folder then holds what it held before, and beside it whole outputs.
"""

import csv
import dataclasses
import hashlib
import io
import json
import math
import os
import re
import resource
import select
import shutil
import signal
import stat
import subprocess
import time
import tomllib
import xml.etree.ElementTree
from pathlib import Path
from typing import Callable

ROOT = Path(__file__).resolve().parent.parent.parent
# Of all statuses the book promises these.
STATUSES = {int(number) for number in re.findall(r"^\| (\d) \|", (ROOT / "docs" / "exit-status.md").read_text(), re.M)}
MOST_SECONDS = 20  # of the processor
MOST_ON_THE_CLOCK = 60
MOST_BEFORE_SIGNAL = 10.0  # that something else waits for
MOST_AFTER_SIGNAL = 1.0
MOST_MESSAGE = 2000  # bytes
LONG_WORD = 60  # characters, of which a message may show the begin alone
# Memory: what a command may take at first, and more for each byte of its input.
MEMORY_AT_FIRST, MEMORY_OF_CHECK, MEMORY_OF_OTHERS = 64e6, 12, 60
UNFINISHED = re.compile(rb"(^|/)\.feedbits-\w{6}\.part$")
KEPT_OF_A_STREAM = 1 << 21
# Stands in every hostile name, and must come out in comments and texts alone.
MARK = "injected"


@dataclasses.dataclass
class Case:
    """A command, the files that it finds, and what its end must be beside what every end must be."""

    kind: str
    title: str
    words: list  # after the program's name
    files: dict = dataclasses.field(default_factory=dict)  # contents by name: bytes, pieces of them, or a function of the path
    outputs: tuple = ()  # files and folders that may be made or replaced
    resumed: tuple = ()  # those of them that a command which did not finish goes on with
    named: tuple = ()  # a refusal has one of these
    statuses: frozenset = frozenset(STATUSES)
    setup: Callable | None = None  # is given the folder, before anything is looked at
    feeder: str | None = None  # a line of sh that runs beside the command
    read_bytes: int = 0  # that come from no file of the folder
    stdin: str = os.devnull
    stdout: str = "kept"  # or closed, gone, or a file
    stderr: str = "kept"
    file_limit: int | None = None  # bytes; a write past it fails, as on a full disk
    signal: int | None = None
    signal_when: Callable | None = None  # is given the folder, and says when to send it; else soon
    environment: dict = dataclasses.field(default_factory=dict)
    afterwards: Callable | None = None  # is given the folder, and returns faults


@dataclasses.dataclass
class End:
    """How a command ended."""

    status: int  # negative for a signal
    seconds: float
    memory: int
    faults: list


def fails(reader, *arguments):
    """Why a reader does not take these; None if it does."""
    try:
        reader(*arguments)
    except Exception as error:  # each reader has errors of its own
        return f"{type(error).__name__}: {error}"[:200]
    return None


def no_number(text):
    raise ValueError(f"{text} in JSON")


def comment_free(text, patterns):
    return re.sub("|".join(patterns), " ", text, flags=re.S)


LINE = r"[^\n]*"
QUOTED = r'"(?:\\.|[^"\\\n])*"'
C_LIKE = [r"/\*.*?\*/", r"//" + LINE, QUOTED]
TEXTS = {  # comments and texts of the languages, by the ending of a file's name
    ".rs": C_LIKE,
    ".c": C_LIKE,
    ".h": C_LIKE,
    ".hpp": C_LIKE,
    ".vhd": ["--" + LINE, QUOTED],
    ".m": ["%" + LINE, QUOTED, r"'[^'\n]*'"],
    ".toml": ["#" + LINE, QUOTED, r"'[^'\n]*'"],
    ".nc": [r"\([^)\n]*\)", ";" + LINE, r"^%" + LINE],
    ".bash": [],
}


def symbols(path):
    """What a C file defines, by the compiler; nothing where there is none."""
    if not shutil.which("cc") or not shutil.which("nm"):
        return ""
    made = path.with_suffix(".o")
    built = subprocess.run(["cc", "-std=c99", "-w", "-c", path.name, "-o", made.name], cwd=path.parent, capture_output=True, text=True)
    if built.returncode:
        return f"does not compile: {built.stderr[:200]} {MARK}"
    found = subprocess.run(["nm", made.name], cwd=path.parent, capture_output=True, text=True).stdout
    made.unlink()
    return found


def cells(path):
    rows = list(csv.reader(io.StringIO(path.read_bytes().decode(), newline="")))
    if any(len(row) != len(rows[0]) for row in rows):
        raise ValueError("rows of different lengths")
    for cell in (cell for row in rows for cell in row if cell[:1] in ("=", "+", "-", "@", "\t", "\r")):
        float(cell)


def stream(path):
    with open(path, "rb") as file:
        header = file.read(164)
    if len(header) < 164 or int.from_bytes(header[136:144], "little") != path.stat().st_size:
        raise ValueError("the header says another length")


def fault_of_output(path):
    """Why a file that a command has written is not whole, or not harmless; None if it is both."""
    ending, size = path.suffix, path.stat().st_size
    if size == 0:
        return "is empty"
    if ending == ".stream":
        return fails(stream, path)
    if size > KEPT_OF_A_STREAM << 3:
        return None
    text = path.read_bytes().decode("utf-8", "replace")
    if "\ufffd" in text and "\\ufffd" not in text and MARK not in text:
        return "is not UTF-8"
    if ending == ".json":
        return fails(lambda: json.loads(text, parse_constant=no_number))
    if ending == ".jsonl":
        return fails(lambda: [json.loads(line, parse_constant=no_number) for line in text.split("\n") if line]) or (
            None if text.endswith("\n") else "ends within a line"
        )
    if ending == ".csv":
        return fails(cells, path)
    if ending == ".svg":
        return fails(xml.etree.ElementTree.fromstring, text) or ("has a script" if "<script" in text else None)
    if ending == ".html" and not text.rstrip().endswith("</html>"):
        return "ends too early"
    if ending == ".html" and f"<script>{MARK}" in text:
        return "has the script of a name"
    if ending in TEXTS:
        code = comment_free(text, TEXTS[ending])
        if MARK in code:
            return f"has a name as code: {code[max(0, code.index(MARK) - 40) :][:100]!r}"
        if ending == ".toml" and (fault := fails(tomllib.loads, text)):
            return fault
        if ending == ".c" and MARK in (found := symbols(path)):
            return f"as the compiler sees it: {found[:300]}"
    return None if text.endswith("\n") or ending == ".hex" else "ends within a line"


def digest(path, found):
    if stat.S_ISLNK(found.st_mode):
        return os.readlink(path)
    if not stat.S_ISREG(found.st_mode):
        return stat.S_IFMT(found.st_mode)
    if found.st_size > 256 << 20:
        return found.st_size, found.st_mtime_ns
    try:
        with open(path, "rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except PermissionError:
        return found.st_size, found.st_mtime_ns


def is_being_written(work):
    """Whether an output is there that is not whole yet."""
    return any(UNFINISHED.search(os.fsencode(name)) for name in os.listdir(work))


def snapshot(folder):
    """What everything in a folder is, by its name."""
    folder, seen = os.fsencode(folder), {}
    for at, folders, names in os.walk(folder):
        for name in folders + names:
            path = os.path.join(at, name)
            seen[os.path.relpath(path, folder)] = digest(path, os.lstat(path))
    return seen


def size_of(folder):
    """Bytes of all files; holes do not count."""
    found = [os.lstat(os.path.join(at, name)) for at, _, names in os.walk(os.fsencode(folder)) for name in names]
    return sum(min(one.st_size, one.st_blocks * 512) for one in found if stat.S_ISREG(one.st_mode))


def messages(text):
    """The messages on the error stream."""
    return [one for one in re.split(rb"^(?=(?:feedbits: )?(?:error|warning|note|feedbits)\b)", text, flags=re.M) if one.strip()]


def words_of(text):
    return " ".join(text.decode("utf-8", "replace").split())


def is_named(name, said):
    """Whether a refusal has a word: the whole of it, the begin of one that is longer than a message, or an item of a list."""
    word = words_of(os.fsencode(name))
    begin = word[:40] if len(word) > LONG_WORD else word
    items = [item for item in re.split(r"[,…]", word.strip("\"'`")) if item]
    return begin in said or (len(items) > 1 and any(quote + item + quote in said for item in items for quote in "\"'`"))


def place_missing(case, said):
    """Whether a refusal has no word by which a person finds the place, and no line of a file."""
    lines = [rf"{re.escape(words_of(os.fsencode(name)))}(:\d+|\b.{{0,30}}\bline \d+)" for name in case.files]
    is_said = any(is_named(name, said) for name in case.named) or any(re.search(one, said) for one in lines)
    return case.named and not is_said


def is_list_of_errors(case):
    """Whether the errors of a part are the result that is asked for."""
    return case.words[:1] == ["check"] and "--json" in case.words


def refusal_faults(case, out, err):
    said = words_of(err)
    if out and not (is_list_of_errors(case) and fails(json.loads, out) is None):
        yield f"{len(out)} bytes on the standard output before a refusal: {out[:80]!r}"
    if case.stderr == "kept" and not said:
        yield "refused without a word"
    elif case.stderr == "kept" and place_missing(case, said):
        yield f"the refusal names none of {', '.join(map(repr, case.named))[:200]}: {said[:300]!r}"


def is_below(name, outputs):
    return any(name == output or name.startswith(output + b"/") for output in map(os.fsencode, map(os.path.normpath, outputs)))


def folder_faults(case, status, before, work, scratch):
    """What was changed that must not be, and outputs that are not whole."""
    after = snapshot(work)
    may_write = status in (0, 1, 3)
    for name in sorted(before.keys() | after.keys()):
        was, now = before.get(name), after.get(name)
        if was == now or (UNFINISHED.search(name) and case.signal == signal.SIGKILL):
            continue
        shown = os.fsdecode(name)
        if not is_below(name, case.outputs):
            change = "is left behind" if was is None else "is gone" if now is None else "was changed"
            yield f"{shown!r} {change}"
        elif UNFINISHED.search(name):
            yield f"{shown!r} is left behind"
        elif not may_write and shown in case.resumed:
            continue
        elif not may_write and case.signal is None and case.stdout != "/dev/full" and not is_list_of_errors(case):
            yield f"{shown!r} was written, and the command refused"
        elif now is not None and stat.S_IFDIR != now and (fault := fault_of_output(work / shown)):
            yield f"{shown!r} {fault}"
    if left := os.listdir(scratch):
        yield f"left in the folder for temporary files: {left}"


def status_faults(case, status, err):
    if case.signal:
        allowed = {-case.signal, 128 + case.signal}
    else:
        allowed = case.statuses
    if status not in allowed:
        how = f"signal {signal.Signals(-status).name}" if status < 0 else f"status {status}"
        yield f"{how}, expected one of {sorted(allowed)}: {words_of(err)[-300:]!r}"
    if b"panicked" in err:
        yield f"a panic: {words_of(err)[-300:]!r}"
    if long := [one for one in messages(err) if len(one) > MOST_MESSAGE]:
        yield f"a message of {max(map(len, long))} bytes: {long[0][:100]!r}"


class Started:
    """A running command, its streams and its clock."""

    def __init__(self, case, binary, folder, slow):
        self.case, self.work, self.slow = case, folder / "work", slow
        self.kept = {}
        self.signalled = None
        self.was_awaited = False
        gone = None
        if case.stdout == "gone":
            gone, to = os.pipe()
        else:
            to = subprocess.PIPE if case.stdout in ("kept", "closed") else os.open(case.stdout, os.O_WRONLY)
        error = subprocess.PIPE if case.stderr in ("kept", "closed") else os.open(case.stderr, os.O_WRONLY)
        environment = {"PATH": os.environ["PATH"], "HOME": str(self.work), "TMPDIR": str(folder / "tmp"), **case.environment}
        read = os.open(os.devnull if case.stdin == "closed" else case.stdin, os.O_RDONLY)
        self.begun = time.monotonic()
        self.process = subprocess.Popen(
            [binary, *case.words], cwd=self.work, env=environment, stdin=read, stdout=to, stderr=error, preexec_fn=self.limits
        )
        for made in (to, error, gone, read):
            if made is not None and made != subprocess.PIPE:
                os.close(made)
        self.pidfd = os.pidfd_open(self.process.pid)

    def limits(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):  # which a shell has its background ignore
            signal.signal(number, signal.SIG_DFL)
        seconds = math.ceil(MOST_SECONDS * self.slow)
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_AS, (16 << 30, 16 << 30))
        if self.case.file_limit is not None:
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (self.case.file_limit, self.case.file_limit))
        for number, name in enumerate([self.case.stdin, self.case.stdout, self.case.stderr]):
            if name == "closed":
                os.close(number)

    def is_time_for_signal(self):
        if self.case.signal is None or self.signalled:
            return False
        passed = time.monotonic() - self.begun
        if not self.case.signal_when:
            return passed > 0.4
        self.was_awaited = self.was_awaited or self.case.signal_when(self.work)
        return self.was_awaited or passed > MOST_BEFORE_SIGNAL * self.slow

    def take(self, streams, ready):
        for stream in [one for one in streams if one.fileno() in ready]:
            piece = os.read(stream.fileno(), 1 << 16)
            if not piece:
                streams.remove(stream)
            kept = self.kept.setdefault(stream, bytearray())
            kept += piece[: KEPT_OF_A_STREAM - len(kept)]

    def end(self):
        """Waits for the end: status, use of resources, what it printed, and faults of time."""
        streams = [one for one in (self.process.stdout, self.process.stderr) if one]
        out, err = ((self.kept.setdefault(one, bytearray()) if one else b"") for one in (self.process.stdout, self.process.stderr))
        faults, most = [], MOST_ON_THE_CLOCK * self.slow
        waited = True
        while waited or streams:
            watched = [one.fileno() for one in streams] + ([self.pidfd] if waited else [])
            ready, _, _ = select.select(watched, [], [], 0.02 if self.case.signal else 1.0)
            self.take(streams, ready)
            if self.pidfd in ready:
                waited = False
                ended = time.monotonic()
            if waited and self.is_time_for_signal():
                self.signalled = time.monotonic()
                self.process.send_signal(self.case.signal)
            if waited and time.monotonic() - self.begun > most:
                faults.append(f"no end within {most:.0f} s")
                self.process.kill()
                most = math.inf
        _, status, used = os.wait4(self.process.pid, 0)
        self.process.returncode = os.waitstatus_to_exitcode(status)
        os.close(self.pidfd)
        for stream in (self.process.stdout, self.process.stderr):
            if stream:
                stream.close()
        if self.case.signal and not self.signalled:
            faults.append("ended before the signal was sent")
        elif self.case.signal_when and not self.was_awaited:
            faults.append("what the signal waits for never came")
        elif self.case.signal and ended - self.signalled > MOST_AFTER_SIGNAL * self.slow:
            faults.append(f"went on for {ended - self.signalled:.1f} s after the signal")
        return self.process.returncode, used, bytes(out), bytes(err), faults


def made(case, folder):
    """The folders of a case with its files."""
    work, scratch = folder / "work", folder / "tmp"
    work.mkdir(parents=True)
    scratch.mkdir()
    for name, content in case.files.items():
        path = Path(os.fsdecode(os.path.join(os.fsencode(work), os.fsencode(name))))
        path.parent.mkdir(parents=True, exist_ok=True)
        if callable(content):
            content(path)
        else:
            path.write_bytes(content if isinstance(content, bytes) else b"".join(content))
    if case.setup:
        case.setup(work)
    return work, scratch


def run(case, binary, folder, slow):
    """Runs a case in a folder that is made for it, and judges its end."""
    work, scratch = made(case, folder)
    size = size_of(work) + case.read_bytes
    before = snapshot(work)
    feeder = subprocess.Popen(["sh", "-c", case.feeder], cwd=work, start_new_session=True, stderr=subprocess.DEVNULL) if case.feeder else None
    status, used, out, err, faults = Started(case, binary, folder, slow).end()
    if feeder:
        os.killpg(feeder.pid, signal.SIGKILL)
        feeder.wait()
    seconds, memory = used.ru_utime + used.ru_stime, used.ru_maxrss * 1024
    faults += status_faults(case, status, err)
    if status == 2:
        faults += refusal_faults(case, out, err)
    if seconds > MOST_SECONDS * slow or status == -signal.SIGXCPU:
        faults.append(f"{seconds:.1f} s of the processor")
    more = MEMORY_OF_CHECK if case.words[:1] == ["check"] else MEMORY_OF_OTHERS
    if memory > (most := MEMORY_AT_FIRST + size * more):
        faults.append(f"{memory / 1e6:.0f} MB of memory, {most / 1e6:.0f} allowed")
    faults += folder_faults(case, status, before, work, scratch)
    if case.afterwards and not faults:
        try:
            faults += case.afterwards(work)
        except OSError as error:
            faults.append(f"afterwards: {error}")
    return End(status, seconds, memory, faults)
