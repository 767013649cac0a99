#!/usr/bin/env bash
# Runs a test that is a Python program: in_python.sh TEST.py; 77 where there is no Python 3.11 or newer.
set -euo pipefail
if ! python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
  echo "skipped: there is no Python 3.11 or newer"
  exit 77
fi
exec python3 "$1"
