"""A real raykilnd on a free port with a store of its own, started and ended by the test."""

import os
import re
import signal
import subprocess
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
BIN = Path(os.environ.get("RAYKILN_BIN_DIR", ROOT / "build" / "test" / "bin"))
# Sanitized builds run many times slower; limits on time stretch by this factor.
SLOW = float(os.environ.get("RAYKILN_SLOW", "1"))  # what patience is multiplied by
COST = float(os.environ.get("RAYKILN_COST", "1"))  # what a sample costs beside an ordinary build's


def fewer(samples: int) -> int:
    """Samples a pixel, at least 2, that keep a sanitized build busy for as long as `samples` do another."""
    return max(2, round(samples / COST))


_LISTENING = re.compile(r"http://127\.0\.0\.1:(\d+)")


class Daemon:
    def __init__(self, store: Path, workers: int = 2, options=(), environment=None):
        self.store = Path(store)
        self.workers = workers
        self.options = list(options)
        self.environment = environment or {}
        self.process = None
        self.port = None
        self.log_path = self.store.parent / f"{self.store.name}.log"
        self.ready_path = self.store.parent / f"{self.store.name}.ready"

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    @property
    def log(self) -> str:
        return self.log_path.read_text(errors="replace")

    def start(self) -> "Daemon":
        command = [str(BIN / "raykilnd"), "--listen", "127.0.0.1:0", "--store",
                   str(self.store), "--workers", str(self.workers), "--ready-file",
                   str(self.ready_path), *self.options]
        self.ready_path.unlink(missing_ok=True)
        with open(self.log_path, "ab") as sink:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=sink,
                                            stderr=sink, env={**os.environ, **self.environment})
        self.port = self._wait_for_port(time.monotonic() + 120 * SLOW)
        return self

    def _wait_for_port(self, deadline: float) -> int:
        while time.monotonic() < deadline:
            written = self.ready_path.read_text() if self.ready_path.exists() else ""
            if found := _LISTENING.search(written):
                return int(found.group(1))
            if self.process.poll() is not None:
                break
            time.sleep(0.01)
        self.kill()
        raise AssertionError(f"raykilnd did not say where it listens:\n{self.log}")

    def stop(self, timeout: float = 120.0) -> int:
        """SIGTERM; returns the exit code."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        try:
            return self.process.wait(timeout * SLOW)
        except subprocess.TimeoutExpired:
            self.kill()
            raise AssertionError(f"raykilnd did not stop after SIGTERM:\n{self.log[-4000:]}")

    def kill(self):
        """SIGKILL: what a power cut looks like."""
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()

    def alive(self) -> bool:
        return self.process.poll() is None

    def status_kib(self, field: str = "VmRSS") -> int:
        """A line of /proc/PID/status, in KiB."""
        for line in Path(f"/proc/{self.process.pid}/status").read_text().splitlines():
            if line.startswith(field + ":"):
                return int(line.split()[1])
        raise AssertionError(f"no {field} in /proc/{self.process.pid}/status")

    def reset_peak(self):
        """Makes VmHWM start again from the present size."""
        Path(f"/proc/{self.process.pid}/clear_refs").write_text("5")

    def files(self) -> dict:
        """Relative path -> size of every file in the store but the database.

        The daemon may remove files and folders meanwhile: what is gone when it is looked at
        does not count. os.walk passes over folders that are gone, Path.rglob raises.
        """
        found = {}
        for folder, _, names in os.walk(self.store):
            for name in names:
                if ".sqlite" in name or ".db" in name:
                    continue
                path = Path(folder) / name
                try:
                    found[str(path.relative_to(self.store))] = path.stat().st_size
                except FileNotFoundError:
                    pass
        return found

    def wait_for_files(self, expected: dict, timeout: float = 120.0):
        """Until the store holds just these: an answer may come before what it was about is cleared away."""
        deadline = time.monotonic() + timeout * SLOW
        while (found := self.files()) != expected:
            assert time.monotonic() < deadline, (found, expected)
            time.sleep(0.02)
