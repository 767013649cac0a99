#!/usr/bin/env bash
# What the examples of README.md write beside it leaves `git status` as it was: readme_outputs.sh SOURCE_FOLDER
set -euo pipefail
source=$1
if ! command -v git >/dev/null; then
  echo "skipped: there is no git"
  exit 77
fi
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# in commands: what follows --out or >, a tool's first or last word that names a file or a folder, a new plugin
commands=$(sed -n '/^```sh$/,/^```$/p' "$source/README.md" | sed 's/ *#.*//')
outputs=$(sed -nE -e 's/.*(--out|>) ([^ ]+).*/\2/p' -e 's/^tools\/figure .* ([^ ]+)$/\1/p' \
  -e 's/^tools\/stress ([^ ]+).*/\1\/data.csv/p' -e 's/.*evodevo new [a-z]+ ([^ ]+).*/\1\/CMakeLists.txt/p' \
  -e 's/^tools\/evodevo run .*/runs\/some-1\/run.sqlite/p' -e 's/^tools\/compare .*/runs\/compare-some\/report.md/p' \
  <<<"$commands")
[ "$(wc -l <<<"$outputs")" -ge 10 ] || { echo "README.md has fewer outputs than it had: $outputs"; exit 1; }

git init -q "$scratch"
cp "$source/.gitignore" "$scratch"
cd "$scratch"
while IFS= read -r output; do
  [[ $output != /* && $output != *..* ]] || { echo "$output lies elsewhere"; exit 1; }
  mkdir -p "$(dirname "$output")"
  touch "$output"
done <<<"$outputs"
status=$(git status --porcelain)
[ "$status" = '?? .gitignore' ] || { printf '%s\n' "git status shows what examples write:" "$status"; exit 1; }
