"""The greatest cost of a period, as a linear program over how often each block and edge is passed.

| | |
|---|---|
| unknowns | passes of each block, of each edge between blocks, of each way out of a function; calls of each function |
| the step | is called once |
| a block | is passed as often as it is entered, and is left as often |
| a function | is called as often as the blocks that call it are passed |
| a loop of at most n turns | passes its header at most n + 1 times as often as it is entered |
| a sum | calls of some functions, or turns of some loops, in a period: at most so many |

Any period is such a flow, so that the greatest cost over all flows, be they of whole numbers or not, is no less than that of any
period. This is implicit path enumeration: Li and Malik, Performance Analysis of Embedded Software Using Implicit Path Enumeration
(1995).

The named constants K, J and S stand on the right-hand sides alone. So what the program's dual says of them holds for all of their
values: `cost <= base + Σ (dual of the sum) (its limit)`.
"""

import functools
import subprocess
import tempfile
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path

from . import Refused, facts as facts_of


@dataclass
class Row:
    name: str
    terms: list  # (coefficient, unknown)
    relation: str  # = or <=
    limit: int
    of: str = ""  # the expression of the limit, if it is of named constants


@dataclass
class Program:
    functions: dict
    entry: int
    rows: list = field(default_factory=list)

    @functools.cached_property
    def limits(self):
        """The rows that are no equations."""
        return [row for row in self.rows if row.relation == "<="]


def node(address):
    return f"n_{address:x}"


def edge(source, target, taken):
    return f"{'t' if taken else 'e'}_{source:x}_{target:x}"


def calls(address):
    return f"f_{address:x}"


def build(image, entry, facts, constants, functions):
    """The rows of the program; refuses a loop that nothing limits."""
    program = Program(functions, entry)
    callers = {address: [] for address in functions}
    for function in functions.values():
        for row in flow_rows(function, callers):
            program.rows.append(row)
    for address, sources in callers.items():
        terms = [(1, calls(address))] + [(-1, unknown) for unknown in sources]
        program.rows.append(Row(f"call_{address:x}", terms, "=", 1 if address == entry else 0))
    add_sums(program, image, facts, constants)
    add_loops(program, image, facts, constants)
    return program


def flow_rows(function, callers):
    if function.entry not in function.blocks:
        yield Row(f"absent_{function.entry:x}", [(1, calls(function.entry))], "=", 0)
    into = {address: [] for address in function.blocks}
    for address, block in function.blocks.items():
        for target, taken in block.successors:
            into[target].append(edge(address, target, taken))
    for address, block in function.blocks.items():
        terms = [(1, node(address))] + [(-1, unknown) for unknown in into[address]]
        if address == function.entry:
            terms.append((-1, calls(address)))
        yield Row(f"in_{address:x}", terms, "=", 0)
        out = [edge(address, target, taken) for target, taken in block.successors]
        if block.returns:
            out.append(f"r_{address:x}")
        if block.goes_on_with is not None:
            out.append(f"g_{address:x}")
            callers[block.goes_on_with].append(f"g_{address:x}")
        # A trap ends the period where it stands.
        if block.end.kind.value == "stop":
            out.append(f"r_{address:x}")
        yield Row(f"out_{address:x}", [(1, node(address))] + [(-1, unknown) for unknown in out], "=", 0)
        if block.callee is not None:
            callers[block.callee].append(node(address))


def counted_functions(program, image, facts):
    """Functions whose calls in a period a fact limits."""
    for fact in facts:
        if fact.kind == "sum":
            spec = fact.path[-1]
            found = [a for a in program.functions if facts_of.is_frame(image.function_at(a), spec)]
            if found:
                yield fact, found


def add_sums(program, image, facts, constants):
    for index, (fact, found) in enumerate(counted_functions(program, image, facts)):
        limit = facts_of.value(fact.in_period, constants)
        named = "" if fact.in_period.isdigit() else fact.in_period
        program.rows.append(Row(f"sum_{index}", [(1, calls(a)) for a in found], "<=", limit, named))


def add_loops(program, image, facts, constants):
    counted = {a for _, found in counted_functions(program, image, facts) for a in found}
    totals, refused = {}, []
    for function in program.functions.values():
        cuts = frozenset(a for a, b in function.blocks.items() if b.callee in counted)
        for loop, fact in facts_of.loops_of(image, function, facts, cuts):
            if fact is None and not loop.counted:
                refused.append(f"a loop without a bound: {facts_of.describe(image, function, loop)}")
            elif fact is not None:
                rows = totals.setdefault(fact.name, (fact, [], [])) if fact.in_period else None
                turns = 0 if fact.in_period else facts_of.value(fact.most, constants)
                entries = [(-1 - turns, unknown) for unknown in edges_of(function, loop.entry_edges)]
                for index, header in enumerate(loop.headers):
                    terms = [(1, node(header)), *entries]
                    if rows is None:
                        program.rows.append(Row(f"loop_{header:x}_{len(loop.body)}", terms, "<=", 0))
                    else:
                        rows[1 if index == 0 else 2].append(terms)
    if refused:
        raise Refused("\n".join(refused))
    for index, (fact, first, more) in enumerate(totals.values()):
        limit = facts_of.value(fact.in_period, constants)
        # All loops together take the turns; where a loop has more headers, each of them by itself.
        for number, terms in enumerate([sum(first, []), *more]):
            program.rows.append(Row(f"turns_{index}_{number}", terms, "<=", limit, fact.in_period))


