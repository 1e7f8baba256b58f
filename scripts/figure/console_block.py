"""Blocks marked `console`: commands, each with what it prints below it.

Each `$ feedbits …` and `$ cargo run --release -- …` is run, those of a page one after the other in one folder with `data/` in it, and
must end with status 0 or 1. Below it stands what it prints on both streams, line by line. A line `…` stands for any number of lines, a
`…` in a line for anything. A command with nothing below it only has to run.
"""

import os
import re
import shlex
import subprocess
import tempfile
from pathlib import Path

from .aligned import GAP, Unaligned, aligned, line_cost, renewed_line

FENCE = re.compile(r"^( *)```([^\n]*)\n(.*?)^\1```$", re.S | re.M)
# How far a long command is, which hangs on the machine: `feedbits: after 10 seconds: planning`.
TIME_SO_FAR = re.compile(r"^feedbits: after \d+ (?:second|minute|hour|day)s?: .*\n", re.M)
OURS = re.compile(r"\$ (?:feedbits|cargo run --release(?: --)?)(?= |$)(.*)")


def blocks(text):
    """The console blocks of a page."""
    return [block for block in FENCE.finditer(text) if block[2] == "console"]


def command_of(line):
    """The arguments of a shown command, if it is one of ours."""
    ours = OURS.match(line)
    return shlex.split(ours[1], comments=True) if ours else None


def renewed(below, printed):
    """The lines below a command as they should be, for what it prints now."""
    shown = [line.rstrip() for line in below.splitlines()]
    now = [line.rstrip() for line in printed.splitlines()]
    pairs = aligned(shown, now, line_cost)
    lines = [new if old is None else old if old == GAP else renewed_line(old, new) for old, new in pairs if new is not None or old == GAP]
    return "".join(f"{line}\n" for line in lines)


def renewed_page(name, text, root, binary):
    """The text of a page with all its console blocks anew, faults, and how many commands were run."""
    faults, count, pieces, at = [], 0, [], 0
    with tempfile.TemporaryDirectory() as folder:
        os.symlink(root / "data", Path(folder) / "data")
        for block in blocks(text):
            pieces.append(text[at : block.start(3)])
            at = block.end(3)
            for part in re.split(r"^(?=\$ )", block[3], flags=re.M):
                line, _, below = part.partition("\n")
                arguments = command_of(line)
                if arguments is not None:
                    count += 1
                    below, fault = shown_below(binary, arguments, folder, below)
                    faults += [f"{name}: {line}: {fault}"] if fault else []
                pieces.append(f"{line}\n{below}" if part else "")
    return "".join(pieces) + text[at:], faults, count


def shown_below(binary, arguments, folder, below):
    """What is to stand below a command, and a fault, if there is one: then it stays as it is."""
    status, printed = run(binary, arguments, folder)
    if status not in (0, 1):
        return below, f"ends with status {status}:\n{printed}"
    if not below.strip():
        return below, None
    try:
        return renewed(below, printed), None
    except Unaligned as line:
        return below, f"nothing like this line is printed any more, so a person decides what is shown:\n    {line}\n{printed}"


def run(binary, arguments, folder):
    done = subprocess.run([binary, *arguments], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, encoding="utf-8", check=False)
    return done.returncode, TIME_SO_FAR.sub("", done.stdout)
