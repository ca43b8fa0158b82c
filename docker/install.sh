#!/bin/bash
# Installs the Debian packages named in docker/packages/SET.txt for each SET given.
# The one place where packages are installed: ./run, tests/run and the Dockerfile call it.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: docker/install.sh [--check] SET...
  SET      build, run, test or peer: the lists in docker/packages/
  --check  install nothing; name what is missing and exit 1 if there is any
exit: 0 everything is there, 1 something could not be installed, 2 wrong usage
TEXT
}

fail() {
  echo "docker/install.sh: $*" >&2
  exit 1
}

lists="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/packages"
check_only=0
sets=()
for word in "$@"; do
  case "$word" in
    --check) check_only=1 ;;
    -h | --help) usage; exit 0 ;;
    build | run | test | peer) sets+=("$word") ;;
    *) echo "docker/install.sh: unknown set '$word'" >&2; usage >&2; exit 2 ;;
  esac
done
if [ ${#sets[@]} -eq 0 ]; then usage >&2; exit 2; fi

# The names in the lists that apply to this machine.
wanted=()
for set in "${sets[@]}"; do
  while read -r name condition; do
    case "$name" in '' | '#'*) continue ;; esac
    case "$condition" in
      '') wanted+=("$name") ;;
      unless:*) command -v "${condition#unless:}" >/dev/null || wanted+=("$name") ;;
      *) fail "packages/$set.txt: cannot read '$condition' after $name" ;;
    esac
  done <"$lists/$set.txt"
done

# Sets `missing` to the wanted packages that dpkg does not report as installed.
find_missing() {
  command -v dpkg-query >/dev/null ||
    fail "this is not Debian; install what docker/packages/ lists and pass --no-install"
  local installed
  # dpkg-query fails when any name is unknown and still prints the others.
  installed=$(dpkg-query -W -f '${db:Status-Abbrev}|${Package}\n' "${wanted[@]}" 2>/dev/null || true)
  missing=()
  for name in "${wanted[@]}"; do
    grep -q "^.i |$name\$" <<<"$installed" || missing+=("$name")
  done
}

find_missing
if [ ${#missing[@]} -eq 0 ]; then exit 0; fi
echo "docker/install.sh: missing: ${missing[*]}" >&2
if [ "$check_only" = 1 ]; then exit 1; fi

as_root=()
if [ "$(id -u)" != 0 ]; then
  command -v sudo >/dev/null || fail "neither root nor sudo; as root: apt-get install ${missing[*]}"
  as_root=(sudo)
fi
apt() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get \
    -o Acquire::Retries=3 -o DPkg::Lock::Timeout=300 "$@"
}

has_candidate() {
  local policy
  policy=$(apt-cache policy "$1" 2>/dev/null || true)
  grep -q 'Candidate: [^(]' <<<"$policy"
}

update_if_unknown() {
  local name
  for name in "${missing[@]}"; do
    if ! has_candidate "$name"; then apt update; return; fi
  done
}

update_if_unknown || true
for name in "${missing[@]}"; do
  has_candidate "$name" ||
    fail "no package '$name' in the configured sources (Debian 12 'main' is expected)"
done
for attempt in 1 2 3; do
  apt install -y --no-install-recommends "${missing[@]}" && break
  echo "docker/install.sh: attempt $attempt failed; refreshing the package lists" >&2
  # An old list names files the mirror no longer has; a fresh one cures that.
  sleep "$((attempt * 2))"
  apt update || true
done
find_missing
[ ${#missing[@]} -eq 0 ] || fail "could not install: ${missing[*]}"
