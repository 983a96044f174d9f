"""Compares the code of inline functions and templates among object files; exit status 1 if any differ.

    compare_inline_functions.py a.o b.o ...      compiled without optimization and with -fnon-call-exceptions

A function that several objects define has a section group of its own in each, of which the linker keeps one. Without
optimization its bytes depend on its source alone: addresses are in the relocations, which are not compared. The option
keeps the compiler from inferring that a function throws nothing, which it can only where it has seen all definitions. Headers
must not switch the optimization on by a pragma.
"""

import collections
import hashlib
import struct
import subprocess
import sys

SECTION_HEADER = struct.Struct("<IIQQQQIIQQ")  # of 64-bit ELF, little endian
IN_GROUP = 0x200  # SHF_GROUP
NO_BITS = 8  # SHT_NOBITS


def grouped_sections(path):
    """The sections (name, size, bytes) of an object that belong to a group: code and data of inline definitions."""
    with open(path, "rb") as file:
        data = file.read()
    if data[:6] != b"\x7fELF\x02\x01":
        sys.exit(f"error: {path} is no object file of 64-bit ELF")
    start, = struct.unpack_from("<Q", data, 0x28)
    entry_size, count, names_index = struct.unpack_from("<HHH", data, 0x3A)
    # Numbers of 65,280 sections and more do not fit: they are in the size and the link of the first header.
    first = SECTION_HEADER.unpack_from(data, start)
    count = count or first[5]
    names_index = first[6] if names_index == 0xFFFF else names_index
    headers = [SECTION_HEADER.unpack_from(data, start + i * entry_size) for i in range(count)]
    names = headers[names_index][4]
    for name, kind, flags, _, offset, size, *_ in headers:
        if flags & IN_GROUP:
            text = data[names + name:data.index(b"\0", names + name)].decode()
            if text.startswith((".text.", ".data.", ".rodata.", ".bss.")):
                yield text, size, b"" if kind == NO_BITS else data[offset:offset + size]


def main():
    definitions = collections.defaultdict(dict)  # section name: {(size, hash): first object}
    for path in sys.argv[1:]:
        for name, size, content in grouped_sections(path):
            definitions[name].setdefault((size, hashlib.sha256(content).digest()), path)
    different = {name: found for name, found in definitions.items() if len(found) > 1}
    for name, found in different.items():
        symbol = name[name.index("_Z"):] if "_Z" in name else name
        text = subprocess.run(["c++filt", symbol], capture_output=True, text=True, check=True).stdout.strip()
        print(f"error: {text} has different code in\n  " +
              "\n  ".join(f"{path} ({size} bytes)" for (size, _), path in found.items()))
    sys.exit(1 if different else 0)


main()
