"""The tables of docs/targets.md, from data/target-costs.toml."""

from . import marked

PATHS = ("paper_a", "ten_points")
HEADER = ["a period's instructions", "periods", "share", "mean", "median", "p99", "worst"]


def tables(costs):
    """By their names."""
    about = marked.rows(["toolchain", ""], [(key.replace("_", " "), value) for key, value in sorted(costs["toolchain"].items())])
    return {"toolchain": about, "parts": parts(costs), **{path: along(path, costs["target"]) for path in PATHS}}


def titles(costs):
    return {target["name"]: target["title"] for target in costs["target"]}


def parts(costs):
    """What a period of each compiled part takes, by what it passes."""
    chapters = []
    for part in costs["part"]:
        periods = part["period"]["calls"]
        share = lambda row: f"{100 * row['calls'] / periods:.2f} %"
        lines = [[kind["name"], kind["calls"], share(kind), *instructions(kind)] for kind in part["kind"]]
        lines.append(["**all periods**", periods, share(part["period"]), *instructions(part["period"])])
        lines.append(["setting a run to its begin", part["start"]["calls"], "", *instructions(part["start"])])
        heading = f"### {part['program']}, {part['format']} on {titles(costs)[part['target']]}\n\n{part['stack_bytes']} bytes of stack.\n\n"
        chapters.append(heading + marked.rows(HEADER, lines, len(HEADER) - 1))
    return "\n".join(chapters)


def instructions(row):
    return [f"{row['mean']:.0f}", row["median"], row["p99"], row["max"]]


def along(path, targets):
    """What a step takes along a path, in each format on each target."""
    columns = [{row["name"]: row["step"][path] for row in target["format"] if path in row.get("step", {})} for target in targets]

    def table(corner, cell):
        lines = [[name, *(cell(column[name]) if name in column else "" for column in columns)] for name in columns[0]]
        return marked.rows([corner, *(target["title"] for target in targets)], lines, len(targets))

    return "\n".join([
        table("Instructions a step, mean (worst)", lambda step: f"{step['instructions']['mean']:.0f} ({step['instructions']['max']})"),
        table("Cycles a step, typical (low–high), mean", lambda step: cycles(step["instructions"]["cycles"])),
        table("Stack of a step, bytes", lambda step: step["stack_bytes"]),
    ])


def cycles(price):
    return price if price == "unknown" else f"{price['typical']:.0f} ({price['low']:.0f}–{price['high']:.0f})"
