"""Prints one compile command for each source file of a build folder, as JSON: compile_commands.py BUILD

The library is compiled twice, shared and static, and parts of it for web pages, too; one command a file is enough."""
import json
import pathlib
import sys

build = pathlib.Path(sys.argv[1])
commands = {}
for name in ("host/web/compile_commands_encoder.json", "host/web/compile_commands.json", "compile_commands.json"):
    if (build / name).exists():
        for command in json.loads((build / name).read_text()):
            commands[(pathlib.Path(command["directory"]) / command["file"]).resolve()] = command
print(json.dumps(list(commands.values())))
