"""proto/openapi.yaml against the daemon: every documented operation is replayed, and every
answer has a documented status, media type and schema."""

import re

import jsonschema
import pytest
import yaml

from support import scenes
from support.api import GLB, ZIP
from support.daemon import ROOT
from support.sse import EventStream

DOCUMENT_PATH = ROOT / "proto" / "openapi.yaml"
DOCUMENT = yaml.safe_load(DOCUMENT_PATH.read_text())
METHODS = ("get", "put", "post", "delete", "patch", "head", "options", "trace")
OPERATIONS = {(method, path): operation for path, item in DOCUMENT["paths"].items()
              for method, operation in item.items() if method in METHODS}
# The statuses that every operation may answer with, from the text at the document's head.
ANYWHERE = {"400", "403", "405", "408", "413", "414", "421", "431", "503"}


def resolve(node):
    while "$ref" in node:
        target = DOCUMENT
        for step in node["$ref"].removeprefix("#/").split("/"):
            target = target[step]
        node = target
    return node


def validate(instance, schema):
    """The schema may point anywhere into the document, so the document is its root."""
    jsonschema.Draft202012Validator(
        {**schema, "components": DOCUMENT["components"]},
        format_checker=jsonschema.FormatChecker()).validate(instance)


class Replayer:
    """Sends requests by (method, documented path) and checks each answer."""

    def __init__(self, api):
        self.api = api
        self.seen = set()

    def __call__(self, method, path, status, fill=None, **options):
        operation = OPERATIONS[(method, path)]
        target = re.sub(r"\{(\w+)\}", lambda match: fill[match.group(1)], path)
        answer = self.api.request(method.upper(), target, **options)
        assert answer.status_code == status, (method, target, answer.status_code, answer.text[:800])
        self.check(operation, answer)
        self.seen.add((method, path))
        return answer

    @staticmethod
    def check(operation, answer):
        status = str(answer.status_code)
        documented = operation["responses"]
        if status not in documented:
            assert status in ANYWHERE, f"{operation['operationId']}: {status} is not documented"
            documented = {status: {"$ref": "#/components/responses/Problem"}}
        response = resolve(documented[status])
        for name, header in response.get("headers", {}).items():
            if header.get("required") is False and name not in answer.headers:
                continue
            assert name in answer.headers, f"{operation['operationId']} {status}: no {name}"
            schema = resolve(header).get("schema", {})
            if schema.get("type") == "integer":
                int(answer.headers[name])
        content = response.get("content")
        if not content:
            assert answer.content == b"", f"{operation['operationId']} {status} has a body"
            return
        kind = answer.headers["Content-Type"].split(";")[0].strip()
        assert kind in content, f"{operation['operationId']} {status}: {kind} is not documented"
        if kind.endswith("json"):
            validate(answer.json(), content[kind]["schema"])
        else:
            assert answer.content


JSON = {"Content-Type": "application/json"}


@pytest.fixture(scope="module")
def replay(tmp_path_factory):
    from support.api import Api
    from support.daemon import Daemon

    daemon = Daemon(tmp_path_factory.mktemp("contract") / "store").start()
    yield Replayer(Api(daemon))
    daemon.kill()


def test_every_operation(replay):
    scene = replay_scenes(replay)
    job = replay_jobs(replay, scene)
    replay_pictures(replay, job)
    replay_batches(replay, scene)
    replay_server(replay, job)
    replay("delete", "/v1/scenes/{scene}", 204, {"scene": scene})
    replay("delete", "/v1/scenes/{scene}", 404, {"scene": scene})
    missing = set(OPERATIONS) - replay.seen
    assert not missing, f"never exercised: {sorted(missing)}"


def replay_scenes(replay) -> str:
    import hashlib

    data, other = scenes.box_zip("contract"), scenes.triangle_glb()
    create = ("post", "/v1/scenes")
    scene = replay(*create, 201, data=data, headers={"Content-Type": ZIP}).json()["id"]
    replay(*create, 200, data=data, headers={"Content-Type": ZIP})
    replay(*create, 422, data=data[:-9], headers={"Content-Type": ZIP})
    replay(*create, 415, data=data, headers={"Content-Type": "image/png"})
    replay(*create, 400, data=b"x", headers={"Content-Type": "multipart/form-data; boundary=x"})
    replay(*create, 403, data=data, headers={"Content-Type": ZIP, "Origin": "http://evil.example"})
    replay(*create, 201, files=[("f", (n, c)) for n, c in scenes.box_files("listed").items()])
    put, digest = ("put", "/v1/scenes/{scene}"), hashlib.sha256(other).hexdigest()
    replay(*put, 422, {"scene": "1" * 64}, data=other, headers={"Content-Type": GLB})
    replay(*put, 201, {"scene": digest}, data=other, headers={"Content-Type": GLB})
    replay(*put, 200, {"scene": digest}, data=other, headers={"Content-Type": GLB})
    replay("get", "/v1/scenes", 200, params={"limit": 1})
    replay("get", "/v1/scenes", 400, params={"limit": 0})
    replay("get", "/v1/scenes/{scene}", 200, {"scene": scene})
    replay("get", "/v1/scenes/{scene}", 404, {"scene": "2" * 64})
    replay("get", "/v1/scenes/{scene}", 400, {"scene": "no-digest"})
    replay("post", "/v1/scenes/{scene}/prepare", 202, {"scene": scene})
    replay("post", "/v1/scenes/{scene}/prepare", 404, {"scene": "2" * 64})
    return scene


