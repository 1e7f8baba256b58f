"""What the code cannot say: the facts of `data/step-facts.toml`, and the blocks and loops of an image that they are about.

A fact names its place by functions of the source, the outermost first, as the chain of inlined calls has them: `["follow",
"follow_on<9, false>"]`. Numbers in brackets are the last of the generic arguments.
"""

import functools
import re
import tomllib
from dataclasses import dataclass, replace

from .flow import Function
from .loops import loops


@dataclass
class Fact:
    kind: str  # absent, loop or sum
    path: list
    why: str
    most: str = ""  # turns of a loop from each entry
    in_period: str = ""  # turns of all these loops, or calls of these functions, in a period
    unless: str = ""  # a property of a part in which the fact does not hold
    line: str = ""  # part of the source line: of all that is absent, or of a loop's header where a function has several loops
    symbol: str = ""  # part of the full name of the function in the image, types included

    @property
    def name(self):
        return " > ".join(self.path) + (f" at `{self.line}`" if self.line else "")


def read(path, properties):
    """The facts that hold for a part with these properties."""
    table = tomllib.loads(path.read_text())
    facts = [Fact(kind, **entry) for kind in ("absent", "loop", "sum") for entry in table.get(kind, [])]
    return [fact for fact in facts if fact.unless not in properties]


def read_cases(path):
    """Sums of which one or the other holds in every period. The bound is the greatest that any of them leaves."""
    cases = tomllib.loads(path.read_text()).get("case", [])
    return [Fact("sum", case["path"], case["why"], in_period=case["in_period"]) for case in cases] or [None]


def value(expression, constants):
    """A sum, difference or product of named constants and numbers."""
    if not re.fullmatch(r"[\w\s+*()-]+", expression):
        raise ValueError(f"`{expression}` is no expression of named constants")
    return eval(expression, {"__builtins__": {}}, dict(constants))  # noqa: S307


@functools.cache
def parts_of(spec):
    """The function that a fact names, and its generic arguments."""
    name, _, numbers = spec.rstrip(">").partition("<")
    return name, tuple(n.strip() for n in numbers.split(",")) if numbers else ()


def is_frame(frame, spec):
    """Whether a frame is of the function that a fact names."""
    name, wanted = parts_of(spec)
    return name in ("*", frame.function) and (not wanted or frame.numbers[-len(wanted) :] == wanted)


def depth_along(chain, path):
    """The place of the last function of `path` in a chain, the outermost first, in which they all occur in this order."""
    at = -1
    for spec in path:
        at = next((i for i in range(at + 1, len(chain)) if is_frame(chain[i], spec)), None)
        if at is None:
            return None
    return at


def without_absent(image, function, facts):
    """The function less the code that is never executed.

    Such code is entered from the function that it is inlined in, by a decision that has a line of its own there. What is entered from
    anywhere else, as from the inside of another inlined function, the compiler has merged with code that is executed: it stays, and
    so does what follows it.
    """
    absent = [fact for fact in facts if fact.kind == "absent"]
    image.locate(i.address for i in function.instructions())
    kept, waiting = set(), [(function.entry, None)]
    while waiting:
        address, source = waiting.pop()
        block = function.blocks[address]
        if address in kept or is_absent(image, block, source, absent):
            continue
        kept.add(address)
        merged = label(image, block, absent) is not None
        waiting += [(target, block if not merged else "merged") for target, _ in block.successors]
    blocks = {a: replace(b, successors=[(t, j) for t, j in b.successors if t in kept]) for a, b in function.blocks.items() if a in kept}
    return Function(function.entry, function.name, blocks)


def label(image, block, absent):
    """The fact that says that all of a block is absent, and how far in. Instructions without a line are the compiler's own."""
    chains = [image.places(i.address)[::-1] for i in block.instructions]
    chains = [chain for chain in chains if chain[-1].line] or chains
    for fact in absent:
        depths = {depth_along(chain, fact.path) for chain in chains}
        if None not in depths and all(has_line(image, chain, fact) for chain in chains):
            return fact, min(depths)
    return None


def is_absent(image, block, source, absent):
    """Whether a block is absent code that is entered from where it is called."""
    found = label(image, block, absent)
    if found is None or source == "merged":
        return False
    fact, depth = found
    if source is not None and not fact.line and depth > 0:
        chain = image.places(source.end.address)[::-1]
        if len(chain) != depth or chain[-1].line == 0:
            return False
    return True


def has_line(image, chain, fact):
    """Whether the fact's line, if it names one, is among the lines of a chain."""
    return not fact.line or any(fact.line in image.text_of(frame) for frame in chain)


def chain_of(image, function, loop):
    """The inlined calls that all instructions of a loop have in common, the outermost first."""
    chains = [image.places(i.address)[::-1] for address in loop.body for i in function.blocks[address].instructions]
    common = chains[0]
    for chain in chains[1:]:
        same = 0
        while same < min(len(common), len(chain)) and common[same].name == chain[same].name:
            same += 1
        common = common[:same]
    return common


def loop_fact(image, function, loop, facts):
    """The fact about a loop: of those that fit, the one about the innermost function."""
    chain = chain_of(image, function, loop)
    header = [frame for header in loop.headers for i in function.blocks[header].instructions for frame in image.places(i.address)]
    fitting = []
    for fact in facts:
        depth = depth_of_loop(chain, fact.path) if fact.kind == "loop" else None
        if depth is not None and has_line(image, header, fact) and fact.symbol in image.full_name(function.entry):
            fitting.append((depth, len(fact.path), bool(fact.line), bool(fact.symbol), fact))
    return max(fitting, key=lambda found: found[:-1], default=[None])[-1]


def depth_of_loop(chain, path):
    """Where in a loop's chain the function is that `path` names last, if all that is inlined further in belongs to libraries."""
    depth = depth_along(chain, path)
    while depth is not None and any(is_frame(frame, path[-1]) for frame in chain[depth + 1 :]):
        depth = next(i for i in range(depth + 1, len(chain)) if is_frame(chain[i], path[-1]))
    if depth is None or any(frame.file.startswith("crates/") for frame in chain[depth + 1 :]):
        return None
    return depth


def describe(image, function, loop):
    chain = " > ".join(str(frame) for frame in chain_of(image, function, loop)) or function.name
    return f"{chain}, at {', '.join(f'{h:#x}' for h in loop.headers)}"


def all_loops(found):
    for loop in found:
        yield loop
        yield from all_loops(loop.inner)


def loops_of(image, function, facts, counted):
    """The loops of a function, each with the fact that says how often it turns, or None if counted blocks limit it."""
    known = {}

    def is_known(loop):
        fact = loop_fact(image, function, loop, facts)
        if fact:
            known[loop.headers[0], loop.body] = fact
        return fact is not None

    found = list(all_loops(loops(function, counted, is_known)))
    return [(loop, known.get((loop.headers[0], loop.body))) for loop in found]
