"""Runs one command: everything it prints goes to a log, and a sign of life to the terminal."""

import os
import signal
import subprocess
import sys
import time

_EVERY_TTY_S = 0.5
_EVERY_PIPE_S = 15.0


def run(name, command, log, cwd, env=None) -> int:
    """Appends to `log`; returns the exit code. On failure the log's end is printed."""
    print(f"== {name}: {' '.join(map(str, command))[:150]}", flush=True)
    start = time.monotonic()
    with open(log, "ab") as sink:
        begin = sink.tell()
        process = subprocess.Popen(command, cwd=cwd, env={**os.environ, **(env or {})},
                                   stdin=subprocess.DEVNULL, stdout=sink,
                                   stderr=subprocess.STDOUT, start_new_session=True)
        try:
            code = _watch(process, log, begin, start)
        except BaseException:
            # Ctrl-C must not leave compilers or a daemon behind.
            os.killpg(process.pid, signal.SIGTERM)
            process.wait()
            raise
    print(f"   {'ok' if code == 0 else f'exit code {code}'} after "
          f"{time.monotonic() - start:.1f} s", flush=True)
    if code != 0:
        print(_tail(log, begin, 40), flush=True)
    return code


def _watch(process, log, begin, start) -> int:
    tty = sys.stdout.isatty()
    interval = _EVERY_TTY_S if tty else _EVERY_PIPE_S
    while True:
        try:
            code = process.wait(interval)
            break
        except subprocess.TimeoutExpired:
            line = _tail(log, begin, 1).strip()[:100]
            text = f"   {time.monotonic() - start:5.0f} s  {line}"
            print(f"\r\033[K{text}" if tty else text, end="" if tty else "\n", flush=True)
    if tty:
        print("\r\033[K", end="")
    return code


def _tail(log, begin, lines) -> str:
    with open(log, "rb") as source:
        size = source.seek(0, os.SEEK_END)
        source.seek(max(begin, size - 16384))
        text = source.read().decode(errors="replace")
    return "\n".join([l for l in text.replace("\r", "\n").split("\n") if l.strip()][-lines:])
