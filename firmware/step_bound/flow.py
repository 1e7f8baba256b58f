"""Blocks and edges of each function that a step reaches."""

import struct
from dataclasses import dataclass, field

from . import Refused
from .instruction import Kind


@dataclass
class Block:
    """Instructions of which all are executed when the first is. A call ends a block."""

    address: int
    instructions: list = field(default_factory=list)
    # Addresses of blocks of the same function, and whether the last instruction jumps there.
    successors: list = field(default_factory=list)
    # The function called at the end, which comes back.
    callee: int | None = None
    # Whether the function may return at the end.
    returns: bool = False
    # The function that the last instruction goes on with, and that returns to this one's caller.
    goes_on_with: int | None = None

    @property
    def end(self):
        return self.instructions[-1]


@dataclass
class Function:
    entry: int
    name: str
    blocks: dict

    def instructions(self):
        return [i for block in self.blocks.values() for i in block.instructions]


def reach(image, entry, without=lambda function: function):
    """All functions that the one at `entry` reaches, by address, once `without` has taken from each what is never executed; refuses
    recursion."""
    functions, waiting = {}, [entry]
    while waiting:
        address = waiting.pop()
        if address not in functions:
            functions[address] = without(function_at(image, address))
            waiting += sorted(callees(functions[address]))
    refuse_recursion(functions, entry)
    return functions


def callees(function):
    """The functions that a function calls, or goes on with."""
    found = {callee for block in function.blocks.values() for callee in (block.callee, block.goes_on_with)}
    return found - {None}


def refuse_recursion(functions, entry):
    done, path = set(), []
    absent = {address for address, function in functions.items() if not function.blocks}

    def visit(address):
        if address in path:
            names = [functions[a].name for a in path[path.index(address) :]]
            raise Refused(f"recursion: {' > '.join(names + names[:1])}")
        if address in done or address in absent:
            return
        path.append(address)
        for callee in sorted(callees(functions[address])):
            visit(callee)
        path.pop()
        done.add(address)

    visit(entry)


def function_at(image, entry):
    """Decodes what can be reached from `entry` without leaving the function."""
    name = image.name_at(entry)
    leaders, flows = {entry}, {}
    waiting = [entry]
    while waiting:
        address = waiting.pop()
        while address not in flows:
            instruction = image.instructions.get(address)
            if instruction is None:
                raise Refused(f"{name}: no instruction at {address:#x}")
            jumps, goes_on = ways_on(image, name, entry, instruction)
            flows[address] = (jumps, goes_on)
            leaders.update(jumps)
            waiting += jumps
            if jumps or not goes_on or instruction.kind is not Kind.NEXT:
                leaders.add(instruction.after)
            if not goes_on:
                break
            address = instruction.after
    return Function(entry, name, cut_blocks(image, entry, leaders & flows.keys(), flows))


def is_other_function(image, entry, target):
    return target != entry and target in image.symbols


def ways_on(image, name, entry, instruction):
    """Targets within the function, and whether the next instruction may follow."""
    kind, target = instruction.kind, instruction.target
    where = f"{name}, {instruction}"
    if kind is Kind.UNKNOWN:
        raise Refused(f"indirect {'call' if instruction.name == 'blx' else 'jump'}: {where}")
    if kind is Kind.CALL and instruction.conditional:
        raise Refused(f"a call inside an if-then block: {where}")
    if kind is Kind.CALL and target not in image.symbols:
        # A jump that is too far for a branch: the caller's return address lies on the stack.
        return [target], False
    if kind in (Kind.NEXT, Kind.CALL):
        return [], True
    if kind in (Kind.JUMP, Kind.BRANCH):
        inside = [] if is_other_function(image, entry, target) else [target]
        return inside, kind is Kind.BRANCH
    if kind is Kind.RETURN:
        return [], instruction.conditional
    if kind is Kind.SWITCH:
        return sorted(set(switch_targets(image, where, instruction))), False
    return [], False


def cut_blocks(image, entry, leaders, flows):
    blocks = {}
    for leader in sorted(leaders):
        block = Block(leader)
        address = leader
        while True:
            instruction = image.instructions[address]
            block.instructions.append(instruction)
            address = instruction.after
            if address in leaders or not flows[instruction.address][1] or flows[instruction.address][0]:
                break
        finish(image, entry, block, flows)
        blocks[leader] = block
    return blocks


def finish(image, entry, block, flows):
    """Sets where control goes from the block's last instruction."""
    last = block.end
    jumps, goes_on = flows[last.address]
    block.successors = [(target, True) for target in jumps]
    if goes_on:
        block.successors.append((last.after, False))
    if last.kind is Kind.CALL and not jumps:
        block.callee = last.target
    if last.kind is Kind.RETURN:
        block.returns = True
    if last.kind in (Kind.JUMP, Kind.BRANCH) and is_other_function(image, entry, last.target):
        block.goes_on_with = last.target


def switch_targets(image, where, instruction):
    """The targets of a jump table. The table lies behind the jump and ends where the first of its targets begins, or with the
    last entry that leads to code."""
    if instruction.name in ("tbb", "tbh"):
        width, base, table = (1 if instruction.name == "tbb" else 2), instruction.after, instruction.after
    else:
        # `ldrb` or `ldrh` from the table, doubled, added to pc: the pc of `add` is four bytes on.
        width, table = table_of_add(image, where, instruction)
        base = instruction.address + 4
    targets, address = [], table
    while address not in image.instructions and (not targets or address < min(t for t in targets if t > table)):
        raw = image.bytes_at(address, width)
        offset = raw[0] if width == 1 else struct.unpack("<H", raw)[0]
        target = base + 2 * offset
        if target not in image.instructions:
            break
        targets.append(target)
        address += width
    if not targets:
        raise Refused(f"no jump table: {where}")
    return targets


def table_of_add(image, where, instruction):
    """Width and address of the table of `add rT, pc; ldrh rT, [rT, #4]; lsls rT, rT, #1; add pc, rT`."""
    register = instruction.operands.removeprefix("pc, ")
    before = [image.instructions.get(instruction.address - 2 * n) for n in (1, 2, 3)]
    shapes = (("lsls", f"{register}, {register}, #1"), ("ldr", f"{register}, [{register}, #4]"), ("add", f"{register}, pc"))
    for found, (name, operands) in zip(before, shapes):
        if found is None or not found.name.startswith(name) or found.operands != operands:
            raise Refused(f"a jump to a register that no jump table gives: {where}")
    width = {"ldrb": 1, "ldrh": 2}.get(before[1].name)
    pc = before[2].address + 4
    if width is None or pc % 4:
        raise Refused(f"a jump to a register that no jump table gives: {where}")
    return width, pc + 4
