#!/usr/bin/env python3
"""Checks the structure of the sources: check_rooms.py [--root FOLDER] [--list] [OBJECT_FOLDER...]

Each folder of host/lib and host/tool is a room, and so are format/, cl/ and each binding.  The lists below order the rooms from the
lowest to the highest.  The script fails when

 - a file includes a header of a higher room, or of a part of the tree that its program may not use,
 - files include each other in a circle (a source and the header of its name count as one file),
 - host/tool or a public header includes a header of the library that is not public,
 - an #include "..." or <gscl/...> names no file of the tree,
 - a file outside host/lib/opencl names a type, a constant, a function or a header of OpenCL, or a room other than `device`
   uses host/lib/opencl or host/lib/native,
 - a file of the library or of format/ calls a function of the C library that rounds differently on other machines,
   and is not in a room whose results are in no file,
 - a file outside host/system, but for the public headers and host/web, asks which operating system it is compiled for,
 - a room is missing from the lists or has no room.h, or its room.h does not state what the room may use, or names files
   that do not exist.

Folders of object files, as the build makes them (libgscl.so.*.p), add calls: each symbol that one object uses and
another defines is an arrow between their sources, for which the same rules hold.

--list prints the rooms from the highest to the lowest with their files.  --root is the tree to check; by default the
one that contains this script.
"""
import argparse
import os
import re
import subprocess
import sys

# From the lowest room to the highest.  A room may use itself, lower rooms of its list, and what BASE names.
LIBRARY = ["runtime", "native", "opencl", "device", "image", "software", "decode", "fit", "session", "codebook", "scalar", "encode", "pack", "measure"]
TOOL = ["cli", "image", "plot", "tradeoff", "commands"]
PROGRAMS = {"host/lib": LIBRARY, "host/tool": TOOL}
BASE = {"host/lib": ["format", "cl", "host/system"], "host/tool": ["host/colours", "host/system"], "format": [], "cl": [], "host/system": []}
# Bindings are one room each, which uses itself, the public headers, and colours, which the tool uses, too.
BINDINGS = ["host/desktop", "host/openimageio"]
BASE |= {binding: ["host/colours"] for binding in BINDINGS}
BASE["host/colours"] = []
BINDINGS += ["host/colours", "host/system"]
# The decoder for web pages is compiled with parts of the library.
BINDINGS.append("host/web")
BASE["host/web"] = ["host/lib", "format", "cl", "host/system"]
# Rooms that only these rooms may use.
USERS = {"native": ["device"], "opencl": ["device"]}
# Where OpenCL may be named: its room, and tests that take the place of its functions, look at its errors or measure it.
OPENCL_ROOM = "host/lib/opencl/"
OPENCL_TESTS = ["tests/cli/odd_opencl.c", "tests/devices/count_launches.c", "tests/devices/opencl_builds.c",
                "tests/devices/opencl_latency.c", "tests/devices/opencl_probe.c", "tests/devices/opencl_probe.h",
                "tests/unit/fake_opencl.c", "tests/unit/fake_opencl.h", "tests/unit/opencl_faults.c", "tests/unit/test_device.c",
                "tests/unit/test_launch.c", "tests/unit/test_pinned.c", "tests/unit/test_program_cache.c"]
OPENCL_NAME = re.compile(r"\b(?!cl_khr_)(?:_?cl_[a-z]\w*|CL_[A-Z]\w*|cl[A-Z]\w*)|[<\"](?:CL|OpenCL)/\w+\.h")
PUBLIC = "host/include/gscl/"
# How sources ask for the operating system, and where they may: its room, and the public header, which exports functions.
SYSTEM = re.compile(r"\b(?:_WIN(?:32|64)|__MINGW(?:32|64)__|__APPLE__|__linux__|__(?:Free|Open|Net)BSD__|__CYGWIN__)\b")
SYSTEM_PLACES = ("host/system/", PUBLIC, "host/web/")
# What rounds differently on other machines (host/lib/runtime/elementary.h), and the rooms that may call it.
INEXACT = re.compile(r"(?<![\w.>])(?:a?(?:sin|cos|tan)h?|atan2|exp2?|expm1|log(?:2|10|1p|b)?|pow|hypot|cbrt|[lt]gamma|erfc?)[fl]?\(")
INEXACT_ROOMS = ("host/lib/measure/",)
COMMENT_OR_STRING = re.compile(r'/\*.*?\*/|//[^\n]*|(?<!include )"(?:\\.|[^"\\\n])*"', re.DOTALL)
SUFFIXES = (".c", ".h", ".cl", ".cpp")
INCLUDE = re.compile(r'^\s*#\s*include\s+(["<])([^">]+)[">]', re.MULTILINE)
PUBLIC_FUNCTION = re.compile(r"GSCL_API\b[^;{]*?\b(gscl_\w+)\(", re.DOTALL)
FILE_NAME = re.compile(r"(?<![\w/])\w+\.(?:c|h|cl|cpp)\b")


