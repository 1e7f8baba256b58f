"""The table of docs/hardware.md, from data/core-synthesis.toml."""

from . import marked

CELLS = {
    "lut4": "LUT4",
    "carry": "cells of carry chains, CCU2C",
    "lut_ram": "memories of 16 × 4 bits in LUTs",
    "flip_flops": "flip-flops",
    "dsp": "multiplier blocks of 18 bits",
    "bram18": "memory blocks of 18 kbit",
    "mhz": "clock of the worst seed, MHz",
}
CYCLES = {
    "cycles_mean": "cycles from a setpoint to the next one, mean",
    "cycles_worst": "… worst",
    "ready_mean": "cycles until the core can be asked again, mean",
    "least_period": "least period with a queue of four, cycles",
}


def table(cores):
    """A column for each format. Times are those of the clock above them."""
    line = lambda what, cell: [what, *map(cell, cores)]
    lines = [line(words, lambda core, key=key: f"{core[key]:,}") for key, words in CELLS.items()]
    for key, words in CYCLES.items():
        lines.append(line(words, lambda core, key=key: f"{core[key]:,}"))
        lines.append(line("… in µs", lambda core, key=key: f"{core[key] / core['mhz']:.2f}"))
    return marked.rows(["ECP5, speed grade 6", *(core["format"] for core in cores)], lines, len(cores))
