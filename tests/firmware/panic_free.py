#!/usr/bin/env python3
"""No image can panic: tests/firmware/panic_free.py [--c] IMAGE ...

Checked: no symbol of the images given is panic code; and the check would tell: a copy of the sources with one `unwrap` of
what is known at run time only does not link, and the linker says why. With --c the images are those of examples/c, and so
is what does not link; without, the firmware's.
"""

import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
# What the panic handler of a release image calls, and nobody has written.
HANDLER = "a_panic_is_left_in_the_release_image"
PANIC = re.compile(r"panic|unwrap_failed|expect_failed|slice_index_fail|rust_begin_unwind")
# File, line there, what comes behind it, and how the image is built.
FIRMWARE = (
    # Where a byte of the link is taken, in a function that runs all the time.
    "src/main/board.rs", "    fn due(&mut self) -> bool {\n", "        serial::RECEIVED.pop().unwrap();\n",
    [os.environ.get("CARGO", "cargo"), "fw"],
)
C = (
    # Where the readings for a tick have just been counted.
    "c-abi/src/tick.rs", "        let decided = state.robot.tick(&path, &mut ports);\n", "        seen.first().unwrap();\n",
    ["bash", "examples/c/build", "--no-run", "m4"],
)


def symbols(path):
    """The names of an ELF file's functions and data, 32 bits, little endian."""
    data = pathlib.Path(path).read_bytes()
    if data[:6] != b"\x7fELF\x01\x01":
        sys.exit(f"panic_free.py: {path}: not a 32-bit little-endian ELF file")
    (table,) = struct.unpack_from("<I", data, 32)
    size, count = struct.unpack_from("<HH", data, 46)
    sections = [struct.unpack_from("<10I", data, table + i * size) for i in range(count)]
    names = []
    for _, kind, _, _, offset, length, link, _, _, entry in sections:
        if kind != 2:
            continue
        strings = sections[link][4]
        for at in range(offset, offset + length, entry):
            name, _, _, info, _, section = struct.unpack_from("<IIIBBH", data, at)
            if section != 0 and info & 15 in (1, 2):
                end = data.index(b"\0", strings + name)
                names.append(data[strings + name:end].decode(errors="replace"))
    return names


def images(paths):
    for path in paths:
        found = symbols(path)
        if len(found) < 50:
            sys.exit(f"panic_free.py: {path}: {len(found)} symbols only; is it stripped?")
        left = [name for name in found if PANIC.search(name)]
        if left:
            sys.exit(f"panic_free.py: {path}: panic code is left: {', '.join(left)}")
        print(f"{pathlib.Path(path).name}: no panic among {len(found)} symbols")


def one_more(path, before, panic, build):
    """Adds a panic to a copy and builds it."""
    with tempfile.TemporaryDirectory() as folder:
        copy = pathlib.Path(folder) / "copy"
        shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(".git", "target", "out"))
        source = (copy / path).read_text()
        if source.count(before) != 1:
            sys.exit(f"panic_free.py: {path}: {before.strip()!r} is not there once")
        (copy / path).write_text(source.replace(before, before + panic))
        # Its own build folder: files of two copies of one package do not mix.
        environment = {**os.environ, "CARGO_TARGET_DIR": os.path.join(folder, "target")}
        built = subprocess.run(build, cwd=copy, env=environment, capture_output=True, text=True)
        if built.returncode == 0:
            sys.exit("panic_free.py: an image with an unwrap in it was linked")
        if HANDLER not in built.stderr:
            sys.exit(f"panic_free.py: the image with an unwrap failed for another reason:\n{built.stderr}")
        print(f"one unwrap more, and the linker misses {HANDLER}")


if __name__ == "__main__":
    of_c = sys.argv[1:2] == ["--c"]
    paths = sys.argv[2 if of_c else 1:]
    if not paths:
        sys.exit(__doc__)
    images(paths)
    one_more(*(C if of_c else FIRMWARE))
