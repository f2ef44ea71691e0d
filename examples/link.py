#!/usr/bin/env python3
"""Talks to a robot that runs fuzzypilot, as docs/link.md describes it. Needs nothing but Python 3.

    link.py PORT COMMAND ...        PORT: /dev/ttyACM0, tcp:HOST:PORT or unix:PATH
    link.py --self-test             checks this script against tests/golden/link.jsonl

A serial port is opened at 460,800 baud, 8N1, the firmware's rate; --baud N before PORT sets another.

Commands, one after another in one session:
    status                          how the robot is, and its encoders' counts; works without a session
    stop                            disarms; works without a session
    hello                           begins a session; disarms
    get ID, set ID VALUE            a setting by its number; VALUE is raw, or 1.5q16, 0.05q24, 20deg
    path "PIECE; PIECE; ..."        line X Y DEGREES LENGTH, or arc X Y RADIUS FROM SWEEP (metres, degrees)
    begin X Y DEGREES               places the robot there, at the start of its path
    arm                             off it goes
    record                          what the last tick decided

If one of them fails, the rest is left; but a robot that was armed here, or was to be stopped, is stopped.
"""

import argparse
import json
import os
import pathlib
import select
import socket
import struct
import sys
import time
import zlib

VERSION = 1
BAUD = 460800  # the firmware's
ANSWER_IN = 0.2  # seconds; then the same frame is sent again
TRIES = 10

# ---- messages: variants in the order of their tags, fields in their order ----

TYPES = {
    "ToTarget": {
        "Hello": {"nonce": "u32", "role": "Role"},
        "Status": {},
        "Get": {"id": "u16"},
        "Set": {"id": "u16", "value": "i32"},
        "Begin": {"x": "i32", "y": "i32", "heading": "i32"},
        "PathBegin": {"form": "PathForm", "count": "u16", "closed": "bool", "gaps": "bool"},
        "PathPoint": {"index": "u16", "x": "i32", "y": "i32", "heading": "i32"},
        "PathLine": {"index": "u16", "x": "i32", "y": "i32", "heading": "i32", "length": "i32"},
        "PathArc": {"index": "u16", "x": "i32", "y": "i32", "radius": "i32", "from": "i32", "sweep": "i32"},
        "PathEnd": {},
        "Arm": {"token": "u32"},
        "Stop": {},
        "Ranges": {"scan": "u8", "first": "u8", "readings": "Readings"},
        "Inputs": {"tick": "u32", "time_us": "u32", "scan": "u8", "counts": "Counts"},
        "Record": {},
    },
    "ToHost": {
        "Welcome": {
            "firmware": "version", "ranges": "u8", "segments": "u16", "points": "u16", "record_bytes": "u16",
            "token": "u32",
        },
        "State": {
            "armed": "bool", "cause": "Cause", "token": "u32", "uptime_ms": "u32", "tick": "u32", "good": "u32",
            "overlong": "u16", "truncated": "u16", "corrupt": "u16", "version": "u16", "stack": "u32", "left": "i32",
            "right": "i32",
        },
        "Value": {"id": "u16", "value": "i32"},
        "Ack": {},
        "Refused": {"why": "Why"},
        "RecordPart": {"part": "u8", "bytes": "bytes"},
    },
    "Role": {"Monitor": {}, "Lockstep": {}},
    "PathForm": {"Points": {}, "Segments": {}},
    "Counts": {"Known": {"left": "i32", "right": "i32"}, "Unknown": {"fault": "PortFault"}},
    "Reading": {
        "Echo": {"range": "i32", "age": "i32"},
        "Clear": {"age": "i32"},
        "Invalid": {"fault": "PortFault", "age": "i32"},
    },
    "PortFault": {"NeverSeen": {}, "Timeout": {}, "Bus": {}, "OutOfRange": {}, "Stale": {}},
    "Cause": {
        name: {} for name in (
            "Boot", "StopCommand", "Button", "Emergency", "LinkTimeout", "Sequence", "NewSession", "SettingsChanged",
            "DriveFault", "PathOver", "Overrun", "Brownout", "Watchdog", "Panic", "HardFault",
        )
    },
    "Why": {
        "Malformed": {}, "Version": {}, "NoSession": {}, "Replayed": {}, "Role": {}, "NotDisarmed": {}, "Token": {},
        "NotBegun": {}, "Emergency": {}, "DriveFault": {},
        "UnknownId": {"id": "u16"}, "Setting": {"id": "u16"},
        "NoPath": {}, "Path": {"error": "PathFault"},
        "OutOfSequence": {"expected": "u16"}, "TooMany": {"most": "u16"},
        "NoRecord": {}, "Foreign": {},
    },
    "PathFault": {"TooShort": {}, "TooMany": {}, "Degenerate": {"piece": "u16"}, "Gap": {"piece": "u16"}},
}


