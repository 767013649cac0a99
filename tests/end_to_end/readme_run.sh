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

# from now on, nothing needs to be built
started=$(date +%s%N)
tools/evodevo show runs/quickstart-1 >/dev/null
echo "a later call took $((($(date +%s%N) - started) / 1000000)) ms"
