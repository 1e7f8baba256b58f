"""The table of docs/step-bound.md, from data/step-bounds.toml."""

from . import marked

NAME = "step-bounds"
KINDS = {"plan": "a period of the plan", "last": "a schedule's last period", "landing": "a landing step"}
TERMS = ("K", "J", "S")


def table(bounds, costs):
    """The bounds, with titles from data/target-costs.toml."""
    titles = {target["name"]: target["title"].split(",")[0] for target in costs["target"]}
    targets = bounds["target"]
    at = {tuple(target[term] for term in TERMS) for target in targets}
    [values] = at  # All parts are the built-in example.
    corner = "at most, " + ", ".join(f"{term} = {value}" for term, value in zip(TERMS, values))
    header = [corner, *(f"{titles[target['name']]}, {target['format']}" for target in targets)]
    lines = []
    for kind, words in KINDS.items():
        for unit, what in (("instructions", f"instructions of {words}"), ("cycles", "… cycles")):
            lines.append([what, *(f"{bound(target, kind, unit):,}" for target in targets)])
    counted = "instructions of the worst period of the plan that the part has, counted"
    lines.append([counted, *(f"{target['worst_of_the_part']:,}" for target in targets)])
    lines.append(["… that a search has found", *(f"{target['worst_found']:,}" for target in targets)])
    ratios = (bound(target, "plan", "instructions") / target["worst_found"] for target in targets)
    lines.append(["the bound, over the worst that was found", *(f"{ratio:.2f}" for ratio in ratios)])
    return marked.rows(header, lines)


def bound(target, kind, unit):
    terms = target[kind][unit]
    return terms["base"] + sum(terms[term] * target[term] for term in TERMS)
