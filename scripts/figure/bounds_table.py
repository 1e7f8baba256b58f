"""The table of docs/step-bound.md, from data/step-bounds.toml."""

from . import marked

KINDS = {"plan": "a period of the plan", "last": "a schedule's last period", "landing": "a landing step"}
TERMS = ("K", "J", "S")


def table(bounds, titles):
    """The bounds of the built-in example, whose K, J and S are the same on all cores."""
    targets = bounds["target"]
    limits = ", ".join(f"{term} = {targets[0][term]}" for term in TERMS)
    header = [f"at most, {limits}", *(f"{titles[target['name']].split(',')[0]}, {target['format']}" for target in targets)]
    line = lambda what, cell: [what, *map(cell, targets)]
    lines = []
    for kind, words in KINDS.items():
        lines.append(line(f"instructions of {words}", lambda target: f"{bound(target, kind, 'instructions'):,}"))
        lines.append(line("… cycles", lambda target: f"{bound(target, kind, 'cycles'):,}"))
    worst = "instructions of the worst period of the plan that the part has, counted"
    lines.append(line(worst, lambda target: f"{target['worst_of_the_part']:,}"))
    lines.append(line("… that a search has found", lambda target: f"{target['worst_found']:,}"))
    ratio = lambda target: f"{bound(target, 'plan', 'instructions') / target['worst_found']:.2f}"
    lines.append(line("the bound, over the worst that was found", ratio))
    return marked.rows(header, lines, len(targets))


def bound(target, kind, unit):
    terms = target[kind][unit]
    return terms["base"] + sum(terms[term] * target[term] for term in TERMS)
