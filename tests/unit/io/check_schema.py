#!/usr/bin/env python3
"""Does proto/scene.schema.json accept and refuse the same sidecars as the reader?

The table tests/support/io/sidecars.json is read by this script and by sidecar_test.cpp. Rows with
"beyond_schema" are refused by the reader for reasons that a schema cannot state.
"""
import json
import pathlib
import sys

import jsonschema

source = pathlib.Path(sys.argv[1])
schema = json.loads((source / "proto/scene.schema.json").read_text())
jsonschema.Draft202012Validator.check_schema(schema)
validator = jsonschema.Draft202012Validator(schema)
rows = json.loads((source / "tests/support/io/sidecars.json").read_text())
rows.append({"name": "demo", "valid": True,
             "document": json.loads((source / "server/app/demo/raykiln.json").read_text())})
wrong = [row["name"] for row in rows
         if validator.is_valid(row["document"]) != (row["valid"] or row.get("beyond_schema", False))]
print(f"{len(rows)} sidecars, {len(wrong)} disagreements")
for name in wrong:
    print("disagreement:", name)
sys.exit(1 if wrong else 0)
