"""The periods of a run in the emulator: what each took, and how often it passed each unknown of the program."""

import re
import subprocess
from collections import Counter
from dataclasses import dataclass, field

from . import Refused
from .instruction import Kind
from .program import calls, edge, node

OPTIONS = ("-display none -monitor none -serial none -chardev stdio,id=console -d in_asm,exec,nochain".split()
           + ["-semihosting-config", "enable=on,target=native,chardev=console"])


@dataclass
class Period:
    instructions: int = 0
    passes: Counter = field(default_factory=Counter)  # of the program's unknowns


def executed(image, machine):
    """The translated blocks in the order in which they are executed: each a list of (address, bytes)."""
    command = ["qemu-system-arm", "-machine", machine, *OPTIONS, "-kernel", image]
    emulator = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    translated, known, held = [], {}, None
    for line in emulator.stderr:
        if line.startswith(b"Trace "):
            key = line[line.index(b"[") + 1 : line.index(b"]")]
            address = int(key.split(b"/")[1], 16)
            if translated and translated[0][0] == address:
                known[key], translated = translated, []
            if held is not None:
                yield held
            held = known[key]
        elif line.startswith(b"0x"):
            translated.append(disassembled(line.decode()))
        elif line.startswith(b"IN:"):
            translated = []
        elif line.startswith(b"Stopped"):
            # The block was left before its first instruction.
            held = None
    if held is not None:
        yield held
    if emulator.wait() != 0:
        raise Refused(f"the emulator ended with status {emulator.returncode}")


def disassembled(line):
    address, rest = line.strip()[2:].split(":", 1)
    size = 0
    for word in rest.split():
        if re.fullmatch("[0-9a-f]{4}|[0-9a-f]{8}", word) and size + len(word) <= 8:
            size += len(word)
        else:
            break
    return int(address, 16), size // 2


class Walk:
    """Follows the run from period to period. The emulator's blocks end with an instruction that may jump, so that a period begins and
    ends with one of them; the program's blocks may begin within."""

    def __init__(self, image, program):
        self.image, self.program = image, program
        self.blocks = {a: b for f in program.functions.values() for a, b in f.blocks.items()}
        self.inside = {i.address for b in self.blocks.values() for i in b.instructions}
        self.begins = {}
        self.period, self.back, self.before = None, None, None

    def step(self, executed):
        """The next block of the emulator; a period when it is over."""
        over, first = None, executed[0][0]
        if self.period is not None and first == self.back:
            over, self.period = self.period, None
        if self.period is None and first == self.program.entry:
            self.period, self.back = Period(), sum(self.before)
            self.block, self.stack = None, []
        if self.period is not None:
            self.period.instructions += len(executed)
            for address, before in self.begins_in(executed):
                self.enter(address, before or self.before[0])
        self.before = executed[-1]
        return over

    def begins_in(self, executed):
        """Where the program's blocks begin in one of the emulator's, each with the instruction before."""
        key = executed[0][0], len(executed)
        if key not in self.begins:
            addresses = [address for address, _ in executed]
            for address in addresses:
                if address not in self.inside:
                    places = " > ".join(str(frame) for frame in self.image.places(address)[::-1])
                    raise Refused(f"a period executes what is said never to be: {address:#x}, {places}")
            self.begins[key] = [(a, b) for a, b in zip(addresses, [None, *addresses]) if a in self.blocks]
        return self.begins[key]

    def enter(self, address, before):
        block, passes = self.block, self.period.passes
        self.block = self.blocks[address]
        passes[node(address)] += 1
        if block is None:
            passes[calls(address)] += 1
            return
        at_end = before == block.end.address
        if at_end and block.callee == address:
            self.stack.append(block)
            passes[calls(address)] += 1
        elif at_end and block.goes_on_with == address:
            passes[calls(address)] += 1
        else:
            if self.stack and self.stack[-1].end.after == address and block.end.kind is Kind.RETURN:
                block = self.stack.pop()
                at_end = False
            jumps = at_end and address != block.end.after
            passes[edge(block.address, address, jumps)] += 1


def periods(image, program, machine):
    """All periods of a run."""
    walk = Walk(image, program)
    for block in executed(image.path, machine):
        over = walk.step(block)
        if over is not None:
            yield over


def nodes(program):
    """The unknowns of a program's blocks."""
    return (node(address) for function in program.functions.values() for address in function.blocks)


def passed(period):
    """The unknowns of the blocks that a period passes."""
    return (unknown for unknown in period.passes if unknown.startswith("n_"))


def broken(program, period):
    """The limits that a period exceeds."""
    for row in program.limits:
        if sum(c * period.passes[u] for c, u in row.terms) > row.limit:
            yield row