def room_of(path):
    """The room of a file as (program, name), ("format", "") or None for files outside all rooms."""
    parts = path.split("/")
    if parts[0] in ("format", "cl"):
        return parts[0], ""
    program = "/".join(parts[:2])
    if program in BINDINGS:
        return program, ""
    if program in PROGRAMS:
        return program, parts[2] if len(parts) > 3 else ""
    return None


def unit_of(path):
    """A source and the header of its name are one unit."""
    return os.path.splitext(path)[0]


def read(root, path):
    with open(os.path.join(root, path), encoding="utf-8") as file:
        return file.read()


def sources(root, tops=("format", "cl", "host")):
    found = set()
    for top in tops:
        for folder, _, names in os.walk(os.path.join(root, top)):
            found |= {os.path.relpath(os.path.join(folder, name), root) for name in names if name.endswith(SUFFIXES)}
    return found


# ---- Arrows ---------------------------------------------------------------------------------------


def resolve(path, name, files):
    """The file that an #include in `path` names, or None."""
    program = "/".join(path.split("/")[:2])
    for folder in (os.path.dirname(path), "", program if program in PROGRAMS else "host/lib", "host/include", "host"):
        candidate = os.path.normpath(os.path.join(folder, name))
        if candidate in files:
            return candidate
    return None


def includes(root, files):
    """Arrows from files to those that they include, and faults of includes that name no file."""
    arrows, faults = set(), []
    for path in sorted(files):
        for quote, name in INCLUDE.findall(read(root, path)):
            target = resolve(path, name, files)
            if target:
                arrows.add((path, target))
            elif quote == '"' or name.startswith("gscl/"):
                faults.append(f"{path}: includes {name}, which names no file")
    return arrows, faults


def objects(folders):
    return [os.path.join(where, name) for folder in folders for where, _, names in os.walk(folder) for name in names
            if name.endswith(".o")]


def symbols(path):
    """The symbols that an object file defines for others, and those that it uses from others."""
    defined, used = set(), set()
    text = subprocess.run(["nm", path], check=True, capture_output=True, text=True).stdout
    for line in text.splitlines():
        *_, kind, symbol = line.split()
        if kind in "Uw":
            used.add(symbol)
        elif kind.isupper():
            defined.add(symbol)
    return defined, used


def public_functions(root, files):
    return {name for path in files if path.startswith(PUBLIC) for name in PUBLIC_FUNCTION.findall(read(root, path))}


def calls(root, folders, files):
    """Arrows between sources whose objects take symbols from each other, and objects that have no source.  Calls of
    public functions by the tool are left out."""
    public = public_functions(root, files)
    sources_of = {path.replace("/", "_") + ".o": path for path in files}  # as meson names objects
    definers, users, faults = {}, [], []
    for path in objects(folders):
        name = os.path.basename(path)
        if name.startswith("meson-generated"):
            continue
        if name not in sources_of:
            faults.append(f"{path}: has no source in this tree; build again")
            continue
        defined, used = symbols(path)
        definers.update({symbol: sources_of[name] for symbol in defined})
        users.append((sources_of[name], used))
    arrows = {(path, definers[symbol]) for path, used in users for symbol in used
              if definers.get(symbol, path) != path and not (path.startswith("host/tool/") and symbol in public)}
    return arrows, faults if users else [f"{' '.join(folders)}: no object files"]


# ---- Rules ----------------------------------------------------------------------------------------


def fault(path, target):
    """The fault of an arrow from one file to another, or None."""
    if target.startswith(PUBLIC):
        return None
    if path.startswith(PUBLIC):
        return "a public header may include public headers only"
    user, used = room_of(path), room_of(target)
    if user is None or used is None:
        return "leaves all rooms"
    if user[0] != used[0]:
        return None if used[0] in BASE[user[0]] else f"{user[0]} may not use {used[0]}"
    rooms = PROGRAMS.get(user[0], [])
    if user[1] and not used[1]:
        return f"points upward, from {user[1]} to the top of {used[0]}"
    if user[1] and rooms.index(used[1]) > rooms.index(user[1]):
        return f"points upward, from {user[1]} to {used[1]}"
    if user[1] != used[1] and user[1] not in USERS.get(used[1], [user[1]]):
        return f"{user[1]} may not use {used[1]}"
    return None


