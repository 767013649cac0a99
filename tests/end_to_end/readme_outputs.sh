#!/usr/bin/env bash
# Tests that the files written by the examples of all pages do not show up in `git status`:
# readme_outputs.sh SOURCE_FOLDER
set -euo pipefail
source=$1
if ! command -v git >/dev/null; then
  echo "skipped: there is no git"
  exit 77
fi
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# Finds output files in commands: words after --out, --trajectory, --svg or >, the first or last word of a tool if it names a
# file or folder, and the folders of new plugins, one of which also contains walk.toml.
pages=$(find "$source" -name '*.md' -not -path "$source/build/*" -not -path '*/template/*' -not -path '*/node_modules/*')
commands=$(while IFS= read -r page; do sed -n '/^```sh$/,/^```$/p' "$page"; done <<<"$pages" | sed 's/ *#.*//')
outputs=$(sed -nE -e 's/.*(--out|--trajectory|--svg|>) ([^ ]+).*/\2/p' -e 's/^tools\/figure .* ([^ ]+)$/\1/p' \
  -e 's/^tools\/(stress|accuracy) ([^ -][^ ]*).*/\2\/data.csv/p' -e 's/.*evodevo new [a-z]+ ([^ ]+).*/\1\/CMakeLists.txt/p' \
  -e 's/^tools\/evodevo run .*/runs\/some-1\/run.sqlite/p' -e 's/^tools\/compare .*/runs\/compare-some\/report.md/p' \
  -e 's/^tools\/tune .*/runs\/tune-some\/report.md/p' \
  <<<"$commands" | sed 's/^walk\./my-lab.growth\/&/' | sort -u)
[ "$(wc -l <<<"$outputs")" -ge 12 ] || { echo "pages have fewer outputs than they had: $outputs"; exit 1; }

git init -q "$scratch"
cp "$source/.gitignore" "$scratch"
cd "$scratch"
while IFS= read -r output; do
  [[ $output != /* && $output != *..* ]] || { echo "$output lies elsewhere"; exit 1; }
  [[ $output == *.* ]] || output=$output/run.sqlite  # the folder of a run
  mkdir -p "$(dirname "$output")"
  touch "$output"
done <<<"$outputs"
status=$(git status --porcelain)
[ "$status" = '?? .gitignore' ] || { printf '%s\n' "git status shows what examples write:" "$status"; exit 1; }
