"""Facts about code that is never executed, about cases, and what a part says of a period. Needs arm-none-eabi-as and -ld."""

import random
import unittest
from pathlib import Path

from .. import Refused, facts, flow, program
from ..facts import Fact
from ..image import Frame
from ..part import PERIOD, Part, draw_stages
from ..program import Bound
from .test_bound import assembled

ROOT = Path(__file__).parents[3]
FOLLOW = Frame("follow", (), "crates/follow.rs", 10)
ABSENT = [Fact("absent", ["follow", "form<9>"], "a test")]


def inside(number, line):
    """The chain of an instruction in a form that is inlined into `follow`, the innermost first."""
    return [Frame("form", (number,), "crates/form.rs", line), FOLLOW]


# `follow` decides between two forms; in the second source the first form has been merged with the end of the other.
DECISION = """
step:
    cmp r0, #0
    beq {target}
    nop
    {end}
.Lnine:
    nop
    nop
.Lend:
    bx lr
"""


def kept(end, nine, last=(FOLLOW,)):
    """Addresses of the blocks that stay, with the chains of the block behind `.Lnine` and of the return."""
    with assembled(DECISION.format(target=".Lnine", end=end)) as image:
        function = flow.function_at(image, 0x1000)
        for instruction in function.instructions():
            image.frames[instruction.address] = [FOLLOW]
        image.frames[0x1004] = image.frames[0x1006] = inside("3", 5)
        image.frames[0x1008] = image.frames[0x100A] = nine
        image.frames[0x100C] = list(last)
        return facts.without_absent(image, function, ABSENT).blocks.keys()


class Absent(unittest.TestCase):
    def test_code_entered_by_a_decision_goes(self):
        self.assertEqual(kept("b .Lend", inside("9", 7)), {0x1000, 0x1004, 0x100C})

    def test_code_of_another_form_stays(self):
        self.assertEqual(kept("b .Lend", inside("3", 7)), {0x1000, 0x1004, 0x1008, 0x100C})

    def test_code_entered_from_another_form_is_merged_and_stays(self):
        nine = inside("9", 7)
        self.assertEqual(kept("b .Lnine", nine, nine), {0x1000, 0x1004, 0x1008})


class Cases(unittest.TestCase):
    def test_the_greatest_case_holds_for_all_values(self):
        flat, steep = Bound(120, {}, [(2, "K")], 100), Bound(150, {}, [(10, "K")], 100)
        self.assertIs(program.greatest([flat, steep]), steep)

    def test_cases_that_cross_are_refused(self):
        flat, steep = Bound(120, {}, [(2, "K")], 110), Bound(150, {}, [(10, "K")], 50)
        with self.assertRaisesRegex(Refused, "none is always the longer one"):
            program.greatest([flat, steep])


class Parts(unittest.TestCase):
    part = Part((ROOT / "tests/tests/constants/stairs_i4f28.rs").read_text())

    def test_a_part_says_what_a_period_may_take(self):
        self.assertEqual((self.part.format, self.part.evaluations, self.part.degree), ("I4F28", 5, 1))
        self.assertEqual((self.part.dimension, len(self.part.pieces), self.part.joints), (2, 3, 1))
        self.assertEqual(self.part.properties, {"corners", "other than plain cubics"})

    def test_hard_runs_are_further_sections(self):
        more = Part(self.part.with_hard_runs(7, 1))
        self.assertEqual(len(more.sections), len(self.part.sections) + 7)
        self.assertEqual(more.stages[: len(self.part.stages)], self.part.stages)
        self.assertEqual(more.sections[-1][-1], len(more.stages))
        self.assertIn("residual: i4f28(0)", more.text)

    def test_hard_stages_last_a_period_and_lead_over_the_way(self):
        stages = draw_stages(random.Random(3), 50.0, 2.5)
        self.assertTrue(all(duration >= PERIOD for duration, _ in stages))
        self.assertGreater(sum(duration / PERIOD * feed for duration, feed in stages), 50.0)


class Values(unittest.TestCase):
    def test_expressions_are_of_named_constants(self):
        self.assertEqual(facts.value("K * (J + 1)", {"K": 5, "J": 2}), 15)
        with self.assertRaises(ValueError):
            facts.value("open('x')", {})


if __name__ == "__main__":
    unittest.main()
