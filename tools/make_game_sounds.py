#!/usr/bin/env python3
"""Synthesises the game's sounds: scripts/game/sounds/*.wav, 16 bit, mono, 24 kHz, and music.ogg (by sox).

Sines, plucked strings (Karplus, Strong 1983) and seeded noise; every one begins and ends at zero,
loops hold whole periods or fade their end over their beginning.

    tools/make_game_sounds.py [OUT_DIR]          (default scripts/game/sounds)
"""
import array
import math
import os
import random
import shutil
import subprocess
import sys
import wave

from make_sounds import RATE, TAU, envelope, noise, seconds


def step(seed, smooth, body, pitch):
    """A paw: a rustle above a soft knock."""
    duration = 0.13
    rustle = noise(round(duration * RATE), seed, smooth)
    return [0.45 * rustle[i] * envelope(t, duration, 0.004, 0.025) + body * math.sin(TAU * pitch * t) * envelope(t, duration, 0.002, 0.022)
            for i, t in enumerate(seconds(duration))]


def bell(pitch, duration, partials=((1, 0.6, 0.6), (2.76, 0.22, 0.3), (5.4, 0.1, 0.15))):
    return [sum(a * math.sin(TAU * pitch * r * t) * envelope(t, duration, 0.003, d) for r, a, d in partials)
            for t in seconds(duration)]


def mix(*layers):
    """(samples, start in seconds, gain) on top of each other."""
    count = max(round(start * RATE) + len(s) for s, start, _ in layers)
    out = [0.0] * count
    for samples, start, gain in layers:
        at = round(start * RATE)
        for i, v in enumerate(samples):
            out[at + i] += gain * v
    return out


def light():
    return mix((bell(880, 1.2), 0, 0.5), (bell(1318.5, 1.2), 0.07, 0.4))


def key():
    return mix(*((bell(f, 1.4), 0.11 * i, 0.4) for i, f in enumerate((659.3, 830.6, 987.8, 1318.5))))


def spirit(up):
    duration = 0.9
    air = noise(round(duration * RATE), 21, 0.8)
    out, phase = [], 0.0
    for i, t in enumerate(seconds(duration)):
        way = t / duration if up else 1 - t / duration
        phase += TAU * (220 + 440 * way * way) / RATE
        out.append((0.3 * math.sin(phase) + 0.2 * math.sin(1.5 * phase) + 0.2 * air[i]) * math.sin(math.pi * t / duration) ** 2)
    return out


def door():
    """A groan that slips and sticks, and two thuds."""
    duration = 2.4
    out, phase = [], 0.0
    grain = noise(round(duration * RATE), 5, 0.97)
    for i, t in enumerate(seconds(duration)):
        phase += TAU * (70 + 25 * math.sin(3.1 * t) + 30 * grain[i]) / RATE
        saw = (phase / TAU) % 1 - 0.5
        out.append(0.3 * saw * math.sin(math.pi * t / duration) + 0.3 * grain[i] * math.sin(math.pi * t / duration))
    knock = [math.sin(TAU * 60 * t) * envelope(t, 0.3, 0.003, 0.07) for t in seconds(0.3)]
    return mix((out, 0, 0.8), (knock, 0.02, 0.6), (knock, 2.2, 0.7))


def alarm():
    """A low growl that rises."""
    duration = 1.1
    out, phase = [], 0.0
    for t in seconds(duration):
        phase += TAU * (62 + 50 * t) / RATE
        rough = 1 + 0.5 * math.sin(TAU * 23 * t)
        out.append(0.3 * rough * sum(math.sin(k * phase) / k for k in (1, 2, 3, 5)) * math.sin(math.pi * t / duration))
    return out


def caught():
    return mix(*((bell(f, 1.0, ((1, 0.6, 0.4), (2.0, 0.2, 0.3))), 0.16 * i, 0.5) for i, f in enumerate((392, 349.2, 293.7))))


def splash():
    duration = 0.7
    drops = noise(round(duration * RATE), 8, 0.5)
    return [0.7 * drops[i] * envelope(t, duration, 0.01, 0.13) + 0.2 * math.sin(TAU * (180 + 500 * t) * t) * envelope(t, duration, 0.01, 0.1)
            for i, t in enumerate(seconds(duration))]


def jump():
    return [0.35 * math.sin(TAU * (190 + 520 * t) * t) * envelope(t, 0.2, 0.01, 0.06) for t in seconds(0.2)]


def night():
    """Crickets and air, 8 s, a loop: every chirp ends before the seam, the air fades over it."""
    count, seam = 8 * RATE, RATE
    air = noise(count + seam, 31, 0.992)
    for i in range(seam):
        w = i / seam
        air[i] = air[i] * math.sqrt(w) + air[count + i] * math.sqrt(1 - w)
    out = [0.22 * v for v in air[:count]]
    draw = random.Random(77)
    for pitch, gap, gain in ((4100, 0.83, 0.05), (3620, 1.27, 0.04), (4550, 1.71, 0.03)):
        at = 0.3 * draw.random()
        while at < 7.6:
            for pulse in range(3):
                for i, t in enumerate(seconds(0.03)):
                    out[round((at + 0.05 * pulse) * RATE) + i] += gain * math.sin(TAU * pitch * t) * math.sin(math.pi * t / 0.03)
            at += gap * (0.85 + 0.3 * draw.random())
    return out


