"""Tables between markers, and what they are made of."""

import unittest

from figure import bounds_table, core_table, formats_table, marked, target_tables


class Marked(unittest.TestCase):
    def test_a_table_is_filled_and_others_stay(self):
        page = "a\n<!-- table: one -->\nold\n<!-- table: end -->\nb\n<!-- table: two -->\n<!-- table: end -->\n"
        self.assertEqual(marked.names(page), ["one", "two"])
        filled = marked.filled(page, {"one": "| new |\n"})
        self.assertEqual(filled, page.replace("old", "| new |"))
        self.assertEqual(marked.filled(filled, {"one": "| new |\n"}), filled)

    def test_columns_of_numbers_are_to_the_right(self):
        self.assertEqual(marked.rows(["a", "b"], [["x", 1], ["y", 2]], 1), "| a | b |\n|---|---:|\n| x | 1 |\n| y | 2 |\n")


class Formats(unittest.TestCase):
    def row(self, name, figure, result="good", reasons=None, engine="pieces"):
        return {"format": name, "bits": 32, "engine": engine, "fluctuation": figure and {"cruise_max_abs": figure},
                "verdict": {"result": result, "reasons": reasons}}

    def test_rows(self):
        rows = [self.row("I16F16", 5.1e-5, "bad", ["too coarse", "too far"]), self.row("I8F24", 2.2e-7), self.row("I1F31", None, "refused", "no"),
                self.row("f32", 2.4e-9), self.row("f64", 1.2e-14), self.row("f64", 1e-3, engine="de-boor-secant")]
        table = formats_table.table({"machine": {"fluctuation_limit": 1e-6}, "formats": rows}).splitlines()
        self.assertEqual(table[2:], [
            "| I16F16 | 32 | 5.1e-5 | too coarse; too far | not good enough |",
            "| I8F24 | 32 | 2.2e-7 | 4.5 times better than asked | **good** |",
            "| I1F31 | 32 |  | no | refused |",
            "| f32 | 32 | 2.4e-9 | 417 times better than asked | **good** |",
            "| f64 | 32 | 1.2e-14 | 8e7 times better than asked | **good** |",
        ])

    def test_floats_are_always_among_them(self):
        rows = [self.row(f"I{n}F{32 - n}", 1e-7) for n in range(2, 14)] + [self.row("f32", 1e-7)]
        shown = [row["format"] for row in formats_table.shown(rows)]
        self.assertEqual((len(shown), shown[-1]), (formats_table.MOST_ROWS, "f32"))


class Targets(unittest.TestCase):
    known = {"mean": 12.4, "max": 30, "cycles": {"low": 1.0, "typical": 2.0, "high": 3.4}}
    unknown = {"mean": 7.0, "max": 9, "cycles": "unknown"}
    some = {"calls": 3, "mean": 5.0, "median": 4, "p99": 9, "max": 9}

    def costs(self):
        step = lambda instructions: {"paper_a": {"stack_bytes": 96, "instructions": instructions}, "ten_points": {"stack_bytes": 8, "instructions": instructions}}
        part = {"program": "a part", "target": "m3", "format": "f32", "stack_bytes": 9, "start": self.some | {"calls": 1},
                "period": self.some | {"calls": 4}, "kind": [self.some | {"name": "knot"}]}
        return {"toolchain": {"opt_level": "3"}, "part": [part],
                "target": [{"name": "m3", "title": "M3", "format": [{"name": "f32", "step": step(self.known)}, {"name": "u64"}]},
                           {"name": "m7", "title": "M7", "format": [{"name": "f32", "step": step(self.unknown)}]}]}

    def test_tables(self):
        tables = target_tables.tables(self.costs())
        self.assertIn("| f32 | 12 (30) | 7 (9) |\n", tables["paper_a"])
        self.assertIn("| f32 | 2 (1–3) | unknown |\n", tables["ten_points"])
        self.assertIn("| f32 | 96 | 96 |\n", tables["paper_a"])
        self.assertIn("### a part, f32 on M3\n\n9 bytes of stack.\n", tables["parts"])
        self.assertIn("| knot | 3 | 75.00 % | 5 | 4 | 9 | 9 |\n| **all periods** | 4 | 100.00 % |", tables["parts"])
        self.assertIn("| opt level | 3 |\n", tables["toolchain"])

    def test_bounds(self):
        terms = {"base": 1000, "K": 10, "J": 100, "S": 1}
        of_kind = {unit: terms for unit in ("instructions", "cycles")}
        bound = {"name": "m3", "format": "f32", "K": 5, "J": 1, "S": 2, "worst_of_the_part": 400, "worst_found": 576,
                 "plan": of_kind, "last": of_kind, "landing": of_kind}
        table = bounds_table.table({"target": [bound]}, {"m3": "M3, f32 FPU"})
        self.assertIn("| at most, K = 5, J = 1, S = 2 | M3, f32 |\n", table)
        self.assertIn("| a landing step", table.replace("instructions of ", ""))
        self.assertIn("| instructions of a period of the plan | 1,152 |\n", table)
        self.assertIn("| the bound, over the worst that was found | 2.00 |\n", table)

    def test_cores(self):
        core = {key: 2000 for key in (*core_table.CELLS, *core_table.CYCLES)} | {"format": "I4F28", "mhz": 80.0}
        table = core_table.table([core, core | {"format": "I3F15", "mhz": 100.0}])
        self.assertIn("| ECP5, speed grade 6 | I4F28 | I3F15 |\n", table)
        self.assertIn("| least period with a queue of four, cycles | 2,000 | 2,000 |\n| … in µs | 25.00 | 20.00 |\n", table)


if __name__ == "__main__":
    unittest.main()
