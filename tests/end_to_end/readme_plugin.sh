#!/usr/bin/env bash
# Builds the plugin of "Writing an operator" with the compiler command given there, and runs it in the first experiment
# of experiments/README.md.
#
#   readme_plugin.sh SOURCE_FOLDER EVODEVO_PROGRAM
set -euo pipefail
source=$1 evodevo=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export XDG_STATE_HOME=$scratch/state

page=$source/framework/sdk/README.md
# prints the first code block of a language
block() { awk -v opens="\`\`\`$1" '$0 == "```" && inside { exit } inside; $0 == opens { inside = 1 }' "$2"; }
mkdir "$scratch/my-plugins"
block cpp "$page" >"$scratch/erosion.cpp"
block toml "$source/experiments/README.md" >"$scratch/experiment.toml"
compile=$(grep '^g++ .*erosion' "$page")
printf -v includes -- '-I%q -I%q' "$source/framework/sdk" "$source/kernels/include"
compile=${compile//-I ~\/evodevo\/include/"$includes"}
cd "$scratch"
[ "$(wc -l <erosion.cpp)" -lt 30 ] || { echo "the smallest operator has 30 lines or more"; exit 1; }
eval "$compile"

"$evodevo" conform my-plugins/erosion.evodevo.so
"$evodevo" check experiment.toml
"$evodevo" run experiment.toml --out run --set experiment.evaluations=4 --set experiment.population=4 \
  --set development.operator.0.name=erosion --set development.cycle_time=0.1 --set fitness.0.settle=0 \
  --set fitness.0.window=0.1
"$evodevo" body run >born.json
"$evodevo" body run --matured >matured.json
springs() { grep -c rest_length "$1"; }
lost=$(($(springs born.json) - $(springs matured.json)))
# there are four cycles, each of which removes at most eight springs
[ "$lost" -gt 0 ] && [ "$lost" -le 32 ] || { echo "$lost springs went"; exit 1; }
