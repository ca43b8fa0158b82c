"""docker/ci: the shell lines of the examples, run as they stand."""

import os
import shutil
import subprocess
import xml.etree.ElementTree as ET

import pytest
import yaml

from support.daemon import BIN, ROOT, SLOW
from test_batch import write_scene

CI = ROOT / "docker" / "ci"


def github_lines():
    steps = yaml.safe_load((CI / "github.yml").read_text())["jobs"]["pictures"]["steps"]
    return [step["run"] for step in steps if "run" in step]


def gitlab_lines():
    return yaml.safe_load((CI / "gitlab.yml").read_text())["pictures"]["script"]


@pytest.mark.parametrize("lines", [github_lines(), gitlab_lines()], ids=["github", "gitlab"])
def test_the_shell_lines_run(lines, tmp_path):
    assert lines
    write_scene(tmp_path / "scenes", "box")
    shutil.copy(CI / "scenes.yaml", tmp_path)
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


def test_the_artifacts_are_those_that_are_written():
    github = yaml.safe_load((CI / "github.yml").read_text())["jobs"]["pictures"]["steps"][-1]["with"]["path"]
    gitlab = yaml.safe_load((CI / "gitlab.yml").read_text())["pictures"]["artifacts"]
    assert github.split() == ["report", "junit.xml"]
    assert gitlab["paths"] == ["report"] and gitlab["reports"]["junit"] == "junit.xml"
