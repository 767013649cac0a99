#!/usr/bin/env bash
# Runs the README's first command in a clean copy of the working tree, as a new user would. Continuous integration runs
# the second command, tools/test, in a clean clone.
#
#   readme_run.sh SOURCE_FOLDER [BUILD_FOLDER]
#
# With BUILD_FOLDER, the copy uses what tools/test has built there, instead of building it once more.
set -euo pipefail
source=$1 build=${2:-}
if [ -n "$build" ] && [ ! -e "$build/.configured" ]; then
  echo "skipped: $build was not set up by tools/test"
  exit 77
fi
command='tools/evodevo run experiments/quickstart.toml'
grep -qxF "$command" "$source/README.md" || { echo "README.md does not name the command: $command"; exit 1; }

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
copy="$scratch/a (clean) copy & ü"
mkdir "$copy"
# excludes the files named in .gitignore, whose lines have the form /NAME (in the same folder) or NAME (in any folder)
without=(--no-wildcards-match-slash --anchored --exclude=./.git)
while IFS= read -r line; do
  case $line in
    '' | '#'*) ;;
    /*) without+=(--anchored "--exclude=.${line%/}") ;;
    *) without+=(--no-anchored "--exclude=${line%/}") ;;
  esac
done <"$source/.gitignore"
tar -C "$source" "${without[@]}" -cf - . | tar -C "$copy" -xf -

cd "$copy"
unset EVODEVO_PRESET EVODEVO_COMMAND
if [ -n "$build" ]; then
  export EVODEVO_PRESET=${build##*/}
  mkdir build
  ln -s "$build" build/
fi
output=$(bash -c "$command" 2>&1) || { echo "$output"; exit 1; }
echo "$output" | tail -n 8
grep -q '^quickstart on cpu\|^quickstart on cuda' <<<"$output" || { echo "it does not say which device it uses"; exit 1; }
[ -e runs/quickstart-1/run.sqlite ] || { echo "it left no run behind"; exit 1; }

# robots learn to walk, and the run verifies its champion at its end
python3 - <<'END'
import sqlite3
run = sqlite3.connect("runs/quickstart-1/run.sqlite")
best = [row[0] for row in run.execute("SELECT best FROM generations ORDER BY generation")]
assert best[-1] > 1.5 * best[0], f"from {best[0]} to {best[-1]}"
trials = dict(run.execute("SELECT trial, value FROM verifications"))
assert trials["again"] == best[-1], f"the champion is not the same to the bit when it lives again: {trials}"
assert trials["no-muscles"] < 0.2 * best[-1], f"the champion needs no muscles: {trials}"
END

# from now on, nothing needs to be built
started=$(date +%s%N)
shown=$(tools/evodevo show runs/quickstart-1)
grep -qE ', verified($|,)' <<<"$shown" || { echo "the champion falls, or exploits an error: $shown"; exit 1; }
echo "a later call took $((($(date +%s%N) - started) / 1000000)) ms"
