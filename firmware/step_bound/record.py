"""The bounds as a data file, `data/step-bounds.toml`, for whoever prints them and for the check."""

import tomllib
from pathlib import Path

from . import Refused, facts

FILE = Path(__file__).parents[2] / "data/step-bounds.toml"
UNITS = ("instructions", "cycles")
TERMS = ("base", "K", "J", "S")
HEAD = """\
# The most that a period of a compiled part takes, on the image of the built-in example as scripts/firmware links it: at most
# `base`, and for each of K, J and S so many times that number. It holds for parts of the same format, dimension and degree without
# weights, as docs/step-bound.md explains.
# Written by scripts/step-bound, except for `ratio`.
compiler = "{compiler}"

# The bound of a period of the plan may be this many times the worst one found.
[ratio]
"""


def coefficients(bound):
    """The bound as a sum of multiples of K, J and S."""
    found = dict.fromkeys(TERMS, 0)
    found["base"] = bound.base
    for factor, of in bound.parts:
        none = facts.value(of, dict.fromkeys("KJS", 0))
        each = {name: facts.value(of, dict.fromkeys("KJS", 0) | {name: 1}) - none for name in "KJS"}
        if facts.value(of, dict.fromkeys("KJS", 1)) != none + sum(each.values()):
            raise Refused(f"{of}: a product of K, J and S has no place in the file")
        found["base"] += factor * none
        for name in "KJS":
            found[name] += factor * each[name]
    return {name: round(value) for name, value in found.items()}


def entry(name, part, found, shipped, hard):
    """What is recorded of a target."""
    table = {"name": name, "format": part.format, "dimension": part.dimension, "degree": part.degree}
    table |= {"K": part.evaluations, "J": part.joints, "S": part.stages_in_last_period}
    table |= {"worst_of_the_part": shipped, "worst_found": max(shipped, hard)}
    for bound in found:
        table[bound.period] = {unit: coefficients(getattr(bound, unit)) for unit in UNITS}
    return table


def value(terms, of):
    """The bound at the K, J and S of an entry."""
    k, j, s = of["K"], of["J"], of["S"]
    return terms["base"] + terms["K"] * k + terms["J"] * j + terms["S"] * s


def recorded():
    return tomllib.loads(FILE.read_text())


def write(entries, compiler):
    lines = [HEAD.format(compiler=compiler) + "\n".join(f"{name} = {ratio}" for name, ratio in recorded()["ratio"].items())]
    for table in entries:
        lines.append("\n[[target]]")
        for key, found in table.items():
            if isinstance(found, dict):
                for unit, terms in found.items():
                    text = ", ".join(f"{name} = {number}" for name, number in terms.items())
                    lines.append(f"{key}.{unit} = {{ {text} }}")
            else:
                lines.append(f"{key} = " + (f'"{found}"' if isinstance(found, str) else str(found)))
    FILE.write_text("\n".join(lines) + "\n")


def compare(entries, compiler):
    """What is wrong with these bounds: they are not the recorded ones, or are too far above what was found."""
    known = recorded()
    share = 0.02 if known["compiler"] == compiler else 0.25
    for now in entries:
        name = now["name"]
        before = next((table for table in known.get("target", []) if table["name"] == name), None)
        if before is None:
            yield f"{name} has no recorded bound"
            continue
        for period in (key for key in now if isinstance(now[key], dict)):
            for unit in UNITS:
                old, new = (value(table[period][unit], now) for table in (before, now))
                if abs(new - old) > share * old:
                    yield f"{name}, {period}: {new:,} {unit} in place of {old:,}"
        ratio, most = value(now["plan"]["instructions"], now) / now["worst_found"], known["ratio"][name]
        if ratio > most:
            yield f"{name}: the bound is {ratio:.2f} times the worst period found, and may be {most} times that"
