"""The ports of the core, tried by cocotb. scripts/core-ports says which part and which queue.

Inputs change at falling edges of the clock, and outputs are read there: so nothing hangs on the order of events at a rising one.
"""

import csv
import os
import pathlib
import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge

PARTS = pathlib.Path(os.environ["FEEDBITS_PARTS"])
QUEUE = int(os.environ["FEEDBITS_QUEUE"])
LEAST_PERIOD = int(os.environ["FEEDBITS_LEAST_PERIOD"])
# No setpoint takes as many cycles, and no section's queue as many to fill.
MOST_CYCLES = 10_000


def vectors(part):
    """For each section its setpoints, as the words of the stream: piece, phase, offsets, length, evaluations."""
    sections = {}
    with (PARTS / part / "vectors" / "periods.csv").open() as file:
        for row in csv.DictReader(file):
            word = lambda name: int(row[name], 16)
            words = [int(row["piece"]), word("phase"), word("offset_x"), word("offset_y"), word("length"), int(row["evaluations"])]
            sections.setdefault(int(row["section"]), []).append(words)
    # At the end of a section the vectors name the piece behind it, the core the last one.
    for setpoints in sections.values():
        setpoints[-1][0] -= 1
    return [sections[number] for number in sorted(sections)]


PART, MIRRORED = vectors("part"), vectors("mirrored")


def image(part):
    return [int(word, 16) for word in (PARTS / part / "part.hex").read_text().split()]


class Core:
    """The core and its clock."""

    def __init__(self, dut):
        self.dut = dut

    async def begin(self):
        """Every test begins with the part's own tables and a reset."""
        dut = self.dut
        for port in (dut.start, dut.tick, dut.table_write, dut.setpoint_tready, dut.section, dut.table_address, dut.table_data):
            port.value = 0
        Clock(dut.clk, 10, unit="ns").start()
        await self.write(image("part"))
        await self.reset()
        return self

    async def cycle(self):
        await FallingEdge(self.dut.clk)

    async def reset(self):
        self.dut.reset.value = 1
        for _ in range(4):
            await self.cycle()
        assert not self.is_valid() and not self.is_high("error"), "a reset leaves neither a setpoint nor an error"
        self.dut.reset.value = 0

    def is_high(self, port):
        return getattr(self.dut, port).value == 1

    def is_valid(self):
        return self.is_high("setpoint_tvalid")

    async def until(self, port):
        for _ in range(MOST_CYCLES):
            if self.is_high(port):
                return
            await self.cycle()
        raise AssertionError(f"{port} does not come")

    async def start(self, section):
        await self.until("idle")
        self.dut.start.value, self.dut.section.value = 1, section
        await self.cycle()
        self.dut.start.value = 0
        assert not self.is_high("idle"), "a core that has begun is not idle"

    def shown(self):
        """The words of the stream at the output, which are those of the ports of their own."""
        data = self.dut.setpoint_tdata.value.to_unsigned()
        words = []
        for bits in (32, 64, 32, 32, 32, 8):
            words.append(data & ((1 << bits) - 1))
            data >>= bits
        assert data == 0, "no other word is in the stream"
        ports = ("piece", "phase", "offset_x", "offset_y", "length", "evaluations")
        assert words == [getattr(self.dut, port).value.to_unsigned() for port in ports]
        return words

    async def take(self, with_tick=False):
        """The setpoint that is shown is taken."""
        words = self.shown()
        self.dut.setpoint_tready.value, self.dut.tick.value = 1, int(with_tick)
        await self.cycle()
        self.dut.setpoint_tready.value, self.dut.tick.value = 0, 0
        return words

    async def expect(self, setpoints):
        """Setpoints are taken as soon as they are shown, and are these."""
        for period, expected in enumerate(setpoints):
            await self.until("setpoint_tvalid")
            found = await self.take()
            assert found == expected, f"period {period}: {found}, expected {expected}"

    async def write(self, words):
        """Writes the table memory."""
        self.dut.table_write.value = 1
        for address, word in enumerate(words):
            self.dut.table_address.value, self.dut.table_data.value = address, word
            await self.cycle()
        self.dut.table_write.value = 0

    async def tick(self):
        self.dut.tick.value = 1
        await self.cycle()
        self.dut.tick.value = 0


