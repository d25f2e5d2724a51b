"""An X server for tests; tests/window/x11_person.h is that of C++."""

import contextlib
import ctypes
import os
import subprocess


@contextlib.contextmanager
def virtual_display():
    """Xvfb on a free display; gives what DISPLAY is to be."""
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "800x600x24", "-nolisten", "tcp"],
        pass_fds=[write],
        stderr=subprocess.DEVNULL,
    )
    try:
        os.close(write)
        with os.fdopen(read) as number:  # Xvfb writes it when it is ready
            name = number.readline().strip()
        yield f":{name}"
    finally:
        server.terminate()
        server.wait()


def press(name: str, *keys: int):
    """A person presses and releases these keys (keysyms) of the X server `name`, one after the other."""
    x11, test = (ctypes.CDLL(f"lib{library}.so.6") for library in ("X11", "Xtst"))
    x11.XOpenDisplay.restype = ctypes.c_void_p
    server = ctypes.c_void_p(x11.XOpenDisplay(name.encode()))
    assert server, f"no X server {name}"
    for key in keys:
        code = x11.XKeysymToKeycode(server, ctypes.c_ulong(key))
        for down in (1, 0):
            test.XTestFakeKeyEvent(server, code, down, ctypes.c_ulong(0))
    x11.XCloseDisplay(server)