def varint(n):
    out = bytearray()
    while n > 127:
        out.append(n & 127 | 128)
        n >>= 7
    return bytes(out) + bytes([n])


def encode(kind, value):
    """The bytes of a value; a variant is {"Name": {field: value}}."""
    if kind in ("u8", "bool"):
        return bytes([value])
    if kind in ("u16", "u32"):
        return varint(value)
    if kind == "i32":
        return varint(value * 2 if value >= 0 else -value * 2 - 1)
    if kind == "version":
        return bytes(value)
    if kind == "bytes":
        return varint(len(value)) + bytes(value)
    if kind == "Readings":
        return encode("bytes", b"".join(encode("Reading", reading) for reading in value))
    ((name, fields),) = value.items()
    tag = list(TYPES[kind]).index(name)
    parts = (encode(of, fields[field]) for field, of in TYPES[kind][name].items())
    return varint(tag) + b"".join(parts)


def decode(kind, data, at=0):
    """A value and where it ends. Raises IndexError where bytes are missing."""
    if kind == "u8":
        return data[at], at + 1
    if kind == "bool":
        return bool(data[at]), at + 1
    if kind in ("u16", "u32", "i32"):
        n = shift = 0
        while True:
            n |= (data[at] & 127) << shift
            shift += 7
            at += 1
            if data[at - 1] < 128:
                break
        return (n >> 1 ^ -(n & 1) if kind == "i32" else n), at
    if kind == "version":
        return list(data[at:at + 3]), at + 3
    if kind in ("bytes", "Readings"):
        length, at = decode("u16", data, at)
        held = data[at:at + length]
        if kind == "bytes":
            return list(held), at + length
        readings, inside = [], 0
        while inside < length:
            reading, inside = decode("Reading", held, inside)
            readings.append(reading)
        return readings, at + length
    tag, at = decode("u16", data, at)
    name = list(TYPES[kind])[tag]
    fields = {}
    for field, of in TYPES[kind][name].items():
        fields[field], at = decode(of, data, at)
    return {name: fields}, at


# ---- frames ----


def frame(sequence, message):
    """A message as it goes over the wire."""
    raw = bytes([VERSION, sequence]) + message
    raw += struct.pack("<I", zlib.crc32(raw))
    return b"".join(bytes([len(block) + 1]) + block for block in raw.split(b"\0")) + b"\0"


def unframe(wire):
    """Sequence number and message of what stood before a terminator; None if it is no frame."""
    raw, at = bytearray(), 0
    while at < len(wire):
        end = at + wire[at]
        if at > 0:
            raw.append(0)
        raw += wire[at + 1:end]
        at = end
    if at != len(wire) or len(raw) < 6:
        return None
    content, (check,) = bytes(raw[:-4]), struct.unpack("<I", raw[-4:])
    if zlib.crc32(content) != check:
        return None
    if content[0] != VERSION:
        raise SystemExit(f"the robot speaks protocol version {content[0]}, this script {VERSION}")
    return content[1], content[2:]


# ---- records ----

RECORD = (
    "tick:I decision:B detail:B flags:B controller:B held.x:i held.y:i held.radius:i held.residual:i pose.x:i pose.y:i "
    "pose.heading:i foot.x:i foot.y:i cross_track:i distance:i tangent:i curvature:i heading_error:i progress:i "
    "remaining:i speed_limit:i laps:H obstacles:B valid_ranges:B nearest:i held.echoes:B rules:B speed_rules:B "
    "reserved:B distance_input:i angle_input:i speed_output:h deflection_output:h "
    + "".join(f"{of}{i}.row:B {of}{i}.col:B {of}{i}.degree:H " for of in ("rule", "speed_rule") for i in (1, 2, 3, 4))
    + "desired.linear:i desired.angular:i twist.linear:i twist.angular:i wheels.left:i wheels.right:i"
).split()