def circles(arrows):
    """Groups of units that reach each other (Tarjan's strongly connected components)."""
    graph = {}
    for path, target in arrows:
        a, b = unit_of(path), unit_of(target)
        graph.setdefault(a, set())
        graph.setdefault(b, set())
        if a != b:
            graph[a].add(b)
    index, low, stack, found = {}, {}, [], []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        for target in sorted(graph[node]):
            if target not in index:
                visit(target)
                low[node] = min(low[node], low[target])
            elif target in stack:
                low[node] = min(low[node], index[target])
        if low[node] == index[node]:
            group = []
            while not group or group[-1] != node:
                group.append(stack.pop())
            if len(group) > 1:
                found.append(sorted(group))

    sys.setrecursionlimit(10000)
    for node in sorted(graph):
        if node not in index:
            visit(node)
    return found


def opencl_names(root):
    """Names of OpenCL outside its room."""
    for path in sorted(sources(root, ("format", "cl", "host", "tests"))):
        if path.startswith(OPENCL_ROOM) or path in OPENCL_TESTS:
            continue
        match = OPENCL_NAME.search(COMMENT_OR_STRING.sub(" ", read(root, path)))
        if match:
            name = match.group().lstrip('<"')
            yield f"{path}: names {name} of OpenCL, which only {OPENCL_ROOM} may"


def inexact_calls(root):
    """Calls in the library and format/ of functions of the C library on which bytes of files must not depend."""
    for path in sorted(sources(root, ("format", "host/lib"))):
        match = INEXACT.search(COMMENT_OR_STRING.sub(" ", read(root, path)))
        if match and not path.startswith(INEXACT_ROOMS):
            yield f"{path}: calls {match.group()[:-1]} of the C library, which rounds differently on other machines"


def system_questions(root):
    """Sources that ask for the operating system outside its room."""
    for path in sorted(sources(root)):
        match = SYSTEM.search(COMMENT_OR_STRING.sub(" ", read(root, path)))
        if match and not path.startswith(SYSTEM_PLACES):
            yield f"{path}: asks for {match.group()}, which only host/system may"


def unlisted_rooms(files):
    for path in sorted(files):
        room = room_of(path)
        if room and room[0] in PROGRAMS and room[1] and room[1] not in PROGRAMS[room[0]]:
            yield f"{path}: the room {room[1]} is not in the list of {room[0]}"


def undescribed_rooms(root, files):
    """Each room has a room.h of comments that states what the room may use and names its files in reading order."""
    for program, rooms in PROGRAMS.items():
        for room in rooms:
            header = f"{program}/{room}/room.h"
            if header not in files:
                yield f"{header}: is missing; it states what the room is for, what it may use and in what order to read it"
                continue
            comment = re.match(r"/\*.*?\*/", read(root, header), re.DOTALL)
            if not comment or "may use" not in comment.group():
                yield f"{header}: does not begin with a comment that states what the room may use"
                continue
            for name in FILE_NAME.findall(comment.group()):
                if f"{program}/{room}/{name}" not in files:
                    yield f"{header}: names {name}, which is not in the room"
            for path in sorted(files):
                name = os.path.basename(path)
                if room_of(path) == (program, room) and name.endswith(".h") and name not in comment.group() + "room.h":
                    yield f"{header}: does not name {name}"


def print_rooms(files):
    for program, rooms in PROGRAMS.items():
        for room in reversed(rooms):
            names = sorted(os.path.basename(path) for path in files if room_of(path) == (program, room))
            print(f"{program}/{room + '/':12} {len(names):3}  {' '.join(names)}")


def check(root, folders):
    """All faults of a tree."""
    files = sources(root)
    faults = list(unlisted_rooms(files)) + list(undescribed_rooms(root, files))
    if any("is not in the list" in text for text in faults):
        return faults
    arrows, unresolved = includes(root, files)
    faults += unresolved
    if folders:
        called, unmatched = calls(root, folders, files)
        arrows |= called
        faults += unmatched
    faults += opencl_names(root)
    faults += inexact_calls(root)
    faults += system_questions(root)
    faults += [f"{path} -> {target}: {why}" for path, target in sorted(arrows) if (why := fault(path, target))]
    return faults + ["circle: " + " ".join(group) for group in circles(arrows)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", default=os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
    parser.add_argument("--list", action="store_true")
    parser.add_argument("objects", nargs="*", metavar="OBJECT_FOLDER")
    options = parser.parse_args()
    files = sources(options.root)
    if options.list:
        print_rooms(files)
    faults = check(options.root, options.objects)
    print("\n".join(faults) or f"{len(files)} files in {len(LIBRARY) + len(TOOL) + 2} rooms: no circle, no arrow upward")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
