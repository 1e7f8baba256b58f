"""A linked image: its instructions, its functions' names, its bytes, and the place in the source of each address."""

import bisect
import functools
import re
import struct
import subprocess
from dataclasses import dataclass
from pathlib import Path

from . import Refused
from .instruction import parse

TOOLS = "arm-none-eabi-"
ROOT = Path(__file__).parents[2]


def run(tool, *arguments, text=None):
    """What a tool of the GNU binutils prints."""
    return subprocess.run([TOOLS + tool, *arguments], input=text, capture_output=True, text=True, check=True).stdout


@dataclass(frozen=True)
class Frame:
    """A place in the source, of an instruction or of the inlined call that it came by."""

    function: str  # without its types: `cross`
    numbers: tuple  # the numbers and truth values among the generic arguments, in order
    file: str
    line: int

    @property
    def name(self):
        return f"{self.function}<{', '.join(self.numbers)}>" if self.numbers else self.function

    def __str__(self):
        return f"{self.name} ({self.file}:{self.line})"


class Image:
    def __init__(self, path):
        self.path = str(path)
        self.instructions = self.disassemble()
        symbols = [line.split() for line in run("nm", self.path).splitlines()]
        named = sorted((int(s[0], 16) & ~1, s[2]) for s in symbols if len(s) == 3 and s[1] in "tTwW")
        self.symbols = {}
        for address, name in named:
            self.symbols.setdefault(address, name)
        self.starts = sorted(self.symbols)
        self.sections = self.read_sections()
        self.frames, self.sources = {}, {}

    def address_of(self, symbol):
        found = [address for address, name in self.symbols.items() if name == symbol]
        if not found:
            raise Refused(f"{self.path} has no `{symbol}`")
        return found[0]

    def name_at(self, address):
        """The name of the function that begins at this address, or contains it."""
        index = bisect.bisect_right(self.starts, address) - 1
        return readable(self.symbols[self.starts[index]]) if index >= 0 else f"{address:#x}"

    def full_name(self, address):
        """The name of the function that begins at this address, with all types."""
        return demangled(self.symbols.get(address, ""))

    def function_at(self, address):
        """The function that begins at this address, with its generic arguments."""
        return Frame(*cut_name(self.full_name(address)), "", 0)

    def text_of(self, place):
        """The line of the source, if it is of this workspace."""
        if place.file not in self.sources:
            path = ROOT / place.file
            self.sources[place.file] = path.read_text().splitlines() if path.is_file() else []
        lines = self.sources[place.file]
        return lines[place.line - 1] if 0 < place.line <= len(lines) else ""

    def disassemble(self):
        """The instructions by address. What the mapping symbols call data has none."""
        found, pending = {}, 0
        for line in run("objdump", "-d", self.path).splitlines():
            cut = re.match(r"\s+([0-9a-f]+):\t((?:[0-9a-f]{4} ?){1,2})\s*\t(\S+)\s*(.*)", line)
            if not cut or cut[3].startswith("."):
                continue
            address, size = int(cut[1], 16), len(cut[2].replace(" ", "")) // 2
            mnemonic = cut[3]
            operands = re.split(r"\s+[@;]", cut[4])[0].strip()
            conditional = pending > 0
            pending = max(0, pending - 1)
            if re.fullmatch("it[te]{0,3}", mnemonic):
                pending = len(mnemonic) - 1
            found[address] = parse(address, size, mnemonic, operands, conditional)
        return found

    def read_sections(self):
        """Address and bytes of each section with contents."""
        with open(self.path, "rb") as file:
            content = file.read()
        (headers,) = struct.unpack_from("<I", content, 0x20)
        size, count = struct.unpack_from("<HH", content, 0x2E)
        sections = []
        for index in range(count):
            _, kind, flags, address, offset, length = struct.unpack_from("<6I", content, headers + index * size)
            if kind == 1 and flags & 2:
                sections.append((address, content[offset : offset + length]))
        return sections

    def bytes_at(self, address, length):
        for start, content in self.sections:
            if start <= address and address + length <= start + len(content):
                return content[address - start : address - start + length]
        raise Refused(f"the image has no {length} bytes at {address:#x}")

    def locate(self, addresses):
        """Reads the places of these addresses, of which `places` then tells."""
        # One by one: the difference of a set and a dictionary's keys would look at every key.
        wanted = sorted({address for address in addresses if address not in self.frames})
        if not wanted:
            return
        text = "".join(f"{address:#x}\n" for address in wanted)
        lines = run("addr2line", "-a", "-i", "-f", "-C", "-e", self.path, text=text).splitlines()
        chain, index = None, 0
        while index < len(lines):
            if re.fullmatch("0x[0-9a-f]{8}", lines[index]):
                chain = self.frames.setdefault(int(lines[index], 16), [])
                index += 1
            else:
                chain.append(frame(lines[index], lines[index + 1]))
                index += 2
        for address in wanted:
            # The tool gives some innermost calls the name of the whole function.
            inner, *outer = self.frames[address]
            if outer and inner.function == outer[-1].function:
                self.frames[address][0] = Frame("?", (), inner.file, inner.line)

    def places(self, address):
        """The chain of inlined calls at an address, the innermost first."""
        self.locate([address])
        return self.frames[address]


def frame(name, place):
    file, _, line = place.partition(" ")[0].rpartition(":")
    file = re.sub(r".*/(?=crates/|firmware/)", "", file)
    file = re.sub(r".*/(?=library/)|.*/registry/src/[^/]*/", "", file)
    function, numbers = cut_name(name)
    return Frame(function, numbers, file, int(line) if line.isdigit() else 0)


@functools.cache
def demangled(symbol):
    """A symbol's full name, without the numbers of crates and the types of constants."""
    if not symbol.startswith("_R"):
        return symbol
    return re.sub(r"\[[0-9a-f]{6,}\]|(?<=\d): usize", "", run("c++filt", symbol).strip())


def readable(symbol):
    """Function and numbers of a symbol."""
    function, numbers = cut_name(demangled(symbol))
    return f"{function}<{', '.join(numbers)}>" if numbers else function


@functools.cache
def cut_name(name):
    """Function and numeric generic arguments of a demangled name: `<a::B<f32, 2>>::c::<3, true>` is c and 2, 3, true."""
    name = re.sub(r"\[[0-9a-f]{8,}\]", "", name)
    numbers = re.findall(r"(?<=[<, ])(\d+|true|false)(?:_?usize|usize)?(?=[,>])", name)
    # The last segment of the path outside all brackets.
    flat, depth = "", 0
    for index, letter in enumerate(name):
        arrow = letter == ">" and name[index - 1 : index] == "-"
        depth += (letter in "<([") - (letter in ">)]" and not arrow)
        if depth == 0 and letter not in ">)]":
            flat += letter
    segments = [s.strip() for s in flat.split("::") if s.strip()]
    if not segments:
        return name, tuple(numbers)
    function = segments[-1]
    if "{closure" in function and len(segments) > 1:
        function = f"{segments[-2]}::closure"
    return function, tuple(numbers)