def edges_of(function, pairs):
    for source, target in pairs:
        if source is None:
            yield calls(function.entry)
        else:
            for to, taken in function.blocks[source].successors:
                if to == target:
                    yield edge(source, target, taken)


def objective(program, cost):
    """The cost of each unknown."""
    for function in program.functions.values():
        for address, block in function.blocks.items():
            yield sum(cost.once(i) for i in block.instructions), node(address)
            more = cost.taken(block.end)
            if more:
                for target, taken in block.successors:
                    if taken:
                        yield more, edge(address, target, True)
                if block.goes_on_with is not None:
                    yield more, f"g_{address:x}"


@dataclass
class Bound:
    value: int
    passes: dict  # of each unknown
    parts: list  # (factor, expression): value = base + Σ factor · expression
    base: Fraction


def solve(program, cost):
    """The greatest cost, by GLPK."""
    text = ["Maximize", " cost: " + " ".join(f"+ {c} {u}" for c, u in objective(program, cost)), "Subject To"]
    for row in program.rows:
        terms = " ".join(f"{'+' if c >= 0 else '-'} {abs(c)} {u}" for c, u in merged(row.terms))
        text.append(f" {row.name}: {terms} {row.relation} {row.limit}")
    text.append("End")
    with tempfile.TemporaryDirectory() as folder:
        source, result = Path(folder, "step.lp"), Path(folder, "step.sol")
        source.write_text("\n".join(text) + "\n")
        done = subprocess.run(["glpsol", "--lp", source, "--write", result], capture_output=True, text=True, check=False)
        if not result.exists():
            raise Refused(f"glpsol: {done.stdout[-500:]}")
        return read_solution(program, result.read_text(), done.stdout, names(text))


def greatest(bounds):
    """The bound of several cases, one of which holds: the greatest, if it is so for all K, J and S, none of which is below 1."""
    first = max(bounds, key=lambda bound: bound.value)
    factors = {of: factor for factor, of in first.parts}
    for other in bounds:
        steeper = any(factor > factors.get(of, 0) + 1e-6 for factor, of in other.parts)
        if steeper or least(other) > least(first) + 1e-6:
            raise Refused(f"two cases of which none is always the longer one: {first.parts}, {other.parts}")
    return first


def least(bound):
    """The bound where K, J and S are 1."""
    return bound.base + sum(factor * facts_of.value(of, {"K": 1, "J": 1, "S": 1}) for factor, of in bound.parts)


def merged(terms):
    sums = {}
    for coefficient, unknown in terms:
        sums[unknown] = sums.get(unknown, 0) + coefficient
    return [(c, u) for u, c in sums.items() if c] or [(0, terms[0][1])]


def names(text):
    """The unknowns in the order in which GLPK meets them."""
    found = {}
    for line in text[1:]:
        for word in line.split():
            if word[:2] in ("n_", "e_", "t_", "f_", "r_", "g_"):
                found.setdefault(word)
    return list(found)


def read_solution(program, text, log, unknowns):
    """GLPK's file of a solution: `s bas ROWS COLUMNS STATUS STATUS VALUE`, `i ROW STATUS VALUE DUAL`, `j COLUMN …`."""
    rows, passes, value = {}, {}, None
    for line in text.splitlines():
        words = line.split()
        if words[:2] == ["s", "bas"]:
            if words[4:6] != ["f", "f"]:
                raise Refused(f"no bound: the linear program has no finite optimum\n{log[-300:]}")
            value = float(words[6])
        elif words[:1] == ["i"]:
            rows[int(words[1])] = float(words[4])
        elif words[:1] == ["j"]:
            passes[unknowns[int(words[1]) - 1]] = float(words[3])
    parts = {}
    for index, row in enumerate(program.rows, 1):
        if row.of and round(rows[index]) >= 1:
            parts[row.of] = parts.get(row.of, 0) + rows[index]
    named = sum(rows[i] * row.limit for i, row in enumerate(program.rows, 1) if row.of)
    return Bound(int(value + 1e-6), passes, sorted((factor, of) for of, factor in parts.items()), value - named)
