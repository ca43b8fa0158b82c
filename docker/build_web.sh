#!/bin/bash
# Builds the page: web/ -> web/dist. Fetches npm packages only when the lock file
# changed and builds only when a source did; a second call takes a moment.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../web"

digest_of_sources() {
  find . \( -name node_modules -o -name dist \) -prune -o -type f -print0 |
    sort -z | xargs -0 sha256sum | sha256sum | cut -d' ' -f1
}

lock=$(sha256sum package-lock.json | cut -d' ' -f1)
if [ "$(cat node_modules/.raykiln-lock 2>/dev/null)" != "$lock" ]; then
  for attempt in 1 2 3; do
    if PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD=1 npm ci --no-audit --no-fund; then break; fi
    if [ "$attempt" = 3 ]; then
      echo "docker/build_web.sh: npm ci failed three times; is the npm registry reachable?" >&2
      exit 1
    fi
    sleep "$((attempt * 3))"
  done
  echo "$lock" >node_modules/.raykiln-lock
fi

sources=$(digest_of_sources)
if [ ! -f dist/index.html ] || [ "$(cat node_modules/.raykiln-sources 2>/dev/null)" != "$sources" ]; then
  npm run --silent build
  [ -f dist/index.html ] || { echo "docker/build_web.sh: the build left no dist/index.html" >&2; exit 1; }
  digest_of_sources >node_modules/.raykiln-sources
fi