def replay_jobs(replay, scene) -> str:
    create = ("post", "/v1/jobs")
    request = {"scene": scene, "width": 64, "height": 48, "stop": {"samples": 8}}
    key = {"Idempotency-Key": "contract"}
    job = replay(*create, 202, json=request, headers=key).json()["id"]
    replay(*create, 202, json=request, headers=key)
    replay(*create, 409, json={**request, "seed": 1}, headers=key)
    replay(*create, 422, json={**request, "width": 0})
    replay(*create, 422, json={**request, "effects": {"without": ["moire"]}})
    draft = replay(*create, 202, json={**request, "effects": {"without": ["diffuse_reflection"]}}).json()["id"]
    assert replay.api.wait(draft)["effects"]["approximation"]
    replay("get", "/v1/jobs/{job}", 200, {"job": draft})
    replay(*create, 404, json={**request, "scene": "2" * 64})
    replay(*create, 400, data=b"{", headers=JSON)
    replay(*create, 415, data=b"{}", headers={"Content-Type": "text/plain"})
    replay(*create, 413, data=b" " * 300_000, headers=JSON)
    # Snapshots of every state that can be met, while it runs and afterwards.
    state = None
    while state not in ("completed", "failed"):
        state = replay("get", "/v1/jobs/{job}", 200, {"job": job}).json()["state"]
    assert state == "completed"
    replay(*create, 200, json={**request, "reuse": True})
    replay("get", "/v1/jobs/{job}", 404, {"job": "j_none"})
    replay("get", "/v1/jobs", 200, params={"state": "completed"})
    replay("get", "/v1/jobs", 400, params={"state": "asleep"})
    replay("get", "/v1/jobs/{job}/accuracy", 200, {"job": job})
    replay("get", "/v1/jobs/{job}/accuracy", 404, {"job": "j_none"})
    replay("post", "/v1/jobs/{job}/cancel", 409, {"job": job})
    more = replay("post", "/v1/jobs/{job}/extend", 202, {"job": job}, json={"stop": {"samples": 99}}).json()["id"]
    assert replay.api.wait(more)["continues"]["job"] == job
    replay("get", "/v1/jobs/{job}", 200, {"job": more})
    replay("post", "/v1/jobs/{job}/extend", 422, {"job": job}, json={"stop": {"samples": 1}})
    replay("post", "/v1/jobs/{job}/extend", 404, {"job": "j_none"}, json={"stop": {"samples": 9}})
    asked = {key: value for key, value in request.items() if key != "stop"}
    quote = replay("post", "/v1/quotes", 202, json={**asked, "pilot_seconds": 0.1}).json()["id"]
    replay.api.wait(quote)
    replay("get", "/v1/quotes/{job}", 200, {"job": quote})
    replay("get", "/v1/quotes/{job}", 404, {"job": "j_none"})
    replay("post", "/v1/quotes", 422, json=request)
    endless = replay(*create, 202, json={**request, "width": 512, "height": 512,
                                         "stop": {"samples": 1048576}}).json()["id"]
    replay("post", "/v1/jobs/{job}/cancel", 202, {"job": endless})
    replay("post", "/v1/jobs/{job}/cancel", 404, {"job": "j_none"})
    assert replay.api.wait(endless)["state"] == "cancelled"
    replay("get", "/v1/jobs/{job}", 200, {"job": endless})
    return job


def replay_pictures(replay, job):
    events = ("get", "/v1/jobs/{job}/events")
    replay(*events, 200, {"job": job})
    with replay.api.events(job) as stream:
        final = stream.last()
    validate(final.data, {"$ref": "#/components/schemas/Job"})
    replay(*events, 204, {"job": job}, headers={"Last-Event-ID": final.id})
    replay(*events, 404, {"job": "j_none"})
    image = ("get", "/v1/jobs/{job}/image")
    tag = replay(*image, 200, {"job": job}).headers["ETag"]
    replay(*image, 200, {"job": job}, params={"format": "exr", "layer": "beauty"})
    replay(*image, 304, {"job": job}, headers={"If-None-Match": tag})
    replay(*image, 400, {"job": job}, params={"format": "gif"})
    replay(*image, 404, {"job": "j_none"})
    half = replay(*image, 200, {"job": job}, params={"format": "exr", "type": "half"})
    assert half.headers["Raykiln-Clamped-Values"] == "0"
    replay(*image, 400, {"job": job}, params={"type": "half"})
    sample, first = ("get", "/v1/jobs/{job}/samples"), {"x": 0, "y": 0, "sample": 0}
    replay(*sample, 200, {"job": job}, params=first)
    replay(*sample, 400, {"job": job}, params={"x": 0, "y": 0})
    replay(*sample, 400, {"job": job}, params={**first, "x": 64})
    replay(*sample, 404, {"job": "j_none"}, params=first)


