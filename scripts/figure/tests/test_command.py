"""`scripts/figures` on a small repository with a command of its own."""

import contextlib
import io
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from figure import command

PAGE = """# A page

```console
$ feedbits compare
…
{bits} bits are enough
…
$ feedbits check
```

```sh
feedbits is not run here
```
"""
PROGRAM = """#!/bin/sh
case "$1" in
compare) printf 'a part\\n\\n25 bits are enough\\nand more\\n' ;;
check) exit {status} ;;
esac
"""


class Figures(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        (self.root / "docs").mkdir()
        (self.root / "data").mkdir()
        self.page, self.binary = self.root / "docs/page.md", self.root / "feedbits"
        self.program(0)

    def program(self, status):
        self.binary.write_text(PROGRAM.format(status=status))
        self.binary.chmod(0o755)

    def run_command(self, *words):
        """The exit status, and what is printed."""
        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
            status = command.main([*words, "--binary", str(self.binary)], "about", self.root)
        return status, out.getvalue()

    def test_a_changed_digit_is_found_and_mended(self):
        self.page.write_text(PAGE.format(bits=24))
        status, said = self.run_command("--check", "console-blocks")
        self.assertEqual(status, 1)
        self.assertIn("--- docs/page.md\n", said)
        self.assertIn("-24 bits are enough\n+25 bits are enough\n", said)
        self.assertEqual(self.page.read_text(), PAGE.format(bits=24), "--check changes no file")
        status, said = self.run_command("console-blocks")
        self.assertEqual((status, self.page.read_text()), (0, PAGE.format(bits=25)))
        self.assertIn("wrote docs/page.md", said)
        status, said = self.run_command("--check", "console-blocks")
        self.assertEqual(status, 0, said)

    def test_a_block_that_cannot_be_renewed_is_named_and_stays(self):
        page = PAGE.format(bits=24) + "\n```console\n$ feedbits compare\n…\nfilament: 0.1 mm\n```\n"
        self.page.write_text(page)
        for words in (["--check", "console-blocks"], ["console-blocks"]):
            status, said = self.run_command(*words)
            self.assertEqual(status, 1)
            self.assertIn("docs/page.md: $ feedbits compare: nothing like this line", said)
            self.assertIn("filament: 0.1 mm", said)
        self.assertEqual(self.page.read_text(), page.replace("24 bits", "25 bits"), "the others are renewed")

    def test_a_command_that_fails_is_a_fault(self):
        self.page.write_text(PAGE.format(bits=25))
        self.program(2)
        status, said = self.run_command("--check", "console-blocks")
        self.assertEqual(status, 1)
        self.assertIn("docs/page.md: $ feedbits check: ends with status 2", said)

    def test_other_scripts_are_called_with_what_they_take(self):
        for words, expected in [
            (["--check", "instructions", "--require"], "scripts/instructions --require"),
            (["instructions"], "scripts/instructions --write"),
            (["--check", "reliability", "--require"], "scripts/reliability --check"),
        ]:
            with mock.patch("subprocess.run") as run:
                run.return_value.returncode = 0
                self.assertEqual(self.run_command(*words)[0], 0)
                run.return_value.returncode = 1
                self.assertEqual(self.run_command(*words)[0], 1)
            self.assertEqual([" ".join(call.args[0]) for call in run.call_args_list], [expected] * 2)

    def test_times_are_not_checked(self):
        with mock.patch("subprocess.run") as run:
            status, said = self.run_command("--check", "benchmarks", "growth")
        self.assertEqual((status, run.called), (0, False), said)


if __name__ == "__main__":
    unittest.main()
