#!/usr/bin/env python3
"""Checks the structure of the sources: check_rooms.py [--list] [OBJECT_FOLDER]

Each folder of host/lib and host/tool is a room, and so are format/ and cl/.  The lists below give the rooms from the
lowest to the highest.  The script fails when

 - a file includes a header of a higher room, or of a room that its program may not use,
 - files include each other in a circle (a source and the header of its name count as one file),
 - host/tool includes a header of the library that is not public,
 - a room has no header that describes it, or a folder is missing from the lists.

With a folder of object files, made by the build, it also checks calls: the symbols that an object takes from another
must lead to lower rooms only, and in no circle.  --list prints the rooms with their numbers of files.
"""
import os
import re
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

# From the lowest room to the highest.  A room may use itself, lower rooms of its own list, and what BASE gives it.
LIBRARY = ["runtime", "image", "decode", "fit", "session", "codebook", "scalar", "encode", "measure"]
TOOL = ["cli", "image", "plot", "tradeoff", "commands"]
BASE = {"host/lib": ["format", "cl"], "host/tool": [], "format": [], "cl": []}
PUBLIC = "host/include/gscl/"
INCLUDE = re.compile(r'^\s*#\s*include\s+["<]([^">]+)[">]', re.MULTILINE)


def room_of(path):
    """The room of a file: ("host/lib", "fit"), ("format", "") or None for files outside all rooms."""
    parts = path.split("/")
    if parts[0] in ("format", "cl"):
        return parts[0], ""
    if path.startswith(("host/lib/", "host/tool/")):
        return "/".join(parts[:2]), parts[2] if len(parts) > 3 else ""
    return None


def unit_of(path):
    """A source and the header of its name are one unit."""
    return os.path.splitext(path)[0]


def sources():
    found = []
    for top in ("format", "cl", "host"):
        for folder, _, names in os.walk(os.path.join(ROOT, top)):
            found += [os.path.relpath(os.path.join(folder, name), ROOT) for name in names
                      if name.endswith((".c", ".h", ".cl", ".cpp"))]
    return sorted(found)


def resolve(path, name, files):
    """The file that an #include in `path` names, or None for one of the system."""
    folders = [os.path.dirname(path), "", "host/lib" if path.startswith("host/lib/") else "host/tool", "host/include"]
    for folder in folders:
        candidate = os.path.normpath(os.path.join(folder, name))
        if candidate in files:
            return candidate
    return None


def includes(files):
    arrows = set()
    for path in files:
        with open(os.path.join(ROOT, path), encoding="utf-8") as file:
            for name in INCLUDE.findall(file.read()):
                target = resolve(path, name, files)
                if target:
                    arrows.add((path, target))
    return arrows


def calls(folder, files):
    """Arrows between sources whose objects take symbols from each other (nm)."""
    defined, used = {}, {}
    for where, _, names in os.walk(folder):
        for name in names:
            if not name.endswith(".o"):
                continue
            source = name[:-2].replace("_", "/")
            match = [path for path in files if path.replace("/", "_") == source.replace("/", "_")
                     or os.path.join(where, name).endswith(path.replace("/", "_") + ".o")]
            if len(match) != 1:
                continue
            text = subprocess.run(["nm", os.path.join(where, name)], check=True, capture_output=True, text=True).stdout
            for line in text.splitlines():
                *_, kind, symbol = line.split()
                if kind == "U":
                    used.setdefault(match[0], set()).add(symbol)
                elif kind.isupper():
                    defined[symbol] = match[0]
    return {(path, defined[symbol]) for path, symbols in used.items() for symbol in symbols
            if symbol in defined and defined[symbol] != path}


def order_of(program):
    return LIBRARY if program == "host/lib" else TOOL


def fault(path, target):
    """What is wrong with an arrow from one file to another, or None."""
    source, goal = room_of(path), room_of(target)
    if source is None or goal is None:
        return None if target.startswith(PUBLIC) or source is None else "leaves all rooms"
    if source[0] != goal[0]:
        return None if goal[0] in BASE[source[0]] else f"{source[0]} may not use {goal[0]}"
    rooms = order_of(source[0])
    if source[0] in BASE and source[1] and goal[1] and rooms.index(goal[1]) > rooms.index(source[1]):
        return f"points upward, from {source[1]} to {goal[1]}"
    if source[1] and not goal[1]:
        return f"points upward, from {source[1]} to the top of {goal[0]}"
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
        for target in graph[node]:
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


def unlisted_rooms(files):
    for path in files:
        room = room_of(path)
        if room and room[0].startswith("host/") and room[1] and room[1] not in order_of(room[0]):
            yield f"{path}: the room {room[1]} is not in the list of {room[0]}"


def undescribed_rooms():
    for program in ("host/lib", "host/tool"):
        for room in order_of(program):
            header = f"{program}/{room}/room.h"
            if not os.path.isfile(os.path.join(ROOT, header)):
                yield f"{header}: is missing; it says what the room is for, what it may use and in what order to read it"


def print_rooms(files):
    for program in ("host/lib", "host/tool"):
        for room in reversed(order_of(program)):
            names = [os.path.basename(path) for path in files if room_of(path) == (program, room)]
            print(f"{program}/{room + '/':12} {len(names):3}  {' '.join(names)}")


def main(arguments):
    files = set(sources())
    if "--list" in arguments:
        print_rooms(sorted(files))
        arguments.remove("--list")
    faults = list(unlisted_rooms(sorted(files))) + list(undescribed_rooms())
    if not faults:
        arrows = includes(files)
        if arguments:
            called = calls(arguments[0], files)
            if not called:
                faults.append(f"{arguments[0]}: holds no object files of the library")
            arrows |= called
        faults += [f"{path} -> {target}: {why}" for path, target in sorted(arrows) if (why := fault(path, target))]
        faults += ["circle: " + " ".join(group) for group in circles(arrows)]
    print("\n".join(faults) or f"{len(files)} files in {len(LIBRARY) + len(TOOL) + 2} rooms: no circle, no arrow upward")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
