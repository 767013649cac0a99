#!/usr/bin/env bash
# Installs evodevo. Then writes, builds, checks and runs a plugin of the given kind outside the source tree, using only
# the installed package.
#
#   outside_plugin.sh BUILD_FOLDER KIND
set -euo pipefail
build=$(realpath "$1") kind=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export XDG_STATE_HOME=$scratch/state
unset EVODEVO_COMMAND EVODEVO_PLUGIN_PATH

cmake --install "$build" --prefix "$scratch/package" >/dev/null
PATH=$scratch/package/bin:$PATH
# the headers of the SDK must include only the standard library; one helper needs Eigen
if grep -rE '^#include' "$scratch/package/include" |
    grep -vE '<[a-z_0-9]+>|"evodevo/|/helpers/network_encoding.hpp:#include <Eigen/Core>'; then
  echo "the SDK includes more than the C++ standard library"
  exit 1
fi
for file in man/man1/evodevo.1 bash-completion/completions/evodevo zsh/site-functions/_evodevo \
    fish/vendor_completions.d/evodevo.fish; do
  grep -q conform "$scratch/package/share/$file" || { echo "share/$file is not what the program writes"; exit 1; }
done

cd "$scratch"
evodevo new "$kind" my-lab.growth
cd my-lab.growth
cmake -B build >/dev/null
cmake --build build
ctest --test-dir build --output-on-failure
evodevo run experiment.toml --out run
# does not use a pipe to grep, since grep would close the pipe at the first match
[[ $(evodevo show run --json) == *'"my-lab.growth"'* ]] || { echo "the run does not use the operator"; exit 1; }

# after a change, only one file is compiled
touch growth.cpp
[ "$(cmake --build build | grep -c 'Building')" = 1 ] || { echo "a change of one file builds others"; exit 1; }

table() { sed -n '/^## /,$p' "$1"; }
evodevo describe my-lab.growth --markdown --plugin-path build/lib/evodevo >described.md
diff <(table README.md) <(table described.md | sed '$d') || { echo "README.md is not what the operator says"; exit 1; }

cmake --install build --prefix "$scratch/package" >/dev/null
[[ $(evodevo operators) == *my-lab.growth* ]] || { echo "the installed plugin is not found"; exit 1; }
