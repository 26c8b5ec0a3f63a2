"""Starts a program on the present X display and presses keys for it, as a person would (XTest).

    python3 xkeys.py "wait:1.5 key:F1 down:d wait:0.5 up:d move:10,20 key:Escape" PROGRAM ARGS...

saw:TEXT*2 waits until the program has written TEXT (without blanks) twice to its standard error, so that
a busy machine is waited for. Exits with the program's code; 77 where the X test library is missing.
"""

import ctypes
import subprocess
import sys
import threading
import time


def load():
    try:
        return ctypes.CDLL("libX11.so.6"), ctypes.CDLL("libXtst.so.6")
    except OSError:
        sys.exit(77)


def main():
    x11, xtst = load()
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XStringToKeysym.restype = ctypes.c_ulong
    display = ctypes.c_void_p(x11.XOpenDisplay(None))
    if not display:
        sys.exit(77)

    def send(call, *args):
        call(display, *args, ctypes.c_ulong(0))
        x11.XFlush(display)
        time.sleep(0.05)

    def key(name, down):
        code = x11.XKeysymToKeycode(display, ctypes.c_ulong(x11.XStringToKeysym(name.encode())))
        send(xtst.XTestFakeKeyEvent, ctypes.c_uint(code), ctypes.c_int(down))

    program = subprocess.Popen(sys.argv[2:], stderr=subprocess.PIPE, text=True, errors="replace")
    said = []

    def listen():
        for line in program.stderr:
            said.append(line)
            sys.stderr.write(line)
            sys.stderr.flush()

    listener = threading.Thread(target=listen, daemon=True)
    listener.start()
    for word in sys.argv[1].split():
        what, _, rest = word.partition(":")
        if what == "wait":
            time.sleep(float(rest))
        elif what == "saw":
            text, _, times = rest.partition("*")
            deadline = time.monotonic() + 40
            while "".join(said).count(text) < int(times or 1) and time.monotonic() < deadline:
                time.sleep(0.02)
        elif what == "move":
            x, y = map(int, rest.split(","))
            send(xtst.XTestFakeMotionEvent, ctypes.c_int(-1), ctypes.c_int(x), ctypes.c_int(y))
        elif what == "click":
            send(xtst.XTestFakeButtonEvent, ctypes.c_uint(int(rest)), ctypes.c_int(1))
            send(xtst.XTestFakeButtonEvent, ctypes.c_uint(int(rest)), ctypes.c_int(0))
        else:
            if what in ("down", "key"):
                key(rest, 1)
            if what in ("up", "key"):
                key(rest, 0)
    try:
        code = program.wait(30)
        listener.join(5)
        sys.exit(code)
    except subprocess.TimeoutExpired:
        program.kill()
        sys.exit(124)


if __name__ == "__main__":
    main()