async def begun(dut):
    return await Core(dut).begin()


@cocotb.test()
async def sections_run_as_in_rust(dut):
    core = await begun(dut)
    for section, setpoints in enumerate(PART):
        await core.start(section)
        await core.expect(setpoints)
        await core.until("idle")
    for _ in range(200):
        assert not core.is_valid(), "nothing is shown behind the last section"
        await core.cycle()


@cocotb.test()
async def a_stream_waits_for_whoever_takes_it(dut):
    """What is shown stays, whatever `setpoint_tready` does, and no setpoint is lost or comes twice."""
    core = await begun(dut)
    draw = random.Random(72)
    await core.start(1)
    for expected in PART[1]:
        await core.until("setpoint_tvalid")
        for _ in range(draw.choice([0, 0, 1, 3, 400])):
            assert core.is_valid() and core.shown() == expected
            await core.cycle()
        assert await core.take() == expected
    await core.until("idle")


@cocotb.test()
async def so_many_setpoints_wait_as_the_queue_holds(dut):
    """Nothing is taken until the core has stopped; then all that wait are taken one a cycle."""
    core = await begun(dut)
    await core.start(0)
    for _ in range(QUEUE * 1500):
        await core.cycle()
    for expected in PART[0][:QUEUE]:
        assert core.is_valid() and await core.take() == expected
    assert not core.is_valid(), "no more wait than the queue holds"
    await core.expect(PART[0][QUEUE:])


@cocotb.test()
async def a_reset_ends_any_run(dut):
    """At several moments of a run, of which some are within a step and some find a full queue."""
    core = await begun(dut)
    for taken, cycles in ((0, 3), (0, 500), (5, 1), (7, 23), (20, 2000)):
        await core.start(2)
        await core.expect(PART[2][:taken])
        for _ in range(cycles):
            await core.cycle()
        await core.reset()
    await core.start(0)
    await core.expect(PART[0])
    await core.until("idle")


@cocotb.test()
async def ticks_of_the_least_period_find_every_setpoint(dut):
    core = await begun(dut)
    for section, setpoints in enumerate(PART):
        await core.start(section)
        await core.until("setpoint_tvalid")
        for expected in setpoints:
            assert core.is_valid() and await core.take(with_tick=True) == expected
            for _ in range(LEAST_PERIOD - 1):
                await core.cycle()
        assert not core.is_high("error")
        # At rest ticks go on.
        for _ in range(3):
            await core.tick()
        assert not core.is_high("error"), "a tick at rest is no error"


@cocotb.test()
async def a_tick_that_comes_too_early_is_an_error(dut):
    """It stays until the next start, and changes no setpoint."""
    core = await begun(dut)
    await core.start(0)
    await core.tick()
    assert not core.is_high("error"), "the queue fills: the machine is at rest"
    await core.expect(PART[0][:QUEUE])
    # The core has not made the next one yet.
    taken = QUEUE
    while core.is_valid():
        assert await core.take() == PART[0][taken]
        taken += 1
    assert not core.is_high("error")
    await core.tick()
    assert core.is_high("error")
    await core.expect(PART[0][taken:])
    await core.until("idle")
    assert core.is_high("error"), "an error stays until the next start"
    await core.start(1)
    assert not core.is_high("error"), "a start ends an error"
    await core.expect(PART[1])


@cocotb.test()
async def tables_are_written_between_sections(dut):
    """One core runs a section of a part, then one of its mirror image, then the part again."""
    core = await begun(dut)
    assert PART[1] != MIRRORED[1]
    for tables, section, setpoints in (("part", 0, PART), ("mirrored", 1, MIRRORED), ("part", 2, PART)):
        await core.until("idle")
        await core.write(image(tables))
        await core.start(section)
        await core.expect(setpoints[section])