def unpack_record(data):
    names, kinds = zip(*(field.split(":") for field in RECORD))
    return dict(zip(names, struct.unpack("<" + "".join(kinds), data)))


# ---- ports ----


def open_port(port, baud):
    """A file descriptor that bytes go in and out of."""
    if port.startswith("tcp:"):
        host, number = port[4:].rsplit(":", 1)
        return socket.create_connection((host, int(number)), timeout=2).detach()
    if port.startswith("unix:"):
        wire = socket.socket(socket.AF_UNIX)
        wire.connect(port[5:])
        return wire.detach()
    import termios
    import tty

    rate = getattr(termios, f"B{baud}", None)
    if rate is None:
        raise SystemExit(f"--baud: {baud} is no rate of a serial port")
    fd = os.open(port, os.O_RDWR | os.O_NOCTTY)
    try:
        tty.setraw(fd)
        attributes = termios.tcgetattr(fd)
        attributes[4] = attributes[5] = rate
        termios.tcsetattr(fd, termios.TCSANOW, attributes)
    except termios.error:
        raise SystemExit(f"{port}: no serial port") from None
    return fd


class Link:
    """One conversation."""

    def __init__(self, fd):
        self.fd, self.sequence, self.rest, self.token, self.open = fd, 0, b"", None, False
        os.write(fd, b"\0")  # whatever the robot has heard so far ends here

    def answers(self, sequence, until):
        """Answers to the question with this number, as they come."""
        while True:
            while b"\0" in self.rest:
                wire, self.rest = self.rest.split(b"\0", 1)
                found = unframe(wire) if wire else None
                if found and found[0] == sequence:
                    yield decode("ToHost", found[1])[0]
            left = until - time.monotonic()
            if left <= 0 or not select.select([self.fd], [], [], left)[0]:
                return
            heard = os.read(self.fd, 4096)
            if not heard:
                raise SystemExit("the port was closed")
            self.rest += heard

    def ask(self, message, parts=1):
        """Asks until it is answered; the answer, or all parts of a record."""
        self.sequence = (self.sequence + 1) % 256
        wire = frame(self.sequence, encode("ToTarget", message))
        for _ in range(TRIES):
            os.write(self.fd, wire)
            got = {}
            for answer in self.answers(self.sequence, time.monotonic() + ANSWER_IN):
                ((name, fields),) = answer.items()
                if name == "Refused":
                    raise SystemExit(f"{next(iter(message))}: refused: {json.dumps(fields['why'])}")
                self.token = fields.get("token", self.token)
                if name != "RecordPart":
                    return fields
                got[fields["part"]] = bytes(fields["bytes"])
                if len(got) == parts:
                    return b"".join(got[part] for part in sorted(got))
        raise SystemExit(f"{next(iter(message))}: no answer in {TRIES * ANSWER_IN:.0f} s")

    def hello(self):
        nonce = int.from_bytes(os.urandom(4), "little")
        self.open = True
        return self.ask({"Hello": {"nonce": nonce, "role": {"Monitor": {}}}})

    def arm(self):
        if not self.open:
            self.hello()
        return self.ask({"Arm": {"token": self.token}})

    def within(self, message, parts=1):
        """Asks what needs a session."""
        if not self.open:
            self.hello()
        return self.ask(message, parts)


def q16(text):
    return round(float(text) * 65536)


def turns(text, bits=32):
    """Degrees as a part of a turn; half a turn and more wraps at 32 bits."""
    n = round(float(text) / 360 * (1 << bits))
    return (n + (1 << 31)) % (1 << 32) - (1 << 31) if bits == 32 else n


def raw(text):
    for suffix, of in (("q16", q16), ("q24", lambda t: round(float(t) * (1 << 24))), ("deg", turns)):
        if text.endswith(suffix):
            return of(text[:-len(suffix)])
    return int(text)


def path_pieces(text):
    """A path's pieces as messages, and that it begins."""
    pieces = [piece.split() for piece in text.split(";") if piece.strip()]
    messages = [{"PathBegin": {"form": {"Segments": {}}, "count": len(pieces), "closed": False, "gaps": False}}]
    for index, (kind, *n) in enumerate(pieces):
        if (kind, len(n)) not in (("line", 4), ("arc", 5)):
            raise ValueError(f"{kind} with {len(n)} numbers; line has 4, arc 5")
        place = {"index": index, "x": q16(n[0]), "y": q16(n[1])}
        if kind == "line":
            messages.append({"PathLine": {**place, "heading": turns(n[2]), "length": q16(n[3])}})
        else:
            messages.append({"PathArc": {**place, "radius": q16(n[2]), "from": turns(n[3]), "sweep": turns(n[4], 24)}})
    return messages


