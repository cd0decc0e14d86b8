# SPDX-License-Identifier: MIT OR Apache-2.0
"""Cuts rows out of POV-Ray's 16-bit PPM and writes them as PNG, the mean of each FACTOR x FACTOR pixels as one:

    python3 average.py IN.ppm FACTOR TOP ROWS OUT.png      (TOP and ROWS in pixels of the PNG)
"""

import struct
import sys
import zlib


def main():
    source, factor, top, rows, out = sys.argv[1], *map(int, sys.argv[2:5]), sys.argv[5]
    with open(source, "rb") as file:
        words = []
        while len(words) < 4:
            words += file.readline().split(b"#")[0].split()
        if words[0] != b"P6" or words[3] != b"65535":
            sys.exit(f"average.py: {source} is no PPM of 16 bits")
        width = int(words[1])
        start = file.tell()
        file.seek(start + top * factor * width * 6)
        data = file.read(rows * factor * width * 6)
    packed = []
    for row in range(rows):
        lines = []
        for line in range(factor):
            at = (row * factor + line) * width * 6
            lines.append(struct.unpack(f">{width * 3}H", data[at : at + width * 6]))
        sums = [sum(column) for column in zip(*lines)]
        for x in range(0, width * 3, 3 * factor):
            for channel in range(x, x + 3):
                mean = sum(sums[channel : channel + 3 * factor : 3]) / (factor * factor)
                packed.append(int(mean + 0.5))
    width //= factor
    body = b"".join(
        b"\0" + struct.pack(f">{width * 3}H", *packed[row * width * 3 : (row + 1) * width * 3]) for row in range(rows)
    )
    with open(out, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        header = struct.pack(">IIBBBBB", width, rows, 16, 2, 0, 0, 0)
        for kind, chunk in ((b"IHDR", header), (b"IDAT", zlib.compress(body)), (b"IEND", b"")):
            file.write(struct.pack(">I", len(chunk)) + kind + chunk)
            file.write(struct.pack(">I", zlib.crc32(kind + chunk)))


main()
