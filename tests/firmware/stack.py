#!/usr/bin/env python3
"""The deepest that the firmware's stack can be, worked out from its image: tests/firmware/stack.py IMAGE

Every function is followed instruction by instruction from its start along all branches; what is pushed and taken is added
up along every call. On the deepest place of `main` lies the frame of PendSV with all that it calls, on that the frame of
one of the short interrupts: they have one priority (src/main/board.rs) and do not interrupt each other. What `main` calls
before it lets interrupts come has none above it. Left out is the handler of a processor trap, after which nothing goes on.

Recursion, floating point (its frames are larger), a stack pointer that is set by other means, and indirect calls other than
those listed here are errors. Prints the way to the deepest place; fails above the bar.
"""

import bisect
import pathlib
import re
import struct
import sys

BAR = 1536  # bytes
# What the processor puts there when an exception comes, without floating point.
FRAME = 32
MAIN, TICK = "Reset", "PendSV"
SHORT = ("SysTick", "USART2", "EXTI9_5", "EXTI15_10")
# Called by `main` while no interrupt is let through.
BEFORE = "fuzzypilot::board::start"
# Who calls by a pointer, and what it then is: settings are read and written through a trait's object.
INDIRECT = {"Machine<L,R,S,E>::receive": "fuzzypilot::link::settings::Raw>::"}
# The vector table's entries that are looked at: 16 of the core, then the chip's.
VECTORS = {1: "Reset", 14: "PendSV", 15: "SysTick", 16 + 23: "EXTI9_5", 16 + 38: "USART2", 16 + 40: "EXTI15_10"}


def fail(what):
    sys.exit(f"stack.py: {what}")


def demangled(name):
    """A legacy Rust symbol as it is written in the source, as far as it matters here."""
    if not name.startswith("_ZN"):
        return name
    parts, at = [], 3
    while name[at] != "E":
        digits = re.match(r"\d+", name[at:]).group()
        at += len(digits)
        parts.append(name[at:at + int(digits)])
        at += int(digits)
    text = "::".join(parts[:-1])
    for code, char in (("$LT$", "<"), ("$GT$", ">"), ("$u20$", " "), ("$RF$", "&"), ("$C$", ","), ("$LP$", "("),
                       ("$RP$", ")"), ("$u7b$", "{"), ("$u7d$", "}"), ("..", "::")):
        text = text.replace(code, char)
    return text.replace("_<", "<")


class Image:
    """A 32-bit little-endian ELF file."""

    def __init__(self, path):
        data = pathlib.Path(path).read_bytes()
        if data[:6] != b"\x7fELF\x01\x01":
            fail(f"{path}: not a 32-bit little-endian ELF file")
        (table,) = struct.unpack_from("<I", data, 32)
        size, count = struct.unpack_from("<HH", data, 46)
        sections = [struct.unpack_from("<10I", data, table + i * size) for i in range(count)]
        self.blocks, self.names = [], {}
        for _, kind, flags, address, offset, length, link, _, _, entry in sections:
            if kind == 1 and flags & 2:
                self.blocks.append((address, data[offset:offset + length]))
            if kind != 2:
                continue
            strings = sections[link][4]
            for at in range(offset, offset + length, entry):
                name, value, long, info, _, section = struct.unpack_from("<IIIBBH", data, at)
                if section != 0 and info & 15 == 2:
                    end = data.index(b"\0", strings + name)
                    text = demangled(data[strings + name:end].decode(errors="replace"))
                    self.names.setdefault(value & ~1, (text, long))
        self.starts = sorted(self.names)
        self.vectors = min(address for address, _ in self.blocks)

    def half(self, at):
        for address, block in self.blocks:
            if address <= at < address + len(block):
                return struct.unpack_from("<H", block, at - address)[0]
        fail(f"{at:#x} is no place in the image")

    def byte(self, at):
        return self.half(at & ~1) >> 8 * (at & 1) & 255

    def word(self, at):
        return self.half(at) | self.half(at + 2) << 16

    def name(self, at):
        return self.names.get(at, (f"{at:#x}", 0))[0]

    def function(self, at):
        """Where the function begins that this place is in."""
        return self.starts[bisect.bisect(self.starts, at) - 1]


def signed(value, bits):
    return value - (1 << bits) if value >> bits - 1 else value


def spread(code):
    """A modified immediate constant."""
    low = code & 255
    if code >> 10 == 0:
        return (low, low << 16 | low, low << 24 | low << 8, low * 0x01010101)[code >> 8]
    turn = code >> 7
    return (low | 128) << 32 - turn


