"""What a block costs: instructions, or cycles by a table of `firmware/trace/cycles`."""

import tomllib
from pathlib import Path

from . import Refused
from .instruction import class_of, words

TABLES = Path(__file__).parent.parent / "trace" / "cycles"


class Instructions:
    """Every instruction costs one."""

    unit = "instructions"

    def once(self, _instruction):
        return 1

    def taken(self, _instruction):
        return 0


class Cycles:
    """The most that the manual allows; memory without wait states. Where a processor has the multiplier of one cycle, that."""

    unit = "cycles"

    def __init__(self, table, fast_multiplier=True):
        self.rows = tomllib.loads((TABLES / f"{table}.toml").read_text())["class"]
        self.fast_multiplier = fast_multiplier

    def row(self, instruction):
        name = class_of(instruction)
        if name not in self.rows:
            raise Refused(f"the table of cycles has no row `{name}`: {instruction}")
        return name, self.rows[name]

    def once(self, instruction):
        name, row = self.row(instruction)
        _, typical, most = row["cycles"]
        if name == "multiply" and self.fast_multiplier:
            most = typical
        return most + row.get("per_word", 0) * words(instruction.name, instruction.operands)

    def taken(self, instruction):
        _, row = self.row(instruction)
        return row.get("taken", [0, 0, 0])[2]
