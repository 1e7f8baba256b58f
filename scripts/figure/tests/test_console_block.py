"""What stands below a command, renewed by what it prints now."""

import unittest

from figure.aligned import Unaligned
from figure.console_block import command_of, renewed


class Renewed(unittest.TestCase):
    def renews(self, shown, printed, expected):
        self.assertEqual(renewed(shown, printed), expected)
        # What is right stays.
        self.assertEqual(renewed(expected, printed), expected)

    def test_a_changed_digit(self):
        self.renews("25 bits are enough\n", "24 bits are enough\n", "24 bits are enough\n")

    def test_lines_that_are_left_out_stay_out(self):
        shown = "…\n25 bits are enough: I2F23, 1.4 times better.\n…\nI8F24  2.2e-7\n"
        printed = "about the part\n\n24 bits are enough: I2F22, 1.1 times better.\n\nformat fluctuation\nI16F16 5.1e-5\nI8F24  2.3e-7\n"
        self.renews(shown, printed, "…\n24 bits are enough: I2F22, 1.1 times better.\n…\nI8F24  2.3e-7\n")

    def test_the_line_that_is_like_it_takes_its_place(self):
        shown = "…\nI4F28  32  9.2e-9  108×  good\n…\n"
        printed = "I8F24  32  2.2e-7  4.6×  good\nI4F28  32  8.8e-9  114×  good\nI3F29  32  7.9e-9  126×  good\n"
        self.renews(shown, printed, "…\nI4F28  32  8.8e-9  114×  good\n…\n")

    def test_words_that_are_left_out_stay_out(self):
        shown = "…\nI16F48 … 1.4e-7 …\n"
        printed = "format  bits\nI32F32  64  raw  1.5e-6  bad\nI16F48  64  raw  1.3e-7  good\n"
        self.renews(shown, printed, "…\nI16F48 … 1.3e-7 …\n")

    def test_a_part_of_a_word_stays_out(self):
        self.renews("1621 periods; checksum\n0x…\n", "1620 periods; checksum\n0x00ff\n", "1620 periods; checksum\n0x…\n")

    def test_blanks_beside_what_is_left_out_do_not_count(self):
        self.renews("I16F48 … 1.4e-7 …\n", "I16F48    64   1.4e-7   good\n", "I16F48 … 1.4e-7 …\n")

    def test_a_table_is_as_it_is_printed(self):
        shown = "format  cycles\nI8F24      986\n"
        self.renews(shown, "format  cycles\nI8F24     1001\n", "format  cycles\nI8F24     1001\n")
        # Blanks and rules count: no column is out of its place.
        self.renews(shown, "│ format │ cycles │\n│ I8F24  │ 986    │\n", "│ format │ cycles │\n│ I8F24  │ 986    │\n")

    def test_new_lines_and_lines_that_are_gone(self):
        shown = "format  cycles\nI8F24      986\nf64        123\n"
        self.renews(shown, "format  cycles\nI8F24      986\nf32         99\nf64        123\n",
                    "format  cycles\nI8F24      986\nf32         99\nf64        123\n")
        self.renews(shown, "format  cycles\nf64        123\n", "format  cycles\nf64        123\n")

    def test_what_follows_the_last_line_is_shown_too(self):
        self.renews("one line\n", "one line\nand a remark\n", "one line\nand a remark\n")

    def test_a_person_decides_where_a_shown_line_is_gone(self):
        with self.assertRaises(Unaligned) as gone:
            renewed("…\nfilament  0.1 mm\n…\n", "a part\nanother answer altogether\n")
        self.assertIn("filament", str(gone.exception))
        with self.assertRaises(Unaligned):
            renewed("I16F48 … good …\n", "I16F48 64 bad 3\n")

    def test_commands(self):
        self.assertEqual(command_of("$ feedbits plan --out 'a b'"), ["plan", "--out", "a b"])
        self.assertEqual(command_of("$ cargo run --release -- size"), ["size"])
        self.assertEqual(command_of("$ cargo run --release"), [])
        self.assertIsNone(command_of("$ scripts/no-panic"))
        self.assertIsNone(command_of("$ feedbits-other"))


if __name__ == "__main__":
    unittest.main()
