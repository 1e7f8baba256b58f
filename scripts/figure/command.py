"""The command `scripts/figures`."""

import argparse
import concurrent.futures
import json
import os
import shlex
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

from . import bounds_table, console_block, core_table, formats_table, marked, target_tables
from .pages import Pages

# A picture of the book, and the figure of a report that it is. The formats are those on the way to the answer of `feedbits size`.
PICTURES = {
    "bits.svg": "compare --evaluate pieces --formats I2F10,I2F12,I2F14,I2F16,I2F18,I2F20,I2F22,I2F24,I2F26,I2F28,I2F30,f32,I2F34,I2F38",
}

# Tests that compare with a file of expected figures.
EXPECTED = [
    "cargo test --quiet --package feedbits --test command_line terminal",
    "cargo test --quiet --package feedbits-tests --test across_crates constants",
    "cargo test --quiet --package secant-interp --test interpolation checksums",
]


@dataclass(frozen=True)
class Script:
    """Figures that other commands make and check."""

    write: list
    check: list  # none for times, which no other run has again
    is_quick: bool = False
    installs: bool = False  # whether they take --install and --require
    writing: dict = field(default_factory=dict)  # what the environment has where they write


# In the order in which they are made: some read what others have written.
SCRIPTS = {
    "reliability": Script(["scripts/reliability"], ["scripts/reliability --check"], is_quick=True),
    "expected": Script(EXPECTED, EXPECTED, writing={"UPDATE_EXPECT": "1"}),
    "instructions": Script(["scripts/instructions --write"], ["scripts/instructions"], installs=True),
    "target-costs": Script(["scripts/firmware"], ["scripts/firmware --check"], installs=True),
    "step-bounds": Script(["scripts/step-bound"], ["scripts/step-bound --check"], installs=True),
    "core-synthesis": Script(["scripts/core-synthesis"], ["scripts/core-synthesis --check"], installs=True),
    "c-counts": Script(["scripts/c-code --count --write"], ["scripts/c-code --count"], installs=True),
    "growth": Script(["scripts/growth --write"], []),
    "benchmarks": Script(["scripts/benchmarks"], []),
}


def tables(pages, binary):
    """The tables between markers."""
    read = lambda name: tomllib.loads(pages.text(f"data/{name}.toml"))
    costs = read("target-costs")
    compared = run(binary, "compare --json", pages.root)
    made = {
        "formats": formats_table.table(json.loads(compared)),
        "core-synthesis": core_table.table(read("core-synthesis")["core"]),
        "step-bounds": bounds_table.table(read("step-bounds"), target_tables.titles(costs)),
        **target_tables.tables(costs),
    }
    places = []
    for page in documents(pages.root):
        places += marked.names(pages.text(page))
        pages.put(page, marked.filled(pages.text(page), made))
    for name in made:
        if places.count(name) != 1:
            pages.faults.append(f"the table {name} has {places.count(name)} places in the pages, not one")


def console_blocks(pages, binary):
    """The console blocks of all pages, those of a page one after the other."""
    # The longest pages first, for one of them may take as long as all others.
    order = sorted(documents(pages.root), key=lambda page: pages.text(page).count("smooth"), reverse=True)
    renew = lambda page: console_block.renewed_page(page, pages.text(page), pages.root, binary)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for page, (text, faults, _) in zip(order, pool.map(renew, order)):
            pages.put(page, text)
            pages.faults += faults


def pictures(pages, binary):
    for name, command in PICTURES.items():
        with tempfile.TemporaryDirectory() as folder:
            run(binary, f"{command} --report report", folder)
            pages.put(f"docs/pictures/{name}", (Path(folder) / "report" / name).read_text(encoding="utf-8"))


RENDERED = {"tables": tables, "console-blocks": console_blocks, "pictures": pictures}


def documents(root):
    """The pages, by their paths."""
    files = [*root.glob("*.md"), *root.glob("crates/*/README.md"), *root.glob("docs/*.md")]
    return sorted(file.relative_to(root).as_posix() for file in files)


def run(binary, command, folder):
    status, printed = console_block.run(binary, shlex.split(command), folder)
    if status not in (0, 1):
        sys.exit(f"scripts/figures: feedbits {command} ends with status {status}:\n{printed}")
    return printed


def built(root):
    return Path(subprocess.check_output([root / "scripts/built-command"], text=True).strip())


def arguments(words, about):
    parser = argparse.ArgumentParser("scripts/figures", description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--binary", type=lambda name: Path(name).resolve())
    parser.add_argument("--install", action="store_true")
    parser.add_argument("--require", action="store_true")
    parser.add_argument("names", nargs="*", choices=[*SCRIPTS, *RENDERED, []], metavar="NAME")
    return parser.parse_args(words)


def main(words, about, root):
    """Makes or checks the figures that are named; returns the exit status."""
    given = arguments(words, about)
    is_wanted = lambda name: name in given.names or (not given.names and (given.all or name in RENDERED or SCRIPTS[name].is_quick))
    failed = [name for name, script in SCRIPTS.items() if is_wanted(name) and not done(name, script, given, root)]
    if failed:
        words = "not as they should be" if given.check else "not written, or not all of them"
        print(f"scripts/figures: {words}: {', '.join(failed)}", file=sys.stderr)
    rendered = [name for name in RENDERED if is_wanted(name)]
    is_good = not rendered or render(rendered, given, root)
    return 0 if is_good and not failed else 1


def done(name, script, given, root):
    """Whether other commands have written their figures, or found them as they should be."""
    commands = script.check if given.check else script.write
    if not commands:
        print(f"scripts/figures: {name} are times, which are not checked")
    options = [f"--{option}" for option in ("install", "require") if script.installs and getattr(given, option)]
    environment = os.environ | ({} if given.check else script.writing)
    statuses = []
    for command in commands:
        print("==", command, *options, flush=True)
        statuses.append(subprocess.run([*command.split(), *options], cwd=root, env=environment, check=False).returncode)
    return not any(statuses)


def render(names, given, root):
    """Whether the files of these figures are as they should be; without --check they are, after a person has looked at the faults."""
    # Built at last: what scripts have written is compiled in.
    pages, binary = Pages(root), given.binary or built(root)
    for name in names:
        RENDERED[name](pages, binary)
    changed = pages.changed()
    print("".join(f"scripts/figures: {fault}\n" for fault in pages.faults), end="", file=sys.stderr)
    if not given.check:
        pages.write()
        print("".join(f"scripts/figures: wrote {path}\n" for path in changed), end="")
    elif changed:
        print(pages.differences(), end="")
        print(f"scripts/figures: not as they should be: {', '.join(changed)}; `scripts/figures` writes them anew", file=sys.stderr)
    if not changed and not pages.faults:
        print(f"scripts/figures: {', '.join(names)}: nothing differs")
    return not pages.faults and not (given.check and changed)
