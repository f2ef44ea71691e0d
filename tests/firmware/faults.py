#!/usr/bin/env python3
"""Breaks the firmware's image in QEMU while it drives: tests/firmware/faults.py IMAGE

By QEMU's debugger port the processor is sent where there is no program, or held where it should go on; QEMU's log of writes
to what it does not model tells what became of the motors and the watchdog. Checked:

* a trap, and the crystal's failure (NMI), switch off the outputs of timer 1, then the direction and standby pins, before the
  reset, and nothing switches them on again; after it the robot is disarmed and tells why;
* the watchdog is started, with the time that docs/wiring.md names, and fed by completed control periods only: with PendSV
  held, while SysTick goes on, it gets nothing;
* timer 1's flag of the emergency stop's break input is looked at in every step.

Each of these was seen to fail: without `motors_off` in `crash::end`, without `start_watchdog`, with `feed` in SysTick, and with
`Break::tripped` always false. QEMU has no watchdog that would reset and no pin that could be pressed: what follows then is
not seen here (tests/firmware.rs holds what the machine does).
"""

import pathlib
import re
import select
import socket
import sys
import tempfile
import time

from emulate import Emulator, expect, state

# Where there is no program, and nothing may be executed.
NOWHERE = 0xE0000000
# Interrupt control and state register; its bit that sets off an NMI.
ICSR, NMI = 0xE000ED04, 1 << 31
# `str r1, [r0]`, a branch to itself, and RAM between the statics and the stack for them.
STORE, LOOP, FREE = b"\x01\x60", b"\xfe\xe7", 0x2000_2800
PENDSV, PC = 14, 15

# Direction and standby pins on port A and B (docs/wiring.md), and timer 1's main output.
PINS_A, PINS_B, MAIN_OUTPUT = 1 << 10, 1 << 2 | 1 << 13 | 1 << 14 | 1 << 15, 1 << 15
LINE = re.compile(r"(\S+): unimplemented device (read|write)\s+\(size \d, offset 0x([0-9a-f]+)(?:, value 0x([0-9a-f]+))?\)", re.I)
# The emulated chip has two names for this place.
WATCHDOGS = ("IWDG", "I2S2ext")
START, UNLOCK, FEED = 0xCCCC, 0x5555, 0xAAAA


class Debugger:
    """QEMU's debugger port, by gdb's remote protocol. The processor stands as soon as it is connected."""

    def __init__(self, path):
        self.wire = socket.socket(socket.AF_UNIX)
        self.wire.settimeout(10)
        self.wire.connect(path)
        self.rest = b""
        self.ask("?")
        # That it stands now may be told once more.
        time.sleep(0.1)
        if select.select([self.wire], [], [], 0)[0]:
            self.rest += self.wire.recv(4096)
        self.wire.sendall(b"+" * self.rest.count(b"#"))
        self.rest = b""
        # Without having told which registers there are, it sets none.
        self.ask("qXfer:features:read:target.xml:0,ffb")

    def send(self, text):
        self.wire.sendall(b"$%s#%02x" % (text.encode(), sum(text.encode()) % 256))

    def answer(self):
        while not (found := re.search(rb"\$([^#]*)#..", self.rest)):
            heard = self.wire.recv(4096)
            expect(heard, "the debugger's port was closed")
            self.rest += heard
        self.rest = self.rest[found.end():]
        self.wire.sendall(b"+")
        return found.group(1).decode()

    def ask(self, text):
        self.send(text)
        return self.answer()

    def do(self, text):
        answer = self.ask(text)
        expect(answer == "OK", f"the debugger answers {text} by {answer}")

    def word(self, at):
        return int.from_bytes(bytes.fromhex(self.ask(f"m{at:x},4")), "little")

    def write(self, at, data):
        self.do(f"M{at:x},{len(data):x}:{data.hex()}")

    def set(self, register, value):
        self.do(f"P{register:x}={value.to_bytes(4, 'little').hex()}")

    def go_to(self, place):
        self.set(PC, place)

    def store(self, at, value):
        """Lets the processor store a word: its own registers the debugger cannot write to."""
        self.write(FREE, STORE + LOOP)
        self.set(0, at)
        self.set(1, value)
        self.go_to(FREE)

    def run(self):
        """Lets it go on."""
        self.send("c")

    def run_to(self, place):
        """Lets it go on until it is there, and stands."""
        self.do(f"Z0,{place:x},2")
        stopped = self.ask("c")
        expect(stopped.startswith(("T05", "S05")), f"the debugger says {stopped}")
        self.do(f"z0,{place:x},2")