def hum():
    """A lantern's flame, a loop of two seconds: whole periods."""
    return [sum(a * math.sin(TAU * f * t) for f, a in ((98, 0.4), (147, 0.25), (196, 0.15), (294.5, 0.06)))
            * (0.75 + 0.25 * math.sin(TAU * 1.5 * t)) * 0.6 for t in seconds(2)]


def pluck(pitch, duration, seed, bright):
    """A string: a burst of noise round a delay line that loses its treble."""
    size = max(2, round(RATE / pitch))
    line = noise(size, seed, 1 - bright)
    mean = sum(line) / size
    line = [v - mean for v in line]
    out = []
    for i in range(round(duration * RATE)):
        k = i % size
        out.append(line[k])
        line[k] = 0.4985 * (line[k] + line[(k + 1) % size])
    last = round(0.05 * RATE)
    return [v * min(1.0, i / 96, (len(out) - i) / last) for i, v in enumerate(out)]


def music():
    """Sixteen bars in D minor, 2.4 s each: broken chords, a pad, a melody in the second half."""
    bar, beat = 2.4, 0.4
    chords = [(146.8, 220, 293.7, 349.2), (116.5, 233.1, 293.7, 349.2), (130.8, 196, 261.6, 329.6), (110, 220, 261.6, 329.6)]
    melody = [587.3, 0, 523.3, 440, 0, 349.2, 392, 0, 440, 349.2, 329.6, 293.7, 0, 440, 523.3, 587.3, 0, 698.5, 659.3, 0, 523.3,
              440, 392, 440]
    count = round(16 * bar * RATE)
    left, right = [0.0] * count, [0.0] * count

    def put(samples, start, gain, side):
        at = round(start * RATE)
        for i, v in enumerate(samples):
            k = (at + i) % count  # the last notes ring into the beginning
            left[k] += gain * (1 - 0.5 * side) * v
            right[k] += gain * (1 + 0.5 * side) * v

    strings = {}
    for number in range(16):
        chord = chords[number % 4]
        for i, note in enumerate((0, 2, 1, 3, 2, 1)):
            tone = chord[note] * (2 if number >= 8 and i == 3 else 1)
            if tone not in strings:
                strings[tone] = pluck(tone, 2.2, round(tone), 0.35)
            put(strings[tone], number * bar + i * beat, 0.2, -0.6 if i % 2 else 0.3)
        pad = [0.05 * math.sin(math.pi * t / 3.2) ** 2 * (math.sin(TAU * chord[0] * t) + 0.7 * math.sin(TAU * chord[1] * t)
               + 0.4 * math.sin(TAU * chord[3] * t + 0.3 * math.sin(TAU * 5 * t))) for t in seconds(3.2)]
        put(pad, number * bar - 0.4, 1.0, 0.0)
    for i, tone in enumerate(melody):
        if tone:
            put(bell(tone, 1.8, ((1, 0.5, 0.7), (2, 0.2, 0.4), (3, 0.06, 0.2))), 8 * bar + i * 2 * beat, 0.16, 0.4)
    return left, right


def water():
    """A brook, a loop of four seconds."""
    count, seam = 4 * RATE, RATE // 2
    flow = noise(count + seam, 41, 0.9)
    for i in range(seam):
        w = i / seam
        flow[i] = flow[i] * math.sqrt(w) + flow[count + i] * math.sqrt(1 - w)
    return [0.3 * flow[i] * (1 + 0.4 * math.sin(TAU * 3 * i / count) * math.sin(TAU * 5 * i / count)) for i in range(count)]


SOUNDS = {
    "step_grass1": lambda: step(5, 0.55, 0.12, 90), "step_grass2": lambda: step(6, 0.6, 0.12, 84),
    "step_stone1": lambda: step(7, 0.2, 0.25, 210), "step_stone2": lambda: step(8, 0.25, 0.25, 190),
    "step_wood1": lambda: step(9, 0.7, 0.6, 140), "step_wood2": lambda: step(10, 0.7, 0.6, 122),
    "light": light, "key": key, "spirit_on": lambda: spirit(True), "spirit_off": lambda: spirit(False), "door": door,
    "alarm": alarm, "caught": caught, "splash": splash, "jump": jump, "night": night, "hum": hum, "water": water, "music": music,
}


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(os.path.abspath(__file__)), "../scripts/game/sounds")
    os.makedirs(folder, exist_ok=True)
    for name, make in SOUNDS.items():
        samples = make()
        stereo = isinstance(samples, tuple)
        flat = [v for pair in zip(*samples) for v in pair] if stereo else samples
        peak = max(map(abs, flat))
        scale = min(1.0, 0.85 / peak) if not stereo else 0.8 / peak
        path = os.path.join(folder, name + ".wav")
        with wave.open(path, "wb") as out:
            out.setnchannels(2 if stereo else 1)
            out.setsampwidth(2)
            out.setframerate(RATE)
            out.writeframes(array.array("h", [round(32000 * round(v * scale, 6)) for v in flat]).tobytes())
        if stereo and shutil.which("sox"):
            subprocess.run(["sox", path, "-C", "3", path[:-4] + ".ogg"], check=True)
            os.remove(path)


if __name__ == "__main__":
    main()
