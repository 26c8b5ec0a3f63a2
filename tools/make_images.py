#!/usr/bin/env python3
"""Draws the images of assets/images: python3 tools/make_images.py

coin.png: a coin that turns, eight frames of 64 x 64 texels in a row, edges by 4 x 4 samples.
"""

import math
import struct
import zlib
from pathlib import Path

OUT = Path(__file__).resolve().parent.parent / "assets/images"
SIDE, FRAMES, SAMPLES = 64, 8, 4


def write_png(path, width, height, rows):
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    raw = b"".join(b"\0" + bytes(row) for row in rows)
    head = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(raw, 9))
                     + chunk(b"IEND", b""))


def coin(x, y, turn):
    """Colour and coverage at a point of [-1, 1]^2 for a coin turned about its upright axis."""
    width = max(abs(math.cos(turn)), 0.12)
    r = math.hypot(x / width, y) / 0.92
    if r > 1:
        return None
    light = 0.75 + 0.25 * math.cos(turn) * (0.6 * -x / width + 0.8 * -y)
    if r > 0.84:
        return [c * light for c in (255, 214, 92)]
    star = r < 0.5 + 0.16 * math.cos(5 * math.atan2(x / width, -y))
    return [c * light for c in ((255, 226, 130) if star else (226, 160, 40))]


def frame_row(y):
    row = []
    for frame in range(FRAMES):
        for x in range(SIDE):
            hits = []
            for i in range(SAMPLES * SAMPLES):
                px = (x + (i % SAMPLES + 0.5) / SAMPLES) * 2 / SIDE - 1
                py = (y + (i // SAMPLES + 0.5) / SAMPLES) * 2 / SIDE - 1
                hit = coin(px, py, math.pi * frame / FRAMES)
                if hit:
                    hits.append(hit)
            # Transparent texels keep a colour of the coin, so that filtering draws no dark rim.
            color = [sum(h[k] for h in hits) / len(hits) for k in range(3)] if hits else [226, 160, 40]
            row += [min(255, round(c)) for c in color] + [round(255 * len(hits) / SAMPLES**2)]
    return row


if __name__ == "__main__":
    OUT.mkdir(exist_ok=True)
    write_png(OUT / "coin.png", SIDE * FRAMES, SIDE, [frame_row(y) for y in range(SIDE)])
