"""Reads the WAV files that --audio writes: 32-bit float, stereo."""

import array
import math
import struct
from pathlib import Path


def read(path):
    """(rate, left, right)"""
    data = Path(path).read_bytes()
    riff, size, kind = struct.unpack("<4sI4s", data[:12])
    if riff != b"RIFF" or kind != b"WAVE" or size != len(data) - 8:
        raise ValueError(f"{path} is no whole WAV")
    at, rate, samples = 12, 0, None
    while at < len(data):
        name, length = struct.unpack("<4sI", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if name == b"fmt ":
            form, channels, rate = struct.unpack("<HHI", body[:8])
            if (form, channels) != (3, 2):
                raise ValueError(f"{path}: format {form}, {channels} channels")
        elif name == b"data":
            samples = array.array("f", body)
        at += 8 + length
    return rate, samples[0::2], samples[1::2]


def level(samples, begin, end):
    """Root mean square."""
    part = samples[begin:end]
    return math.sqrt(sum(v * v for v in part) / len(part))


def louder(a, b, begin, end):
    """By how many decibels a is louder than b; silence counts as -240 dB."""
    return 20 * math.log10(max(level(a, begin, end), 1e-12) / max(level(b, begin, end), 1e-12))
