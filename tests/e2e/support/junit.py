"""JUnit XML as CI systems read it: a schema over the tree of elements."""

import xml.etree.ElementTree as ET

import jsonschema

COUNT = {"type": "string", "pattern": "^[0-9]+$"}
SECONDS = {"type": "string", "pattern": r"^[0-9]+(\.[0-9]+)?(e[-+]?[0-9]+)?$"}
TEXT = {"type": "string", "minLength": 1}


def element(tag, attributes, children=None, text=False):
    return {"type": "object", "properties": {
        "tag": {"const": tag},
        "attributes": {"type": "object", "properties": attributes, "required": list(attributes), "additionalProperties": False},
        "children": children or {"type": "array", "maxItems": 0},
        "text": {"type": "string"} if text else {"type": "string", "pattern": r"^\s*$"}}}


OUTCOME = {"oneOf": [element("failure", {"type": TEXT, "message": TEXT}), element("error", {"type": TEXT, "message": TEXT}),
                     element("skipped", {"message": TEXT})]}
OUTPUT = element("system-out", {}, text=True)
CASE = element("testcase", {"classname": TEXT, "name": TEXT, "time": SECONDS}, {
    "type": "array", "oneOf": [{"prefixItems": [OUTPUT], "minItems": 1, "items": False},
                               {"prefixItems": [OUTCOME, OUTPUT], "minItems": 2, "items": False}]})
SUITE = element("testsuite", {"name": TEXT, "tests": COUNT, "failures": COUNT, "errors": COUNT, "skipped": COUNT, "time": SECONDS},
                {"type": "array", "items": CASE})
SCHEMA = element("testsuites", {}, {"type": "array", "items": SUITE, "minItems": 1})


def tree(node):
    return {"tag": node.tag, "attributes": dict(node.attrib), "children": [tree(child) for child in node],
            "text": (node.text or "") + "".join(child.tail or "" for child in node)}


def read_junit(path):
    """The only suite of a valid file."""
    root = ET.parse(path).getroot()
    jsonschema.Draft202012Validator(SCHEMA).validate(tree(root))
    (suite,) = root
    for tag, key in (("failure", "failures"), ("error", "errors"), ("skipped", "skipped"), (None, "tests")):
        assert int(suite.get(key)) == len(suite.findall(f"testcase/{tag}" if tag else "testcase"))
    return suite
