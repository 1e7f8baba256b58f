"""Programs: how they are got, and run."""

import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


def name():
    """The script, as people call it."""
    return f"scripts/{pathlib.Path(sys.argv[0]).name}"


def fail(text):
    sys.exit(f"{name()}: {text}")


def run(words, **more):
    """What a command prints on both streams; its fault is the script's."""
    ended = subprocess.run(words, capture_output=True, text=True, check=False, **more)
    if ended.returncode != 0:
        fail(f"{' '.join(map(str, words))}: {ended.stdout[-800:]}{ended.stderr[-800:]}")
    return ended.stdout + ended.stderr


def is_skipped(missing, flags):
    """Says that something is missing; with `--require` that ends the script."""
    if "--require" in flags:
        fail(f"{missing} is missing")
    print(f"{name()}: skipped: {missing} is missing")


def has(programs, flags):
    """Whether these programs are there, which are Debian packages of the same names; `--install` gets them."""
    for program in programs:
        if "--install" in flags and not shutil.which(program):
            subprocess.run([ROOT / "scripts" / "apt-install", "--no-install-recommends", program], check=False)
        if not shutil.which(program):
            is_skipped(f"{program} (Debian: {program})", flags)
            return False
    return True


def of_python_index(package, program, flags):
    """A program of a package of the Python index, in an environment of its own, which stays for the next time; none if it cannot be had."""
    folder = pathlib.Path(tempfile.gettempdir()) / f"feedbits-{package}"
    path, mark = folder / "bin" / program, folder / "installed"
    if not mark.exists():
        steps = [[sys.executable, "-m", "venv", folder], [folder / "bin" / "pip", "install", "--quiet", package]]
        if any(subprocess.run(step, check=False).returncode for step in steps):
            is_skipped(f"{package} (of the Python index)", flags)
            return None
        mark.touch()
    return path
