"""Reads and writes the PNG files that the engine writes: 8 bits, RGB or RGBA, no interlace."""

import struct
import zlib
from pathlib import Path


def read(path):
    """(width, height, channels, rows): rows are bytearrays."""
    data = Path(path).read_bytes()
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError(f"{path} is no PNG")
    at, body, head = 8, b"", None
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        chunk = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            head = struct.unpack(">IIBBBBB", chunk)
        elif kind == b"IDAT":
            body += chunk
        at += 12 + size
    width, height, depth, color, _, _, interlace = head
    if depth != 8 or color not in (2, 6) or interlace:
        raise ValueError(f"{path}: only 8-bit RGB and RGBA")
    channels = 3 if color == 2 else 4
    return width, height, channels, unfilter(zlib.decompress(body), width * channels, height, channels)


def unfilter(raw, stride, height, step):
    rows, above = [], bytearray(stride)
    for y in range(height):
        kind = raw[y * (stride + 1)]
        row = bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        if kind == 1:
            for i in range(step, stride):
                row[i] = (row[i] + row[i - step]) & 255
        elif kind == 2:
            for i in range(stride):
                row[i] = (row[i] + above[i]) & 255
        elif kind == 3:
            for i in range(stride):
                left = row[i - step] if i >= step else 0
                row[i] = (row[i] + (left + above[i]) // 2) & 255
        elif kind == 4:
            for i in range(stride):
                left = row[i - step] if i >= step else 0
                corner = above[i - step] if i >= step else 0
                guess = left + above[i] - corner
                near = min((abs(guess - left), 0, left), (abs(guess - above[i]), 1, above[i]),
                           (abs(guess - corner), 2, corner))
                row[i] = (row[i] + near[2]) & 255
        rows.append(row)
        above = row
    return rows


def write(path, width, height, channels, rows):
    raw = b"".join(b"\0" + bytes(row) for row in rows)

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    head = struct.pack(">IIBBBBB", width, height, 8, 2 if channels == 3 else 6, 0, 0, 0)
    with open(path, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


def pixel(image, x, y):
    _, _, channels, rows = image
    return tuple(rows[y][x * channels:x * channels + 3])


def compare(path_a, path_b, tolerance=5):
    """Share of pixels of which a channel differs by more than the tolerance; 1.0 for other sizes."""
    a, b = read(path_a), read(path_b)
    if a[:2] != b[:2]:
        return 1.0
    different = 0
    for y in range(a[1]):
        for x in range(a[0]):
            different += any(abs(p - q) > tolerance for p, q in zip(pixel(a, x, y), pixel(b, x, y)))
    return different / (a[0] * a[1])


def difference(path_a, path_b, path_out):
    """Expected, actual and difference side by side."""
    a, b = read(path_a), read(path_b)
    rows = []
    for y in range(min(a[1], b[1])):
        row = bytearray()
        for image in (a, b):
            for x in range(image[0]):
                row += bytes(pixel(image, x, y))
        for x in range(min(a[0], b[0])):
            row += bytes(min(255, 8 * abs(p - q)) for p, q in zip(pixel(a, x, y), pixel(b, x, y)))
        rows.append(row)
    write(path_out, len(rows[0]) // 3, len(rows), 3, rows)
