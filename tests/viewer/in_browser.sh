#!/usr/bin/env bash
# Runs a test of the page: in_browser.sh TEST.mjs EVODEVO VIEWER_FOLDER
# The exit status is 77 if a required program is missing.
set -euo pipefail
test_file=$1
export EVODEVO_PROGRAM=$2 EVODEVO_VIEWER=$3
skip() {
  echo "skipped: $1"
  exit 77
}
command -v node >/dev/null || skip "there is no Node.js"
command -v python3 >/dev/null || skip "there is no Python"
[ -e "$EVODEVO_VIEWER/page.html" ] || skip "the target evodevo_viewer has not been built"
find_chromium='import { pathToFileURL } from "node:url";
const { chromiumProgram } = await import(pathToFileURL(process.env.EVODEVO_VIEWER + "/browser.mjs"));
chromiumProgram();'
node --input-type=module --eval "$find_chromium" || skip "there is no Chromium"
exec node --test "$test_file"
