#!/usr/bin/env bash
# Runs a test that is a Python program: in_python.sh TEST.py [MODULE]...
# The exit status is 77 if there is no Python 3.11 or newer with these modules.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../../tools/setup"
test_file=$1
shift
if ! evodevo_find_python "$@"; then
  echo "skipped: there is no Python 3.11 or newer${*:+ with $*; apt-get install python3 ${*/#/python3-}}"
  exit 77
fi
exec "$evodevo_python" "$test_file"
