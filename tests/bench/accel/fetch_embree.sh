#!/bin/bash
# Fetches Embree 4.4 out of the Python wheel embreex into a folder (default: build/embree), for
# bench_embree. Needs python3 with pip. Prints the library's path. The scans of the comparison come
# from fetch_bunny.mjs here and tests/support/fetch_dragon.mjs.
set -euo pipefail
folder=${1:-build/embree}
mkdir -p "$folder"
cd "$folder"
[ -e embreex.libs ] || {
  python3 -m pip download --quiet --no-deps --only-binary :all: embreex==4.4.0.post1
  python3 -m zipfile -e embreex-*.whl .
}
ls "$PWD"/embreex.libs/libembree4-*.so.4
