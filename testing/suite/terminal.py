#!/usr/bin/env python3
"""terminal.py FILE COMMAND...: runs a command whose standard error is a terminal, and keeps what it writes there in FILE."""
import os
import subprocess
import sys

out, command = sys.argv[1], sys.argv[2:]
ours, theirs = os.openpty()
process = subprocess.Popen(command, stderr=theirs)
os.close(theirs)
with open(out, "wb") as kept:
    while True:
        try:
            data = os.read(ours, 65536)
        except OSError:  # Linux's way to say that the last writer has closed it
            break
        if not data:
            break
        kept.write(data)
sys.exit(process.wait())
