# Places and messages that tools/setup, tools/run and tools/test share; sourced, never run.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
build=$root/build
venv=$root/.venv

say() { echo "keyway: $*" >&2; }

# Stops with the code for a fault of the system.
fail() {
  say "$*"
  exit 3
}

# A short name for any text.
digest() { printf '%s\n' "$@" | sha256sum | cut -c 1-16; }
