"""Loops of a function: strongly connected blocks, and those within them.

A loop is entered by its header. Where compilers have let it be entered in several places, the blocks that every round passes once stand
for them, or, if there is none, each of them is a header. Between two passes of the same block lies a turn of the loop, so that a loop that
is entered e times and turns t times passes each of its headers at most e + t times; and no round misses all headers. A round that passes a block whose number is limited otherwise needs no other limit.
"""

from dataclasses import dataclass


@dataclass
class Loop:
    headers: list  # the blocks one of which every round passes
    body: frozenset  # addresses of blocks, the headers included
    entry_edges: list  # (from, header), from outside; None stands for the call of the function
    counted: frozenset  # blocks of it whose number in a period a fact limits
    inner: list  # the loops that are left without the headers, or without the counted blocks


def loops(function, counted=frozenset(), is_known=lambda loop: True):
    """The outermost loops. `counted` are blocks whose number in a period is limited; `is_known` says whether the turns of a loop are, so
    that it need not be cut at the counted blocks."""
    return within(function, frozenset(function.blocks), counted, is_known)


def within(function, region, counted, is_known):
    found = []
    for body in components(function, region):
        loop = outline(function, body, counted)
        cut = set(loop.headers) if is_known(loop) or not loop.counted else loop.counted
        loop.inner = within(function, body - cut, counted, is_known)
        found.append(loop)
    return found


def outline(function, body, counted):
    edges = [(source, target) for source, block in function.blocks.items() for target, _ in block.successors]
    entries = [(source, target) for source, target in edges if target in body and source not in body]
    if function.entry in body:
        entries.append((None, function.entry))
    headers = sorted({target for _, target in entries})
    if len(headers) > 1:
        headers = turnstiles(function, body, headers) or headers
    return Loop(headers, body, entries, body & counted, [])


def turnstiles(function, body, headers):
    """The blocks that every round passes once: without one of them no round passes a header, and no round avoids the headers and passes
    it."""
    aside = set().union(*components(function, body - set(headers)))

    def is_met(block):
        rest = components(function, body - {block})
        return not any(header in part for part in rest for header in headers)

    return [block for block in sorted(body - aside) if is_met(block)]


def components(function, region):
    """The sets of blocks in `region` that reach each other; a single block only if it follows itself. Tarjan (1972)."""
    number, low, stack, found = {}, {}, [], []

    def successors(block):
        return [target for target, _ in function.blocks[block].successors if target in region]

    def close(block):
        members = set()
        while True:
            member = stack.pop()
            members.add(member)
            low[member] = len(function.blocks) * 2  # no longer on the stack
            if member == block:
                break
        if len(members) > 1 or block in successors(block):
            found.append(frozenset(members))

    for root in sorted(region):
        if root in number:
            continue
        work = [(root, iter(successors(root)))]
        number[root] = low[root] = len(number)
        stack.append(root)
        while work:
            block, rest = work[-1]
            for target in rest:
                if target not in number:
                    number[target] = low[target] = len(number)
                    stack.append(target)
                    work.append((target, iter(successors(target))))
                    break
                low[block] = min(low[block], low[target])
            else:
                work.pop()
                if work:
                    above = work[-1][0]
                    low[above] = min(low[above], low[block])
                if low[block] == number[block]:
                    close(block)
    return found
