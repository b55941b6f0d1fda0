"""A finished process, what it took and what it said, for the scripts that measure speed."""
import os
import subprocess
import time


class Run:
    """A finished process: its output, wall and CPU seconds, and peak memory in MiB."""

    def __init__(self, *words, env=None):
        self.start_s = time.perf_counter()
        process = self.begin([str(word) for word in words], {**os.environ, **(env or {})})
        errors = self.listen(process)
        _, status, usage = os.wait4(process.pid, 0)
        self.wall_s = time.perf_counter() - self.start_s
        self.cpu_s = usage.ru_utime + usage.ru_stime
        self.memory_mib = usage.ru_maxrss / 1024
        if status:
            raise SystemExit(f"{' '.join(map(str, words))}: {errors.decode(errors='replace').strip()}")

    def begin(self, words, env):
        return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=env)

    def listen(self, process):
        """Reads what the process writes until it ends, and returns its errors."""
        self.output = process.stdout.read()
        return process.stderr.read()
