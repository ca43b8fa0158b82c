"""The HTTP API as the tests use it. Checks nothing but what a caller says it expects."""

import hashlib
import time

import requests

from support.daemon import SLOW
from support.sse import EventStream

FINAL = ("completed", "failed", "cancelled")
ZIP = "application/zip"
GLB = "model/gltf-binary"


class Api:
    def __init__(self, daemon):
        self.daemon = daemon
        self.session = requests.Session()
        self.session.trust_env = False

    def request(self, method, path, **options):
        options.setdefault("timeout", 180 * SLOW)
        return self.session.request(method, self.daemon.url + path, **options)

    def get(self, path, **options):
        return self.request("GET", path, **options)

    def post(self, path, body, expect=(202,), **options):
        return self._expected(self.request("POST", path, json=body, **options), expect)

    def json(self, path, **options):
        answer = self.get(path, **options)
        assert answer.status_code == 200, (path, answer.status_code, answer.text)
        return answer.json()

    def upload(self, data, kind=ZIP, expect=(200, 201), **options):
        answer = self.request("POST", "/v1/scenes", data=data,
                              headers={"Content-Type": kind}, **options)
        return self._expected(answer, expect)

    def upload_files(self, files: dict, expect=(200, 201)):
        parts = [("file", (name, content)) for name, content in files.items()]
        return self._expected(self.request("POST", "/v1/scenes", files=parts), expect)

    def put(self, data, digest=None, kind=ZIP, expect=(200, 201)):
        digest = digest or hashlib.sha256(data).hexdigest()
        answer = self.request("PUT", f"/v1/scenes/{digest}", data=data,
                              headers={"Content-Type": kind})
        return self._expected(answer, expect)

    def scene(self, data, kind=ZIP) -> str:
        return self.upload(data, kind).json()["id"]

    def submit(self, scene, expect=(202,), headers=None, **fields):
        body = {"scene": scene, "width": 32, "height": 24, "stop": {"samples": 4}, **fields}
        answer = self.request("POST", "/v1/jobs", json=body, headers=headers)
        return self._expected(answer, expect)

    def job(self, scene, **fields) -> str:
        return self.submit(scene, **fields).json()["id"]

    def state(self, job) -> dict:
        return self.json(f"/v1/jobs/{job}")

    def cancel(self, job, expect=(202,)):
        return self._expected(self.request("POST", f"/v1/jobs/{job}/cancel"), expect)

    def events(self, job, **options) -> EventStream:
        options.setdefault("timeout", 180 * SLOW)
        return EventStream(self.daemon.port, f"/v1/jobs/{job}/events", **options)

    def wait(self, job, timeout=180.0) -> dict:
        """The final snapshot, as the event stream gives it."""
        with self.events(job, timeout=timeout * SLOW) as stream:
            final = stream.last().data
        assert final["state"] in FINAL, f"the stream ended at {final['state']}"
        return final

    def wait_until(self, job, condition, timeout=120.0) -> dict:
        """Polls; fails when the condition is not met in time or a final state comes first."""
        deadline = time.monotonic() + timeout * SLOW
        while True:
            snapshot = self.state(job)
            if condition(snapshot):
                return snapshot
            assert snapshot["state"] not in FINAL, snapshot
            assert time.monotonic() < deadline, snapshot
            time.sleep(0.005)

    def image(self, job, kind="png", expect=(200,), headers=None, **query):
        answer = self.get(f"/v1/jobs/{job}/image", params={"format": kind, **query},
                          headers=headers)
        return self._expected(answer, expect)

    def delete(self, scene, expect=(204,)):
        return self._expected(self.request("DELETE", f"/v1/scenes/{scene}"), expect)

    @staticmethod
    def _expected(answer, expect):
        assert answer.status_code in expect, (
            answer.request.method, answer.url, answer.status_code, answer.text[:2000])
        return answer


def problem(answer, status, code):
    """Asserts that an answer is the problem+json with this status and code; returns it."""
    kind = answer.headers.get("Content-Type", "")
    assert answer.status_code == status, (answer.status_code, answer.text[:1000])
    assert kind.split(";")[0] == "application/problem+json", (kind, answer.text[:300])
    body = answer.json()
    assert (body["status"], body["code"]) == (status, code), body
    assert body["type"] == f"about:blank#{code}" and body["title"] and body["detail"], body
    return body
