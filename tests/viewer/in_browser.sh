#!/usr/bin/env bash
# Runs a test of the page: in_browser.sh TEST.mjs EVODEVO VIEWER_FOLDER; 77 where something is missing.
set -euo pipefail
test_file=$1
export EVODEVO_PROGRAM=$2 EVODEVO_VIEWER=$3
skip() {
  echo "skipped: $1"
  exit 77
}
command -v node >/dev/null || skip "there is no Node.js"
EVODEVO_CHROMIUM=${EVODEVO_CHROMIUM:-$(command -v chromium || true)}
[ -n "$EVODEVO_CHROMIUM" ] || skip "there is no chromium"
export EVODEVO_CHROMIUM
[ -e "$EVODEVO_VIEWER/page.html" ] || skip "the target evodevo_viewer has not been built"
exec node --test "$test_file"