class Board:
    """A robot that drives, and what it reads and writes."""

    def __init__(self, image, folder):
        self.debugger = f"{folder}/debugger.sock"
        self.emulator = Emulator(image, folder, "-gdb", f"unix:{self.debugger},server=on,wait=off")
        try:
            self.wire = self.emulator.connect()
            self.wire.hello()
            self.wire.ask({"Begin": {"x": 0, "y": 0, "heading": 0}})
            self.wire.ask({"Arm": {"token": self.wire.token}})
            time.sleep(0.3)
            expect(state(self.wire)[0]["armed"], "it does not drive")
        except BaseException:
            self.__exit__()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.emulator.process.kill()
        self.emulator.process.wait()

    def log(self):
        """What was read and written so far: device, what, offset, value."""
        text = pathlib.Path(self.emulator.writes).read_text(errors="replace")
        return [(device, what, int(offset, 16), int(value or "0", 16)) for device, what, offset, value in LINE.findall(text)]

    def writes(self, devices, offset):
        return [value for device, what, at, value in self.log() if device in devices and (what, at) == ("write", offset)]


def drives(log):
    """Whether what is written may make a motor turn, or stops one."""
    lets = stops = 0
    for device, what, offset, value in log:
        if what != "write":
            continue
        if (device, offset) == ("timer[1]", 0x44):
            lets, stops = lets + bool(value & MAIN_OUTPUT), stops | (0 if value & MAIN_OUTPUT else 1)
        for port, pins, bit in (("GPIOA", PINS_A, 2), ("GPIOB", PINS_B, 4)):
            if (device, offset) == (port, 0x18):
                lets, stops = lets + bool(value & pins), stops | (bit if value >> 16 & pins == pins else 0)
    return lets, stops


def crash(image, what, breaks):
    with tempfile.TemporaryDirectory() as folder, Board(image, folder) as board:
        debugger = Debugger(board.debugger)
        before = len(board.log())
        expect(drives(board.log())[0] > 10, "it drives, and no output is switched on")
        breaks(debugger)
        debugger.run()
        until = time.monotonic() + 5
        # The next start begins with the oscillator.
        while not (starts := [i for i, line in enumerate(board.log()) if i >= before and line[:3] == ("RCC", "read", 0)]):
            expect(time.monotonic() < until, f"{what}: it was not reset")
            time.sleep(0.05)
        lets, stops = drives(board.log()[before:starts[0]])
        expect(stops == 7, f"{what}: of outputs, pins of port A and pins of port B only {stops:03b} were switched off before the reset")
        last = board.log()[before:starts[0]][-8:]
        expect(drives(last) == (0, 7), f"{what}: the last before the reset was {last}")
        answer, cause = state(board.wire)
        expect((answer["armed"], cause) == (False, "HardFault"), f"{what}: afterwards it is {answer}")


def watchdog(image):
    with tempfile.TemporaryDirectory() as folder, Board(image, folder) as board:
        keys = board.writes(WATCHDOGS, 0)
        expect(keys[:2] == [START, UNLOCK], f"the watchdog is started by {keys[:4]}")
        expect(set(keys[2:]) == {FEED}, "the watchdog is told something else than to go on")
        # 32 kHz by 4 · 2^3, 200 of these.
        expect((board.writes(WATCHDOGS, 4), board.writes(WATCHDOGS, 8)) == ([3], [200]), "the watchdog waits for something else than 200 ms")
        log = board.log()
        looks = log.count(("timer[1]", "read", 0x10, 0))
        lamps = sum(line[:3] == ("GPIOC", "write", 0x18) for line in log)
        expect(lamps > 20 and looks >= lamps - 1, f"in {lamps} steps the break input's flag was looked at {looks} times")

        debugger = Debugger(board.debugger)
        debugger.run_to(debugger.word(0x0800_0000 + 4 * PENDSV) & ~1)
        debugger.write(FREE, LOOP)
        debugger.go_to(FREE)
        fed = board.writes(WATCHDOGS, 0).count(FEED)
        expect(fed > 10, f"while it drives, the watchdog is fed {fed} times")
        debugger.run()
        time.sleep(1)
        late = board.writes(WATCHDOGS, 0).count(FEED) - fed
        expect(late == 0, f"no control period is completed, and the watchdog is fed {late} times")
        return fed, looks


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    image = sys.argv[1]
    crash(image, "a trap", lambda debugger: debugger.go_to(NOWHERE))
    crash(image, "an NMI", lambda debugger: debugger.store(ICSR, NMI))
    fed, looks = watchdog(image)
    print(f"motors off before the reset, twice; watchdog fed {fed} times, and never without a period; break input looked at {looks} times")


if __name__ == "__main__":
    main()
