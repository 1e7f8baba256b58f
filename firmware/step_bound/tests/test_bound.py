"""Bounds of functions in assembly whose longest path is counted by hand. Needs arm-none-eabi-as and -ld, and glpsol."""

import contextlib
import subprocess
import tempfile
import unittest
from pathlib import Path

from .. import Refused, flow, program
from ..cost import Cycles, Instructions
from ..facts import Fact
from ..image import Image, cut_name
from ..instruction import parse
from ..cost import class_of


@contextlib.contextmanager
def assembled(source, core="cortex-m3"):
    """The image of a source."""
    head = f".syntax unified\n.thumb\n.cpu {core}\n.text\n"
    names = [line.split(":")[0] for line in source.splitlines() if line[:1].isalpha() and ":" in line]
    types = "".join(f".type {name}, %function\n" for name in names)
    with tempfile.TemporaryDirectory() as folder:
        text, item, image = (Path(folder, name) for name in ("step.s", "step.o", "step.elf"))
        text.write_text(head + types + source)
        subprocess.run(["arm-none-eabi-as", "-g", "-o", item, text], check=True)
        subprocess.run(["arm-none-eabi-ld", "-e", "0x1000", "-Ttext", "0x1000", "-o", image, item], check=True)
        yield Image(image)


def bound(source, facts=(), cost=None, core="cortex-m3", **constants):
    """The bound of `step` in a source."""
    with assembled(source, core) as image:
        entry = image.address_of("step")
        functions = flow.reach(image, entry)
        return program.solve(program.build(image, entry, list(facts), constants, functions), cost or Instructions())


def turns(function, most="", in_period=""):
    return Fact("loop", [function], "a test", most=most, in_period=in_period)


LOOP = """
step:
    movs r1, #4
.Lturn:
    subs r1, #1
    bne .Lturn
    bx lr
"""


class Paths(unittest.TestCase):
    def test_the_longer_of_two_ways_counts(self):
        way = "step:\n cmp r0, #0\n beq .Lshort\n nop\n nop\n nop\n.Lshort:\n bx lr\n"
        self.assertEqual(bound(way).value, 6)

    def test_a_loop_turns_as_often_as_its_fact_says(self):
        # One instruction before, two each time of five, one behind.
        self.assertEqual(bound(LOOP, [turns("step", "4")]).value, 1 + 5 * 2 + 1)
        self.assertEqual(bound(LOOP, [turns("step", "N - 1")], N=9).value, 1 + 9 * 2 + 1)

    def test_a_loop_without_a_fact_is_refused_by_name(self):
        with self.assertRaisesRegex(Refused, "a loop without a bound: step .*step.s:.*0x1002"):
            bound(LOOP)

    def test_an_inner_loop_turns_anew_each_time(self):
        nested = """
step:
    movs r1, #3
.Louter:
    movs r2, #2
.Linner:
    subs r2, #1
    bne .Linner
    bl inner
    subs r1, #1
    bne .Louter
    bx lr
inner:
    subs r2, #1
    bne inner
    bx lr
"""
        facts = [turns("step", "2"), turns("inner", "6")]
        # Outer three times: 1 and 2, inner three times 2, the call of 7 times 2 and 1.
        self.assertEqual(bound(nested, facts).value, 1 + 3 * (1 + 3 * 2 + 1 + (7 * 2 + 1) + 2) + 1)

    def test_turns_in_a_period_are_shared_by_all_calls(self):
        twice = "step:\n push {lr}\n bl part\n bl part\n pop {pc}\npart:\n subs r1, #1\n bne part\n bx lr\n"
        found = bound(twice, [turns("part", in_period="J")], J=10)
        # Two calls pass the loop twice; ten turns more are left for both.
        self.assertEqual(found.value, 4 + 2 * (2 + 1) + 10 * 2)
        self.assertEqual([(round(factor), of) for factor, of in found.parts], [(2, "J")])
        self.assertEqual(round(found.base), 10)

    def test_calls_that_are_counted_bound_a_loop_that_makes_them(self):
        loop = "step:\n push {lr}\n.Lturn:\n bl evaluate\n bne .Lturn\n pop {pc}\nevaluate:\n nop\n bx lr\n"
        found = bound(loop, [Fact("sum", ["evaluate"], "a test", in_period="K")], K=5)
        self.assertEqual(found.value, 1 + 5 * (2 + 2) + 1)

    def test_a_loop_entered_in_the_middle_is_counted_where_all_rounds_meet(self):
        middle = """
step:
    cmp r0, #0
    beq .Llower
.Lupper:
    nop
.Llower:
    nop
    subs r1, #1
    beq .Lend
    nop
    b .Lupper
.Lend:
    bx lr
"""
        # At most three passes of the lower half: 2 before, then nop first, or not; each round 6.
        self.assertEqual(bound(middle, [turns("step", "2")]).value, 2 + 1 + 3 * 3 + 2 * 3 + 1)

    def test_a_tail_call_returns_to_the_caller_of_its_caller(self):
        tail = "step:\n push {lr}\n bl first\n pop {pc}\nfirst:\n nop\n b second\nsecond:\n nop\n nop\n bx lr\n"
        self.assertEqual(bound(tail).value, 3 + 2 + 3)

    def test_an_if_then_block_may_return(self):
        block = "step:\n push {r4, lr}\n cmp r0, #0\n it eq\n popeq {r4, pc}\n nop\n nop\n pop {r4, pc}\n"
        self.assertEqual(bound(block).value, 7)

    def test_a_far_jump_by_a_call_is_a_jump(self):
        far = "step:\n push {r4, lr}\n bl .Lfar\n nop\n nop\n nop\n.Lfar:\n pop {r4, pc}\n"
        self.assertEqual(bound(far, core="cortex-m0plus").value, 3)


