"""An instruction of Thumb: where control goes after it, and its class in the tables of `firmware/trace/cycles`."""

import re
from dataclasses import dataclass
from enum import Enum

CONDITIONS = ("eq", "ne", "cs", "hs", "cc", "lo", "mi", "pl", "vs", "vc", "hi", "ls", "ge", "lt", "gt", "le")


class Kind(Enum):
    """Where control goes."""

    NEXT = "next"
    JUMP = "jump"
    BRANCH = "branch"  # to the target or on
    CALL = "call"
    RETURN = "return"
    SWITCH = "switch"
    STOP = "stop"  # a trap: no period goes on from here
    UNKNOWN = "unknown"  # to an address in a register


@dataclass(frozen=True)
class Instruction:
    address: int
    size: int
    mnemonic: str
    operands: str
    kind: Kind
    target: int | None
    # Whether it is carried out only under a condition, inside an if-then block.
    conditional: bool = False

    @property
    def after(self):
        return self.address + self.size

    @property
    def name(self):
        """The mnemonic without its width and, inside an if-then block, without its condition."""
        name = self.mnemonic.split(".")[0]
        return name[:-2] if self.conditional and name.endswith(CONDITIONS) else name

    def __str__(self):
        return f"{self.address:#x}: {self.mnemonic} {self.operands}".rstrip()


def parse(address, size, mnemonic, operands, conditional):
    """The instruction of a line of the disassembly."""
    instruction = Instruction(address, size, mnemonic, operands, Kind.NEXT, None, conditional)
    kind, target = flow(instruction.name, operands)
    if conditional and kind is Kind.JUMP:
        kind = Kind.BRANCH
    return Instruction(address, size, mnemonic, operands, kind, target, conditional)


def flow(name, operands):
    """Kind and target."""
    found = re.match(r"(?:r\d+, |[a-z]{2}, )?([0-9a-f]+) <", operands)
    target = int(found[1], 16) if found else None
    writes_pc = re.match(r"pc,", operands) is not None
    if name in ("udf", "bkpt"):
        return Kind.STOP, None
    if name == "b":
        return Kind.JUMP, target
    if name in ("cbz", "cbnz") or (name[:1] == "b" and name[1:] in CONDITIONS):
        return Kind.BRANCH, target
    if name in ("bl", "blx"):
        return (Kind.CALL, target) if target is not None else (Kind.UNKNOWN, None)
    if name == "bx":
        return (Kind.RETURN, None) if operands == "lr" else (Kind.UNKNOWN, None)
    if (name.startswith(("pop", "ldm")) and re.search(r"\bpc\b", operands)) or (name == "ldr" and operands.startswith("pc, [sp]")):
        return Kind.RETURN, None
    if name in ("tbb", "tbh") or (name == "add" and writes_pc):
        return Kind.SWITCH, None
    if name == "mov" and writes_pc:
        return (Kind.RETURN, None) if operands == "pc, lr" else (Kind.UNKNOWN, None)
    if writes_pc:
        return Kind.UNKNOWN, None
    return Kind.NEXT, None


def words(name, operands):
    """Words that a load or store moves: the registers in its braces, or two for the double-word forms."""
    braces = re.search(r"\{(.*?)\}", operands)
    if not braces:
        return 2 if name.startswith(("ldrd", "strd")) or re.match(r"d\d", operands) else 1
    count = 0
    for item in braces[1].split(","):
        first, _, last = item.strip().partition("-")
        registers = int(last[1:]) - int(first[1:]) + 1 if last else 1
        count += registers * (2 if first.startswith("d") else 1)
    return count


CLASSES = (
    (("vldm", "vpop"), "float_load_multiple"),
    (("vstm", "vpush"), "float_store_multiple"),
    (("vldr",), "float_load"),
    (("vstr",), "float_store"),
    (("vdiv",), "float_divide"),
    (("vsqrt",), "float_root"),
    (("vmla", "vmls", "vnmla", "vnmls", "vfma", "vfms", "vfnma", "vfnms"), "float_multiply_add"),
    (("vadd", "vsub", "vmul", "vnmul"), "float_arithmetic"),
    (("v",), "float_move"),
    (("ldm", "pop", "ldrd"), "load_multiple"),
    (("stm", "push", "strd"), "store_multiple"),
    (("ldr",), "load"),
    (("str",), "store"),
    (("udiv", "sdiv"), "divide"),
    (("umlal", "smlal", "umaal"), "multiply_long_add"),
    (("umull", "smull"), "multiply_long"),
    (("mla", "mls", "smla", "smmla", "smmls"), "multiply_add"),
    (("mul", "smul", "smmul"), "multiply"),
    (("mrs", "msr"), "status_register"),
    (("udf", "bkpt", "svc", "dsb", "isb", "dmb", "cps"), "other"),
)


def class_of(instruction):
    """The row of the cycle tables, as `firmware/trace` tells it from what the emulator prints."""
    kind, name = instruction.kind, instruction.name
    if kind is Kind.RETURN and name != "bx" and name != "mov":
        return "load_return"
    if kind in (Kind.SWITCH, Kind.RETURN) or (kind is Kind.UNKNOWN and name != "blx"):
        return "jump_register"
    if kind is Kind.CALL or name == "blx":
        return "call"
    if kind is Kind.JUMP:
        return "branch"
    if kind is Kind.BRANCH:
        return "branch_conditional"
    if re.fullmatch("it[te]{0,3}", name):
        return "if_then"
    return next((found for prefixes, found in CLASSES if name.startswith(prefixes)), "alu")
