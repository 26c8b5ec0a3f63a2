#!/usr/bin/env python3
"""Synthesises the sounds: assets/sounds/*.wav, 16 bit, 24 kHz, mono (music: stereo, 12 kHz).

Everything is sums of sines and a seeded noise with envelopes that begin and end at zero; loops hold
whole periods, so that their seam is silent. Samples are rounded from numbers far coarser than the
last bits of the C library: the files come out the same everywhere.

    tools/make_sounds.py [OUT_DIR]          (default assets/sounds)
"""
import array
import math
import os
import random
import sys
import wave

RATE = 24000
TAU = 2 * math.pi


def seconds(duration):
    return [i / RATE for i in range(round(duration * RATE))]


def envelope(t, duration, attack, decay):
    """Rises linearly, falls exponentially, and reaches zero at the end."""
    return min(1.0, t / attack) * math.exp(-t / decay) * min(1.0, (duration - t) / 0.01)


def noise(count, seed, smooth):
    """Seeded noise through a one-pole low pass: `smooth` near 1 is dark."""
    draw, out, y = random.Random(seed), [], 0.0
    for _ in range(count):
        y = smooth * y + (1 - smooth) * (2 * draw.random() - 1)
        out.append(y)
    peak = max(map(abs, out))
    return [v / peak for v in out]


def hum():
    """A lantern: a chord that loops, every partial a whole number of periods in two seconds."""
    partials = [(110, 0.5), (165, 0.25), (220, 0.2), (330.5, 0.08), (441, 0.05)]
    return [0.6 * sum(a * math.sin(TAU * f * t) for f, a in partials) * (1 - 0.2 * math.cos(TAU * t))
            for t in seconds(2)]


def chime():
    partials = [(1, 0.6, 0.6), (2.76, 0.25, 0.35), (5.4, 0.12, 0.2), (8.9, 0.06, 0.12)]  # of a struck bar
    return [sum(a * math.sin(TAU * 660 * r * t) * envelope(t, 1.6, 0.002, d) for r, a, d in partials)
            for t in seconds(1.6)]


def thud():
    duration, dust = 0.4, noise(round(0.4 * RATE), 3, 0.93)
    return [0.8 * math.sin(TAU * (55 * t + 20 * (1 - math.exp(-t / 0.05)) * 0.05)) * envelope(t, duration, 0.003, 0.09)
            + 0.25 * dust[i] * envelope(t, duration, 0.002, 0.03) for i, t in enumerate(seconds(duration))]


def step(seed):
    duration = 0.14
    leaves = noise(round(duration * RATE), seed, 0.6)
    return [0.5 * leaves[i] * envelope(t, duration, 0.004, 0.03) + 0.3 * math.sin(TAU * 90 * t)
            * envelope(t, duration, 0.003, 0.025) for i, t in enumerate(seconds(duration))]


def click():
    return [0.7 * math.sin(TAU * 1800 * t) * envelope(t, 0.05, 0.001, 0.008) for t in seconds(0.05)]


def wind():
    """Loops: the end is faded over the beginning."""
    count, seam = 4 * RATE, RATE // 2
    air = noise(count + seam, 11, 0.985)
    for i in range(seam):
        mix = i / seam
        air[i] = air[i] * math.sqrt(mix) + air[count + i] * math.sqrt(1 - mix)
    return [0.5 * air[i] * (1 + 0.3 * math.sin(TAU * i / count)) for i in range(count)]


def music():
    """Eight bars of plucked fifths, 3 s a bar of four: left and right a little apart."""
    bars = [(220, 330), (196, 294), (174.5, 261.5), (196, 294), (220, 330), (261.5, 392), (174.5, 261.5), (164.5, 247)]
    left, right = [0.0] * (RATE * 12), [0.0] * (RATE * 12)
    for bar, pair in enumerate(bars):
        for beat in range(4):
            begin = round((bar * 1.5 + beat * 0.375) * RATE)
            pitch = pair[beat % 2] * (2 if beat == 3 else 1)
            for i, t in enumerate(seconds(1.2)):
                value = 0.22 * envelope(t, 1.2, 0.004, 0.35) * (math.sin(TAU * pitch * t) + 0.3 * math.sin(2 * TAU * pitch * t))
                at = (begin + i) % len(left)  # the last notes ring into the beginning
                left[at] += value * (0.8 if beat % 2 else 1.0)
                right[at] += value * (1.0 if beat % 2 else 0.8)
    return [v for pair in zip(left[::2], right[::2]) for v in pair]  # nothing above 1.6 kHz


SOUNDS = {"hum": hum, "chime": chime, "thud": thud, "step1": lambda: step(5), "step2": lambda: step(6),
          "click": click, "wind": wind, "music": music}


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(__file__), "../assets/sounds")
    os.makedirs(folder, exist_ok=True)
    for name, make in SOUNDS.items():
        samples = make()
        assert max(map(abs, samples)) < 1, name
        with wave.open(os.path.join(folder, name + ".wav"), "wb") as out:
            out.setnchannels(2 if name == "music" else 1)
            out.setsampwidth(2)
            out.setframerate(RATE // 2 if name == "music" else RATE)
            out.writeframes(array.array("h", [round(16000 * round(v, 6)) for v in samples]).tobytes())


if __name__ == "__main__":
    main()
