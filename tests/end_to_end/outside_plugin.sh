#!/usr/bin/env bash
# Installs evodevo. Then writes, builds, checks and runs a project with the given operators outside the source tree,
# using only the installed package. The first operator is called my-lab.growth.
#
#   outside_plugin.sh BUILD_FOLDER KIND NAME [KIND NAME]...
set -euo pipefail
build=$(realpath "$1")
shift
operators=("$@")
names=()
for ((i = 1; i < $#; i += 2)); do names+=("${operators[i]}"); done
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export XDG_STATE_HOME=$scratch/state
unset EVODEVO_COMMAND EVODEVO_PLUGIN_PATH

cmake --install "$build" --prefix "$scratch/package" >/dev/null
PATH=$scratch/package/bin:$PATH
# the headers of the SDK must include only the standard library, except the helpers whose pages name what they need
needs='/network_encoding.hpp:#include <Eigen/|/selection/cma_es.hpp:#include <Eigen/|/selection/neighbours.hpp:#include <nanoflann.hpp>'
if grep -rE '^#include' "$scratch/package/include" | grep -vE "<[a-z_0-9]+>|\"evodevo/|/helpers($needs)"; then
  echo "the SDK includes more than the C++ standard library and what its pages name"
  exit 1
fi
for file in man/man1/evodevo.1 bash-completion/completions/evodevo zsh/site-functions/_evodevo \
    fish/vendor_completions.d/evodevo.fish; do
  grep -q conform "$scratch/package/share/$file" || { echo "share/$file is not what the program writes"; exit 1; }
done

cd "$scratch"
evodevo new "${operators[@]}"
cd my-lab.growth
cmake -B build >/dev/null
cmake --build build
ctest --test-dir build --output-on-failure
evodevo run experiment.toml --out run
# does not use a pipe to grep, since grep would close the pipe at the first match
shown=$(evodevo show run --json)
for name in "${names[@]}"; do
  [[ $shown == *"\"name\": \"$name\""* ]] || { echo "the run does not use $name"; exit 1; }
done

# after a change, only one file is compiled
touch growth.cpp
[ "$(cmake --build build | grep -c 'Building')" = 1 ] || { echo "a change of one file builds others"; exit 1; }

table() { sed -n '/^## /,$p' "$1"; }
# README.md has the operators in the order of their kinds
described() {
  sed -n 's/^## `\(.*\)`$/\1/p' README.md | while read -r name; do
    evodevo describe "$name" --markdown --plugin-path build/lib/evodevo >described.md
    table described.md
  done
}
(($(grep -c '^## `' README.md) == ${#names[@]})) || { echo "README.md has not one table for each operator"; exit 1; }
diff <(table README.md) <(described | sed '$d') || { echo "README.md is not what the operators say"; exit 1; }

cmake --install build --prefix "$scratch/package" >/dev/null
available=$(evodevo operators)
for name in "${names[@]}"; do
  [[ $available == *" $name "* ]] || { echo "the installed $name is not found"; exit 1; }
done
