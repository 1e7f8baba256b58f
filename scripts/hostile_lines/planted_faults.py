"""Faults that are planted, each of which watched_run.py must see: a check that cannot fail shows nothing."""

import signal
import tempfile
from pathlib import Path

from .watched_run import MARK, Case, run

# By name: what a shell does in the program's place, more of the case, and a word of the fault; None where there is none.
PLANTED = {
    "nothing wrong": ("exit 0", {}, None),
    "a panic": ("exit 101", {}, "status 101"),
    "a signal": ("kill -SEGV $$", {}, "signal SIGSEGV"),
    "a text before a refusal": ("echo hi; echo 'part.nc bad' >&2; exit 2", {"named": ("part.nc",)}, "before a refusal"),
    "no place": ("echo bad >&2; exit 2", {"named": ("part.nc",)}, "names none"),
    "a place by its line": ("echo 'x part.nc:3:1 bad' >&2; exit 2", {"named": ("key",)}, None),
    "no word": ("exit 2", {}, "without a word"),
    "a long message": ("head -c 3000 /dev/zero | tr '\\0' x >&2; exit 2", {}, "a message of"),
    "a changed input": ("echo y > part.nc", {}, "was changed"),
    "an input that is gone": ("rm part.nc", {}, "is gone"),
    "a file more": ("echo y > other", {}, "is left behind"),
    "an unfinished output": ("echo y > .feedbits-abcdef.part", {"outputs": (".feedbits-abcdef.part",)}, "is left behind"),
    "a temporary file": ("echo y > $TMPDIR/x", {}, "temporary"),
    "half of JSON": ("printf '{' > o.json", {"outputs": ("o.json",)}, "JSONDecodeError"),
    "no number in JSON": ("echo '[NaN]' > o.json", {"outputs": ("o.json",)}, "NaN in JSON"),
    "JSON": ("echo '[1]' > o.json", {"outputs": ("o.json",)}, None),
    "rows of CSV": ("printf 'a,b\\n1\\n' > o.csv", {"outputs": ("o.csv",)}, "different lengths"),
    "a formula": (f"printf 'a,b\\n=1+{MARK},2\\n' > o.csv", {"outputs": ("o.csv",)}, "could not convert"),
    "a negative number": ("printf 'a,b\\n-1e-3,2\\n' > o.csv", {"outputs": ("o.csv",)}, None),
    "a name as C": (f"printf '/* x */ int {MARK}(void){{return 1;}} /* */\\n' > o.c", {"outputs": ("o.c",)}, "as code"),
    "a name in a comment of C": (f"printf '/* {MARK} */ int a;\\n' > o.c", {"outputs": ("o.c",)}, None),
    "a name as VHDL": (f"printf -- '-- a\\n{MARK};\\n' > o.vhd", {"outputs": ("o.vhd",)}, "as code"),
    "a script": ("echo '<svg><script>1</script></svg>' > o.svg", {"outputs": ("o.svg",)}, "script"),
    "half of a stream": ("head -c 200 /dev/zero > o.stream", {"outputs": ("o.stream",)}, "another length"),
    "an output of a refusal": ("echo '[1]' > o.json; echo part.nc >&2; exit 2", {"outputs": ("o.json",)}, "the command refused"),
    "memory": ("exec python3 -c 'x = bytearray(70 << 20)'", {}, "MB of memory"),
    "the processor's time": ("while :; do :; done", {"slow": 0.05}, "processor"),
    "no end": ("exec sleep 100", {"slow": 0.05}, "no end"),
    "an end by a signal": ("exec sleep 100", {"signal": signal.SIGTERM}, None),
    "a signal that does nothing": ("trap '' TERM; sleep 3", {"signal": signal.SIGTERM}, "went on"),
    "an end before the signal": ("exit 0", {"signal": signal.SIGTERM}, "before the signal"),
}


def unseen(name):
    """What is wrong with the check of a planted fault; None if nothing is."""
    script, more, word = PLANTED[name]
    more = dict(more)
    slow = more.pop("slow", 1)
    with tempfile.TemporaryDirectory(prefix="hostile-") as folder:
        tool = Path(folder) / "tool"
        tool.write_text(f"#!/bin/sh\n{script}\n")
        tool.chmod(0o755)
        end = run(Case("planted", name, ["plan"], {"part.nc": b"x"}, **more), str(tool), Path(folder) / "case", slow)
    seen = any(word in fault for fault in end.faults) if word else not end.faults
    return None if seen else f"{name}: expected {word or 'no fault'}, found {end}"