def branch(first, second, at):
    """Where a 32-bit branch goes, in its long form."""
    sign = first >> 10 & 1
    one, two = (~(second >> bit ^ sign) & 1 for bit in (13, 11))
    offset = sign << 24 | one << 23 | two << 22 | (first & 0x3FF) << 12 | (second & 0x7FF) << 1
    return at + 4 + signed(offset, 25)


class Step:
    """One instruction, as far as stack and way are concerned."""

    def __init__(self, image, at):
        first = image.half(at)
        wide = first >> 11 in (0b11101, 0b11110, 0b11111)
        self.next = at + (4 if wide else 2)
        self.taken = 0  # bytes; negative gives back
        self.to, self.call, self.ends, self.indirect, self.holds = [], None, False, False, 0
        if wide:
            self.wide(image, at, first, image.half(at + 2))
        else:
            self.narrow(at, first)

    def narrow(self, at, code):
        if code >> 8 == 0xB0:
            self.taken = (code & 127) * (4 if code & 128 else -4)
        elif code >> 9 == 0b1011010:
            self.taken = 4 * (code & 511).bit_count()
        elif code >> 9 == 0b1011110:
            self.taken, self.ends = -4 * (code & 511).bit_count(), bool(code & 256)
        elif code == 0xD4D4:
            # What the linker fills gaps with.
            self.ends = True
        elif code >> 12 == 0b1101:
            if code >> 8 & 15 == 14:
                self.ends = True
            elif code >> 8 & 15 < 14:
                self.to = [at + 4 + 2 * signed(code & 255, 8)]
        elif code >> 11 == 0b11100:
            self.to, self.ends = [at + 4 + 2 * signed(code & 0x7FF, 11)], True
        elif code & 0xF500 == 0xB100:
            self.to = [at + 4 + 2 * (code >> 3 & 31 | code >> 4 & 32)]
        elif code >> 7 == 0b010001110:
            if code >> 3 & 15 != 14:
                fail(f"{at:#x}: a jump by a register")
            self.ends = True
        elif code >> 7 == 0b010001111:
            self.indirect = True
        elif code >> 8 == 0xBF and code & 15:
            # The mask's lowest one says how many of the next are bound to a condition.
            self.holds = 4 - ((code & 15) & -(code & 15)).bit_length() + 1
        elif code >> 8 in (0x44, 0x46) and (code & 7 | code >> 4 & 8) == 13:
            fail(f"{at:#x}: the stack pointer is set from a register")
        elif code >> 8 in (0x44, 0x46) and (code & 7 | code >> 4 & 8) == 15:
            fail(f"{at:#x}: a jump by a register")

    def wide(self, image, at, first, second):
        constant = first << 1 & 0x800 | second >> 4 & 0x700 | second & 255
        target = second >> 8 & 15
        if first >> 8 in (0xEC, 0xED, 0xEE) and second >> 8 & 14 == 10:
            fail(f"{at:#x}: floating point")
        if first == 0xE92D:
            self.taken = 4 * second.bit_count()
        elif first == 0xE8BD:
            self.taken, self.ends = -4 * second.bit_count(), bool(second & 0x8000)
        elif first == 0xF84D and second >> 8 & 15 == 0b1101:
            self.taken = second & 255
        elif first == 0xF85D and second >> 8 & 15 == 0b1011:
            self.taken, self.ends = -(second & 255), second >> 12 == 15
        elif first == 0xE96D:
            self.taken = 4 * (second & 255)
        elif first == 0xE8FD:
            self.taken = -4 * (second & 255)
        elif first & 0xFBEF == 0xF1AD and target == 13:
            self.taken = spread(constant)
        elif first & 0xFBEF == 0xF10D and target == 13:
            self.taken = -spread(constant)
        elif first & 0xFBFF == 0xF2AD and target == 13:
            self.taken = constant
        elif first & 0xFBFF == 0xF20D and target == 13:
            self.taken = -constant
        elif first & 0xFFF0 == 0xE8D0 and second & 0xFFE0 == 0xF000:
            self.table(image, at, wide=bool(second & 16))
        elif first >> 11 == 0b11110 and second & 0xD000 == 0xD000:
            self.call = branch(first, second, at)
        elif first >> 11 == 0b11110 and second & 0xD000 == 0x9000:
            self.to, self.ends = [branch(first, second, at)], True
        elif first >> 11 == 0b11110 and second & 0xD000 == 0x8000:
            if first >> 7 & 7 != 7:
                offset = (first >> 10 & 1) << 20 | (second >> 11 & 1) << 19 | (second >> 13 & 1) << 18
                offset |= (first & 63) << 12 | (second & 0x7FF) << 1
                self.to = [at + 4 + signed(offset, 21)]
            elif first & 0xFFF0 == 0xF7F0 and second >> 12 == 0xA:
                self.ends = True
        elif first in (0xF85F, 0xF8DF) and second >> 12 == 15 or first & 0xFFF0 in (0xF850, 0xF8D0) and second >> 12 == 15:
            fail(f"{at:#x}: a jump by a word in memory")
        elif first >> 8 in (0xEA, 0xEB, 0xF0, 0xF1, 0xF2, 0xF4, 0xF5, 0xF6) and target == 13 and not second & 0x8000:
            fail(f"{at:#x}: the stack pointer is set by arithmetic")

    def table(self, image, at, wide):
        """The ways out of a table branch: it ends where the first of them begins."""
        base, place = at + 4, at + 4
        while not self.to or place < min(self.to):
            self.to.append(base + 2 * (image.half(place) if wide else image.byte(place)))
            place += 2 if wide else 1
        self.ends = True


