"""docker/ci: the shell lines of the examples, run as they stand."""

import os
import subprocess
import xml.etree.ElementTree as ET

import pytest
import yaml

from support.daemon import BIN, ROOT, SLOW, fewer
from test_batch import write_scene

CI = ROOT / "docker" / "ci"


def github_lines():
    steps = yaml.safe_load((CI / "github.yml").read_text())["jobs"]["pictures"]["steps"]
    return [step["run"] for step in steps if "run" in step]


def gitlab_lines():
    return yaml.safe_load((CI / "gitlab.yml").read_text())["pictures"]["script"]


def github_kept():
    steps = yaml.safe_load((CI / "github.yml").read_text())["jobs"]["pictures"]["steps"]
    (path,) = [step["with"]["path"] for step in steps if step.get("uses", "").startswith("actions/upload-artifact")]
    return path.split()


def gitlab_kept():
    kept = yaml.safe_load((CI / "gitlab.yml").read_text())["pictures"]["artifacts"]
    return [*kept["paths"], kept["reports"]["junit"]]


def caches():
    """Folders that both examples keep from run to run."""
    steps = yaml.safe_load((CI / "github.yml").read_text())["jobs"]["pictures"]["steps"]
    (github,) = [step["with"]["path"] for step in steps if step.get("uses", "").startswith("actions/cache")]
    (gitlab,) = yaml.safe_load((CI / "gitlab.yml").read_text())["pictures"]["cache"]["paths"]
    return github, gitlab


@pytest.mark.parametrize("lines, kept", [(github_lines(), github_kept()), (gitlab_lines(), gitlab_kept())],
                         ids=["github", "gitlab"])
def test_the_shell_lines_run(lines, kept, tmp_path):
    assert lines and kept
    write_scene(tmp_path / "scenes", "box")
    plan = (CI / "scenes.yaml").read_text()
    assert "{samples: 64}" in plan
    (tmp_path / "scenes.yaml").write_text(plan.replace("{samples: 64}", f"{{samples: {fewer(64)}}}"))
    environment = {**os.environ, "PATH": f"{BIN.resolve()}:{os.environ['PATH']}", "GITHUB_ACTIONS": "true",
                   "GITHUB_STEP_SUMMARY": str(tmp_path / "summary.md")}

    def shell(text):
        return subprocess.run(["bash", "-e", "-c", text], cwd=tmp_path, env=environment, check=False,
                              capture_output=True, text=True, timeout=300 * SLOW)

    first = shell("\n".join(lines))
    assert first.returncode == 11 and "::error title=box::" in first.stdout, first.stderr
    assert shell("raykiln approve report --all").returncode == 0
    second = shell("\n".join(lines))
    assert second.returncode == 0, second.stdout + second.stderr
    assert ET.parse(tmp_path / "junit.xml").getroot()[0].get("failures") == "0"
    assert (tmp_path / "report" / "index.html").exists()
    # What a run writes is kept, what is kept is written, and the store of before is used again.
    new = {path.name for path in tmp_path.iterdir()} - {"scenes", "scenes.yaml", "references", "summary.md"}
    unkept = {"raykilnd.url", "raykilnd.log", *caches()}
    assert new - unkept == set(kept) and (tmp_path / caches()[0] / "raykiln.db").exists()
    assert "1 reused" in second.stderr