class Tables(unittest.TestCase):
    CASES = ".Lzero:\n bx lr\n.Lone:\n nop\n bx lr\n.Ltwo:\n nop\n nop\n nop\n bx lr\n"

    def test_a_table_of_bytes_or_halves(self):
        for name, datum, operand in (("tbb", ".byte", "[pc, r0]"), ("tbh", ".short", "[pc, r0, lsl #1]")):
            rows = "".join(f" {datum} (.L{case} - .Ltable) / 2\n" for case in ("zero", "one", "two"))
            source = f"step:\n {name} {operand}\n.Ltable:\n{rows} .balign 2\n{self.CASES}"
            self.assertEqual(bound(source).value, 1 + 4, name)

    def test_a_table_of_the_smallest_cores(self):
        rows = "".join(f" .short (.L{case} - .Lpc) / 2\n" for case in ("zero", "one", "two"))
        source = f"step:\n lsls r0, r0, #1\n nop\n add r0, pc\n ldrh r0, [r0, #4]\n lsls r0, r0, #1\n add pc, r0\n.Ltable:\n.set .Lpc, . + 2\n{rows} .balign 2\n"
        self.assertEqual(bound(source + self.CASES, core="cortex-m0plus").value, 6 + 4)


class Refusals(unittest.TestCase):
    def test_an_indirect_call(self):
        with self.assertRaisesRegex(Refused, "indirect call: step, 0x1002: blx r3"):
            bound("step:\n push {lr}\n blx r3\n pop {pc}\n")

    def test_an_indirect_jump(self):
        with self.assertRaisesRegex(Refused, "indirect jump: step, 0x1000: bx r3"):
            bound("step:\n bx r3\n")

    def test_recursion(self):
        with self.assertRaisesRegex(Refused, "recursion: down > up > down"):
            bound("step:\n push {lr}\n bl down\n pop {pc}\ndown:\n push {lr}\n bl up\n pop {pc}\nup:\n push {lr}\n bl down\n pop {pc}\n")


class Costs(unittest.TestCase):
    def test_the_most_of_the_manual_counts(self):
        # SMULL 5, CMP 1, a branch taken 1 + 3, BX 4 on the M3.
        source = "step:\n smull r0, r1, r2, r3\n cmp r0, #0\n beq .Lend\n.Lend:\n bx lr\n"
        self.assertEqual(bound(source, cost=Cycles("cortex-m3")).value, 5 + 1 + 4 + 4)

    def test_the_smallest_core_may_have_a_slow_multiplier(self):
        source = "step:\n muls r0, r1, r0\n bx lr\n"
        for fast, cycles in ((True, 1), (False, 32)):
            cost = Cycles("cortex-m0plus", fast_multiplier=fast)
            self.assertEqual(bound(source, cost=cost, core="cortex-m0plus").value, cycles + 2)

    def test_classes_are_those_of_the_tables(self):
        for mnemonic, operands, found in (
            ("pop.w", "{r4, r8}", "load_multiple"),
            ("pop", "{r4, pc}", "load_return"),
            ("vmla.f32", "s0, s1, s2", "float_multiply_add"),
            ("umlal", "r0, r1, r2, r3", "multiply_long_add"),
            ("blt.n", "10 <step>", "branch_conditional"),
            ("bic.w", "r0, r1, r2", "alu"),
            ("tbb", "[pc, r0]", "jump_register"),
        ):
            self.assertEqual(class_of(parse(0, 2, mnemonic, operands, False)), found, mnemonic)


class Names(unittest.TestCase):
    def test_a_name_is_cut_to_function_and_numbers(self):
        self.assertEqual(cut_name("<a::B<f32, 2>>::cross::<3, true>"), ("cross", ("2", "3", "true")))
        self.assertEqual(cut_name("cross<real::FixedPoint<fixed::FixedI32<u::UInt<u::UTerm, u::B1>>>, 2, 9, false>"), ("cross", ("2", "9", "false")))
        self.assertEqual(cut_name("__aeabi_lmul"), ("__aeabi_lmul", ()))


if __name__ == "__main__":
    unittest.main()