def replay_batches(replay, scene):
    create, gone = ("post", "/v1/batches"), "2" * 64
    request = {"defaults": {"width": 32, "height": 24, "stop": {"samples": 4}},
               "scenes": [{"scene": scene, "name": "there", "cameras": [0], "settings": [{"name": "low"}]},
                          {"scene": gone, "name": "gone"}]}
    validate(request, {"$ref": "#/components/schemas/BatchRequest"})
    key = {"Idempotency-Key": "contract"}
    batch = replay(*create, 202, json=request, headers=key).json()["id"]
    replay(*create, 409, json={**request, "priority": 1}, headers=key)
    replay(*create, 422, json={**request, "scenes": []})
    replay(*create, 400, data=b"{", headers=JSON)
    replay(*create, 415, data=b"{}", headers={"Content-Type": "text/plain"})
    replay(*create, 413, data=b" " * 1_200_000, headers=JSON)
    one, known = "/v1/batches/{batch}", {"batch": batch}
    while replay("get", one, 200, known).json()["state"] == "running":
        pass
    replay("get", one, 404, {"batch": "b_none"})
    replay("get", "/v1/batches", 200, params={"limit": 1})
    replay("get", "/v1/batches", 400, params={"limit": 0})
    with EventStream(replay.api.daemon.port, f"/v1/batches/{batch}/events") as stream:
        final = stream.last()
    validate(final.data, {"$ref": "#/components/schemas/Batch"})
    replay("get", one + "/events", 200, known)
    replay("get", one + "/events", 204, known, headers={"Last-Event-ID": final.id})
    replay("get", one + "/events", 404, {"batch": "b_none"})
    replay("post", one + "/cancel", 202, known)
    replay("post", one + "/cancel", 404, {"batch": "b_none"})
    replay("post", one + "/rerun", 202, known)
    replay("post", one + "/rerun", 404, {"batch": "b_none"})
    missing = ("post", "/v1/missing-scenes")
    assert replay(*missing, 200, json={"scenes": [scene, gone]}).json() == {"missing": [gone]}
    replay(*missing, 422, json={"scenes": ["x"]})
    replay("get", "/batches", 200)
    replay("get", "/batches/{batch}", 200, known)


def replay_server(replay, job):
    served = replay("get", "/openapi.yaml", 200)
    assert served.content == DOCUMENT_PATH.read_bytes()
    for path in ("/livez", "/readyz", "/metrics", "/"):
        replay("get", path, 200)
    replay("get", "/jobs/{job}", 200, {"job": job})


def test_every_code_is_in_the_table():
    """The list of codes and the table for people are the same."""
    schema = DOCUMENT["components"]["schemas"]["ErrorCode"]
    table = re.findall(r"^\| (\w+) \| \d+ \|", schema["description"], re.M)
    assert table == schema["enum"] and len(set(table)) == len(table)


def test_the_documents_own_examples_are_valid():
    schemas = {"Scene": "Scene", "Job": "Job", "Problem": "Problem"}
    for name, example in DOCUMENT["components"]["examples"].items():
        for prefix, schema in schemas.items():
            if name.startswith(prefix):
                validate(example["value"], {"$ref": f"#/components/schemas/{schema}"})
    for path, schema in (("/v1/jobs", "JobRequest"), ("/v1/batches", "BatchRequest")):
        body = OPERATIONS[("post", path)]["requestBody"]["content"]["application/json"]
        for example in body["examples"].values():
            validate(example["value"], {"$ref": f"#/components/schemas/{schema}"})


def test_metrics_are_prometheus_text(api, samples):
    api.wait(api.job(samples["box"]))
    text = api.get("/metrics").text
    types, values = {}, {}
    for line in text.splitlines():
        if line.startswith("# TYPE "):
            _, _, name, kind = line.split(" ")
            assert name not in types, f"{name} is typed twice"
            types[name] = kind
        elif line and not line.startswith("#"):
            match = re.fullmatch(
                r'([a-zA-Z_:][\w:]*)(\{(?:\w+="(?:[^"\\]|\\.)*",?)*\})? ([-+.\deEInfNa]+)', line)
            assert match, f"cannot read: {line}"
            assert match.group(1) + (match.group(2) or "") not in values, line
            values[match.group(1) + (match.group(2) or "")] = float(match.group(3))
    assert values and all(name.startswith(("raykiln_", "process_")) for name in types), types
    for name in types:
        assert any(value.startswith(name) for value in values), f"{name} has no sample"
    assert any(name.endswith("_total") for name in types)