def send_path(link, messages):
    link.within(messages[0])
    for message in messages[1:]:
        link.ask(message)
    return link.ask({"PathEnd": {}})


# Commands, how each of their values is read, and what they then do.
COMMANDS = {
    "hello": ((), lambda link: link.hello()),
    "status": ((), lambda link: link.ask({"Status": {}})),
    "stop": ((), lambda link: link.ask({"Stop": {}})),
    "get": ((int,), lambda link, number: link.within({"Get": {"id": number}})),
    "set": ((int, raw), lambda link, number, value: link.within({"Set": {"id": number, "value": value}})),
    "path": ((path_pieces,), send_path),
    "begin": ((q16, q16, turns), lambda link, x, y, heading: link.within({"Begin": {"x": x, "y": y, "heading": heading}})),
    "arm": ((), lambda link: link.arm()),
    "record": ((), lambda link: unpack_record(link.within({"Record": {}}, parts=3))),
}


def commands(words):
    """Commands with their values; nothing is sent before all of them are understood."""
    words, found = list(words), []
    while words:
        name = words.pop(0)
        if name not in COMMANDS:
            raise SystemExit(f"{name}: no such command; see --help")
        readers = COMMANDS[name][0]
        if len(words) < len(readers):
            raise SystemExit(f"{name}: {len(readers)} values expected, {len(words)} found")
        try:
            found.append((name, [read(word) for read, word in zip(readers, words)]))
        except (ValueError, OverflowError) as error:
            raise SystemExit(f"{name}: {error}") from None
        del words[:len(readers)]
    return found


def run(link, todo):
    """Runs the commands and prints each one's answer as a line of JSON. If one fails, the robot is stopped all the same if
    it was armed here or was to be stopped."""
    armed = False
    for at, (name, values) in enumerate(todo):
        armed = armed or name == "arm"
        try:
            answer = COMMANDS[name][1](link, *values)
        except BaseException:
            if name != "stop" and (armed or any(later == "stop" for later, _ in todo[at + 1:])):
                print(json.dumps({"stop": link.ask({"Stop": {}})}), flush=True)
            raise
        if name == "stop":
            armed = False
        print(json.dumps({name: answer}), flush=True)


# ---- self-test ----


def self_test():
    golden = pathlib.Path(__file__).resolve().parent.parent / "tests" / "golden" / "link.jsonl"
    count = 0
    for line in golden.read_text().splitlines():
        sample = json.loads(line)
        kind = "ToTarget" if sample["from"] == "desktop" else "ToHost"
        message, wire = sample["message"], bytes.fromhex(sample["wire"])
        assert frame(sample["sequence"], encode(kind, message)) == wire, line
        sequence, data = unframe(wire[:-1])
        value, end = decode(kind, data)
        assert (sequence, value, end) == (sample["sequence"], message, len(data)), line
        for at in range(len(wire) - 1):
            changed = wire[:at] + bytes([wire[at] ^ 1]) + wire[at + 1:-1]
            assert 0 in changed or unframe(changed) is None, line
        count += 1
    assert count > 50, "too few golden frames"
    assert struct.calcsize("<" + "".join(field.split(":")[1] for field in RECORD)) == 156
    assert (turns("90"), turns("-180"), turns("360", 24)) == (1 << 30, -(1 << 31), 1 << 24)
    print(f"{count} golden frames as expected")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--self-test", action="store_true")
    parser.add_argument("--baud", type=int, default=BAUD, help=f"of a serial port; {BAUD} unless you changed the firmware's")
    parser.add_argument("port", nargs="?")
    parser.add_argument("commands", nargs=argparse.REMAINDER)
    arguments = parser.parse_args()
    if arguments.self_test:
        self_test()
    elif arguments.port and arguments.commands:
        todo = commands(arguments.commands)
        run(Link(open_port(arguments.port, arguments.baud)), todo)
    else:
        parser.error("a port and at least one command, or --self-test")


if __name__ == "__main__":
    try:
        main()
    except (OSError, ValueError, IndexError) as error:
        sys.exit(f"{type(error).__name__}: {error}")
