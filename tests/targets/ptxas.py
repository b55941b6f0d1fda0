"""NVIDIA's compiler of PTX, from PyPI, and what it tells of each kernel."""
import os
import platform
import re
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
INSIDE = f"lib/python{sys.version_info.major}.{sys.version_info.minor}/site-packages/nvidia/cuda_nvcc/bin/ptxas"

FUNCTION = re.compile(r"Compiling entry function '([\w$]+)'")
STACK = re.compile(r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads")
REGISTERS = re.compile(r"Used (\d+) registers")
CUMULATIVE = re.compile(r"(\d+) bytes cumulative stack size")
SHARED = re.compile(r"(\d+) bytes smem")


def install(folder):
    """The path of ptxas in a virtual environment in `folder`, which is made; None where it cannot be installed."""
    if platform.machine() != "x86_64" or sys.platform != "linux":
        return None
    command = os.path.join(folder, INSIDE)
    if not os.path.exists(command):
        pip = [os.path.join(folder, "bin/pip"), "--disable-pip-version-check", "--quiet", "install", "--no-deps", "-r",
               os.path.join(HERE, "requirements.txt")]
        for step in ([sys.executable, "-m", "venv", folder], pip):
            if subprocess.run(step, stdin=subprocess.DEVNULL, capture_output=True).returncode:
                return None
    return command


def number(pattern, text):
    found = pattern.search(text)
    return int(found[1]) if found else 0


def kernels(report):
    """{kernel: {column: number}} of what ptxas -v writes: bytes, but for registers.  `spilled`: those that it stores."""
    parts = FUNCTION.split(report)[1:]
    result = {}
    for name, text in zip(parts[::2], parts[1::2]):
        frame = STACK.search(text)
        result[name] = {"registers": number(REGISTERS, text), "stack": max(int(frame[1]), number(CUMULATIVE, text)),
                        "spilled": int(frame[2]), "shared": number(SHARED, text)}
    return result
