#!/usr/bin/env bash
# Tests that `evodevo report` without a built viewer says so, and how to get the viewer: missing_test.sh EVODEVO
set -euo pipefail
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/bin"
cp "$1" "$scratch/bin/evodevo"
if said=$("$scratch/bin/evodevo" report "$scratch" --out "$scratch/report.html" 2>&1); then
  echo "report did not fail: $said"
  exit 1
fi
for words in "$scratch/share/evodevo/viewer" "apt-get install nodejs npm" "--target evodevo_viewer"; do
  if [[ $said != *"$words"* ]]; then
    echo "\"$words\" is missing in: $said"
    exit 1
  fi
done
[ ! -e "$scratch/report.html" ]
