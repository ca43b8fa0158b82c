"""Fixtures: one daemon shared by tests that only read or add, and a factory for the rest."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from support.api import Api  # noqa: E402
from support.daemon import BIN, Daemon  # noqa: E402


def pytest_configure(config):
    config.addinivalue_line("markers", "measured: states a time or a size that a sanitizer spoils")
    config.addinivalue_line("markers", "one_thread: long, and nothing for a race detector to find")
    config.addinivalue_line("markers", "long: does more with RAYKILN_LONG=1; tests/run --full")
    config.addinivalue_line("markers", "size: needs a large model from npm; tests/run --full")
    if not (BIN / "raykilnd").exists():
        pytest.exit(f"no raykilnd in {BIN}: build it, or set RAYKILN_BIN_DIR", returncode=2)


@pytest.fixture(scope="session")
def shared(tmp_path_factory):
    """An Api on a daemon that lives through the session. It must survive every test."""
    daemon = Daemon(tmp_path_factory.mktemp("shared") / "store").start()
    yield Api(daemon)
    assert daemon.stop() == 0, daemon.log[-4000:]


@pytest.fixture
def api(shared):
    """The shared daemon. The test during which it dies fails; the next one gets a new process."""
    if not shared.daemon.alive():
        shared.daemon.start()
    yield shared
    code = shared.daemon.process.poll()
    assert code is None, f"the daemon died (exit code {code}):\n{shared.daemon.log[-2000:]}"
    assert shared.get("/livez").status_code == 200


@pytest.fixture
def launch(tmp_path):
    """launch(workers=2, options=[...], store=...) -> Api on a daemon of its own."""
    started = []

    def start(store="store", **options):
        daemon = Daemon(tmp_path / store, **options).start()
        started.append(daemon)
        return Api(daemon)

    yield start
    for daemon in started:
        daemon.kill()


@pytest.fixture(scope="session")
def samples(shared):
    """Scene ids by name, uploaded once."""
    from support import scenes

    return {"box": shared.scene(scenes.box_zip()), "grid": shared.scene(scenes.grid_zip(60))}
