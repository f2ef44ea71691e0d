#!/usr/bin/env python3
"""Boots the firmware's image in QEMU and talks to it as a desktop would: tests/firmware/emulate.py IMAGE

Checked: it starts without a clock tree, GPIO, bus or watchdog and answers; disarmed it never drives a motor; the button,
which reads as pressed from the start, arms nothing; armed by the link it drives, and after a stop it does not; lock-step
ticks of 64 noisy sensors are answered; after them settings and path are the board's own again; the deepest stack, all this included, is within its budget. Prints the figures.
"""

import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "examples"))
import link  # noqa: E402

STACK = 1536  # bytes
TICKS = 300
# Timer 1's compare registers, written when a motor's effort changes.
DUTY = re.compile(r"timer\S*: unimplemented device write \(size 4, offset 0x0*(?:34|38), value 0x0*([0-9a-f]+)\)", re.I)


def expect(true, what):
    if not true:
        raise SystemExit(f"emulate.py: {what}")


class Wire(link.Link):
    def tell(self, message):
        """Says what is not answered."""
        self.sequence = (self.sequence + 1) % 256
        os.write(self.fd, link.frame(self.sequence, link.encode("ToTarget", message)))


class Emulator:
    """QEMU with the image in it, its second serial port on a socket."""

    def __init__(self, image, folder, *more):
        qemu = os.environ.get("QEMU") or shutil.which("qemu-system-arm")
        expect(qemu, "qemu-system-arm is missing (Debian: apt-get install qemu-system-arm)")
        self.path, self.writes = f"{folder}/link.sock", f"{folder}/writes.log"
        self.process = subprocess.Popen(
            [qemu, "-M", "netduinoplus2", "-display", "none", "-monitor", "none",
             "-semihosting-config", "enable=on,target=native",
             "-serial", "null", "-chardev", f"socket,id=link,path={self.path},server=on,wait=off",
             "-serial", "chardev:link", "-kernel", image, "-d", "unimp,guest_errors", "-D", self.writes, *more],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)

    def connect(self):
        until = time.monotonic() + 5
        while True:
            try:
                return Wire(link.open_port(f"unix:{self.path}", 0))
            except OSError:
                expect(time.monotonic() < until and self.process.poll() is None, "QEMU does not listen")
                time.sleep(0.02)

    def duties(self):
        """What has been written to the motors' PWM so far."""
        return [int(found, 16) for found in DUTY.findall(pathlib.Path(self.writes).read_text(errors="replace"))]


def state(wire):
    answer = wire.ask({"Status": {}})
    return answer, next(iter(answer["cause"]))


def drive(emulator, wire):
    """By its own clock: a stop, an arming, another stop."""
    wire.hello()
    time.sleep(0.5)
    duties = emulator.duties()
    expect(duties and not any(duties), f"disarmed, and the motors' PWM was set to {duties}")
    wire.ask({"Begin": {"x": 0, "y": 0, "heading": 0}})
    wire.ask({"Arm": {"token": wire.token}})
    time.sleep(0.5)
    expect(any(emulator.duties()), "armed, and no motor was driven")
    expect(state(wire)[0]["armed"], "armed, and it is no longer")
    wire.ask({"Stop": {}})
    time.sleep(0.1)
    before = len(emulator.duties())
    time.sleep(0.5)
    duties = emulator.duties()[before:]
    expect(not any(duties), f"stopped, and the motors' PWM was set to {duties}")


def lockstep(wire):
    """Ticks with all the sensors that there is room for; ticks a second."""
    wire.ask({"Hello": {"nonce": 1, "role": {"Lockstep": {}}}})
    wire.ask({"Set": {"id": 256, "value": 64}})
    for sensor in range(64):
        heading = (sensor << 26) - (1 << 31)
        wire.ask({"Set": {"id": 257 + 4 * sensor + 2, "value": heading}})
    wire.ask({"Set": {"id": 30, "value": 1}})
    wire.ask({"Begin": {"x": 0, "y": 0, "heading": 0}})
    wire.ask({"Arm": {"token": wire.token}})
    chance = random.Random(1)
    started = time.monotonic()
    for tick in range(TICKS):
        scan = tick % 256
        # Round obstacles, noisy: runs to fit circles to.
        for first in range(0, 64, 8):
            readings = []
            for _ in range(8):
                near = 0.5 + 0.02 * chance.random() + 0.3 * (first // 24)
                echo = {"Echo": {"range": link.q16(near), "age": 0}}
                readings.append(echo if chance.random() < 0.9 else {"Clear": {"age": 0}})
            wire.tell({"Ranges": {"scan": scan, "first": first, "readings": readings}})
        counts = {"Known": {"left": 40 * tick, "right": 41 * tick}}
        inputs = {"Inputs": {"tick": tick, "time_us": 1000 + 20_000 * tick, "scan": scan, "counts": counts}}
        answer = wire.ask(inputs, parts=3)
        expect(isinstance(answer, bytes), f"tick {tick} was answered by {answer}")
        record = link.unpack_record(answer)
        expect(record["tick"] == tick and record["valid_ranges"] == 64, f"tick {tick} came back as {record}")
    return TICKS / (time.monotonic() - started)


def own_again(wire, before):
    """A plant's settings and path end with it: what is driven is what was there when the board was switched on."""
    wire.hello()
    after = settings(wire)
    expect(after == before, f"after lock-step the settings are {after}, at the start they were {before}")
    wire.ask({"Begin": {"x": 0, "y": 0, "heading": 0}})
    wire.ask({"Arm": {"token": wire.token}})
    time.sleep(0.3)
    expect(state(wire)[0]["armed"], "after lock-step the board's own path is not driven")
    record = link.unpack_record(wire.ask({"Record": {}}, parts=3))
    expect(abs(record["remaining"] - link.q16(1)) < link.q16(0.01), f"its own path is a metre long; driven is {record}")
    wire.ask({"Stop": {}})


def settings(wire):
    """All that the link tells, by id."""
    mounts = range(257, 257 + 4 * wire.ask({"Get": {"id": 256}})["value"])
    ids = (*range(1, 4), *range(10, 15), *range(20, 23), *range(30, 37), *range(40, 53), *range(60, 66), *range(70, 77), 80, 81, 256)
    return {number: wire.ask({"Get": {"id": number}})["value"] for number in (*ids, *mounts)}


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        started = time.monotonic()
        emulator = Emulator(sys.argv[1], folder)
        try:
            wire = emulator.connect()
            answer, cause = state(wire)
            boot = time.monotonic() - started
            expect((answer["armed"], cause) == (False, "Boot"), f"at its start it is {answer}")
            drive(emulator, wire)
            before = settings(wire)
            rate = lockstep(wire)
            own_again(wire, before)
            stack = state(wire)[0]["stack"]
        finally:
            emulator.process.kill()
            emulator.process.wait()
    print(f"answers {boot:.2f} s after the start; {rate:.0f} lock-step ticks/s of 64 sensors; deepest stack {stack} bytes")
    expect(0 < stack <= STACK, f"a stack of {stack} bytes is deeper than the budget of {STACK}")


if __name__ == "__main__":
    main()