class Depths:
    """How deep functions are, with all that they call."""

    def __init__(self, image):
        self.image, self.known, self.open = image, {}, []

    def walk(self, start):
        """The deepest place within a function, and its calls with the depth at each."""
        deepest, calls, seen, todo = 0, {}, {}, [(start, 0, 0)]
        while todo:
            at, depth, held = todo.pop()
            if seen.get((at, held), -1) >= depth:
                continue
            seen[at, held] = depth
            step = Step(self.image, at)
            after = depth + step.taken
            deepest = max(deepest, depth, after)
            called = [step.call] if step.call is not None else []
            if step.indirect:
                called = self.pointed(start, at)
            inside = []
            for to in step.to:
                # A jump out of the function is a call that does not come back.
                (inside if self.image.function(to) == self.image.function(start) else called).append(to)
            for to in called:
                calls[to] = max(calls.get(to, 0), depth)
            todo += [(to, depth, 0) for to in inside]
            if held:
                # Bound to a condition: what it gives back may not be given back, and an end may be none.
                todo.append((step.next, max(depth, after), held - 1))
            elif not step.ends and self.image.function(step.next) == self.image.function(start):
                # Else the call was of what does not come back.
                if after < 0:
                    fail(f"{at:#x}: more is given back than was taken")
                todo.append((step.next, after, step.holds))
        return deepest, calls

    def pointed(self, start, at):
        name = self.image.name(start)
        for caller, called in INDIRECT.items():
            if caller in name:
                found = [place for place, (name, _) in self.image.names.items() if called in name]
                if found:
                    return found
        fail(f"{at:#x}: an indirect call in {name}, and nobody says of what")

    def of(self, start, without=None):
        """Bytes, and the way there: (function, bytes of its own on it)."""
        key = (start, without)
        if start in self.open:
            fail(f"recursion: {' → '.join(map(self.image.name, self.open[self.open.index(start):]))}")
        if key not in self.known:
            self.open.append(start)
            own, calls = self.walk(start)
            best = (own, [(self.image.name(start), own)])
            for to, depth in calls.items():
                if without and self.image.name(to) == without:
                    continue
                deep, way = self.of(to, without)
                if depth + deep > best[0]:
                    best = (depth + deep, [(self.image.name(start), depth), *way])
            self.open.pop()
            self.known[key] = best
        return self.known[key]


def worst(image):
    """The deepest place and the way there."""
    depths = Depths(image)
    handlers = {name: image.word(image.vectors + 4 * at) & ~1 for at, name in VECTORS.items()}
    for name, place in handlers.items():
        # The linker may have made one of the two that do the same.
        if name[:4] != image.name(place)[:4]:
            fail(f"the vector of {name} leads to {image.name(place)}")
    if not any(name == BEFORE for name, _ in image.names.values()):
        fail(f"there is no {BEFORE}")
    before = depths.of(handlers[MAIN])
    levels = [depths.of(handlers[MAIN], BEFORE), depths.of(handlers[TICK]), max(depths.of(handlers[name]) for name in SHORT)]
    total, way = 0, []
    for deep, names in levels:
        if way:
            # The processor aligns by 8 before it puts its frame there.
            aligned = (total + 7) // 8 * 8
            way.append(("(an exception's frame)", FRAME + aligned - total))
            total = aligned + FRAME
        total += deep
        way += names
    return max(before, (total, way), key=lambda found: found[0])


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    total, way = worst(Image(sys.argv[1]))
    for name, own in way:
        print(f"{own:6} {name}")
    print(f"{total:6} bytes of stack at the deepest that can be")
    if total > BAR:
        fail(f"a stack of {total} bytes is deeper than the bar of {BAR}")


if __name__ == "__main__":
    main()
