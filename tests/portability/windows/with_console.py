#!/usr/bin/env python3
"""Runs a command with a terminal as its standard input, for which Wine opens a console: with_console.py COMMAND...

What the command writes to the console is read and thrown away; standard output and standard error stay as they are.
"""
import os
import pty
import subprocess
import sys
import threading


def read_all(terminal):
    try:
        while os.read(terminal, 4096):
            pass
    except OSError:  # the other end is closed
        pass


terminal, other_end = pty.openpty()
threading.Thread(target=read_all, args=(terminal,), daemon=True).start()
sys.exit(subprocess.call(sys.argv[1:], stdin=other_end, start_new_session=True))
