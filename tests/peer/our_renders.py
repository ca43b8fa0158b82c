"""Renders by a daemon of raykiln of its own: one start of the program for all pictures."""

import io
import json
import re
import shutil
import subprocess
import time
import urllib.error
import urllib.parse
import urllib.request
import zipfile
from pathlib import Path

PATIENCE_S = 600.0


class Missing(Exception):
    """What raykiln refuses, or says that it leaves out."""


def companions(path: Path) -> list:
    """Files beside a .gltf that it names and that are there."""
    try:
        root = json.loads(path.read_bytes())
        entries = [e for kind in ("buffers", "images") for e in root.get(kind, [])]
        names = {urllib.parse.unquote(e["uri"]) for e in entries
                 if isinstance(e, dict) and isinstance(e.get("uri"), str) and not e["uri"].startswith("data:")}
    except (ValueError, AttributeError, TypeError):
        return []
    return sorted(n for n in names if ".." not in Path(n).parts and (path.parent / n).is_file())


class Raykiln:
    def __init__(self, folder: Path, programs: Path, workers: int):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        ready, self.log = folder / "ready", open(folder / "log", "wb")
        self.process = subprocess.Popen(
            [str(programs / "raykilnd"), "--listen", "127.0.0.1:0", "--store", str(folder / "store"),
             "--workers", str(workers), "--ready-file", str(ready)],
            stdin=subprocess.DEVNULL, stdout=self.log, stderr=self.log)
        end = time.monotonic() + PATIENCE_S
        while not (ready.exists() and (found := re.search(r"http://[\d.]+:\d+", ready.read_text()))):
            if self.process.poll() is not None or time.monotonic() > end:
                raise RuntimeError(f"raykilnd did not start; see {folder / 'log'}")
            time.sleep(0.05)
        self.url = found[0]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()
        self.log.close()

    def _ask(self, path, body=None, kind="application/json") -> bytes:
        request = urllib.request.Request(self.url + path, data=body, headers={"Content-Type": kind})
        with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
            return answer.read()

    def upload(self, folder: Path) -> str:
        """The files of a folder as one zip; the scene's id."""
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w") as archive:
            for path in sorted(p for p in folder.iterdir() if p.is_file()):
                archive.write(path, path.name)
        try:
            scene = json.loads(self._ask("/v1/scenes", packed.getvalue(), "application/zip"))
        except urllib.error.HTTPError as refusal:
            said = json.loads(refusal.read())
            raise Missing(f"refused: {said['detail']} [{said['code']}]") from refusal
        ignored = [w for w in scene["warnings"] if "ignored" in w["code"] or "ignored" in w.get("message", "")]
        if ignored:
            raise Missing(ignored[0].get("message") or ignored[0]["code"])
        return scene["id"]

    def verdict(self, path: Path) -> str:
        """On one glTF file and what it names beside it: empty where it is taken, else the refusal."""
        if path.suffix == ".glb":
            body, kind = path.read_bytes(), "model/gltf-binary"
        else:
            packed, kind = io.BytesIO(), "application/zip"
            with zipfile.ZipFile(packed, "w") as archive:
                archive.write(path, path.name)
                for name in companions(path):
                    archive.write(path.parent / name, name)
            body = packed.getvalue()
        try:
            self._ask("/v1/scenes", body, kind)
        except urllib.error.HTTPError as refusal:
            said = json.loads(refusal.read())
            crashed = "CRASHED: " if refusal.code >= 500 else ""
            return f"{crashed}{said['detail']} [{said['code']}]"
        return ""

    def render(self, scene: str, size, samples: int, seed: int, **options) -> bytes:
        """An EXR."""
        fields = {"scene": scene, "width": size[0], "height": size[1], "seed": seed,
                  "stop": {"samples": samples}, **options}
        job = json.loads(self._ask("/v1/jobs", json.dumps(fields).encode()))["id"]
        end = time.monotonic() + PATIENCE_S
        while (state := json.loads(self._ask(f"/v1/jobs/{job}")))["state"] != "completed":
            if state["state"] in ("failed", "cancelled") or time.monotonic() > end:
                raise RuntimeError(f"the job is {state['state']}: {state.get('error')}")
            time.sleep(0.02)
        return self._ask(f"/v1/jobs/{job}/image?format=exr")
