"""The README's table of formats, ten lines of it, from the JSON of `feedbits compare`."""

import math

from . import marked

MOST_ROWS = 8  # with the two lines above them, ten
HEADER = ["format", "bits", "fluctuation at cruise", "how far from the limit", "verdict"]
VERDICTS = {"good": "**good**", "bad": "not good enough", "refused": "refused"}


def table(comparison):
    limit = comparison["machine"]["fluctuation_limit"]
    return marked.rows(HEADER, [cells(row, limit) for row in shown(comparison["formats"])])


def shown(rows):
    """Compiled pieces alone; floats, which everybody knows, and as many of the others as there is room for, in their order."""
    pieces = [row for row in rows if row["engine"] == "pieces"]
    floats = [row["format"] for row in pieces if row["format"].startswith("f")]
    others = [row["format"] for row in pieces if row["format"] not in floats][: MOST_ROWS - len(floats)]
    return [row for row in pieces if row["format"] in floats + others]


def margin(row, fluctuation_limit):
    """What fails, or how often the fluctuation goes into its limit."""
    verdict = row["verdict"]
    if verdict["result"] == "bad":
        return "; ".join(verdict["reasons"])
    if verdict["result"] == "refused":
        return verdict["reasons"]
    times = fluctuation_limit / row["fluctuation"]["cruise_max_abs"]
    power = math.floor(math.log10(times))
    digits = f"{times:.1f}" if power < 2 else f"{times:.0f}" if power < 4 else f"{math.floor(times / 10**power)}e{power}"
    return f"{digits} times better than asked"


def cells(row, fluctuation_limit):
    fluctuation = row["fluctuation"]
    at_cruise = f"{fluctuation['cruise_max_abs']:.1e}".replace("e-0", "e-") if fluctuation else ""
    return [row["format"], row["bits"], at_cruise, margin(row, fluctuation_limit), VERDICTS[row["verdict"]["result"]]]
