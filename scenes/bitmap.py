"""Pictures of text as PNG files."""

import struct
import zlib

# Letters as five columns of seven rows, bit 0 at the top.
LETTERS = {
    "A": "7e1111117e", "B": "7f49494936", "C": "3e41414122", "D": "7f4141221c", "E": "7f49494941",
    "F": "7f09090901", "G": "3e41415132", "H": "7f0808087f", "I": "00417f4100", "J": "2040413f01",
    "K": "7f08142241", "L": "7f40404040", "M": "7f0204027f", "N": "7f0408107f", "O": "3e4141413e",
    "P": "7f09090906", "Q": "3e4151215e", "R": "7f09192946", "S": "4649494931", "T": "01017f0101",
    "U": "3f4040403f", "V": "1f2040201f", "W": "7f2018207f", "X": "6314081463", "Y": "0304780403",
    "Z": "6151494543", ".": "0060600000", ",": "0050300000", ":": "0036360000", " ": "0000000000",
}

INK, PAPER = (52, 46, 60), (236, 228, 208)


def printed(lines, size):
    """Rows of pixels with lines of text in the middle of a page of 4 to 3; a dot has `size` pixels."""
    columns, rows = 6 * max(len(line) for line in lines) + 14, 0
    rows = columns * 3 // 4
    left, top = 7, (rows - 11 * len(lines)) // 2
    dots = [[False] * columns for _ in range(rows)]
    for number, line in enumerate(lines):
        for position, letter in enumerate(line):
            for column, bits in enumerate(bytes.fromhex(LETTERS[letter])):
                for row in range(7):
                    if bits >> row & 1:
                        dots[top + 11 * number + row][left + 6 * position + column] = True
    # The first row of a bitmap is at v = 1 in Mitsuba, and v points away from the reader on a page that faces up.
    wide = [[INK if dot else PAPER for dot in row for _ in range(size)] for row in reversed(dots)]
    return [row for row in wide for _ in range(size)]


def write_png(path, rows):
    """Writes rows of sRGB pixels."""
    path.parent.mkdir(exist_ok=True)

    def chunk(kind, data):
        checksum = zlib.crc32(kind + data)
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", checksum)

    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)
    raw = b"".join(b"\0" + bytes(value for pixel in row for value in pixel) for row in rows)
    body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b"")
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + body)
