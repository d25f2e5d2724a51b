"""An X server for tests; tests/window/x11_person.h is that of C++."""

import contextlib
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
