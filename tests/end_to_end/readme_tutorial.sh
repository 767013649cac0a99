#!/usr/bin/env bash
# Runs the commands of the README's section "Ten minutes to an operator of your own", starting with the installation of
# evodevo. The tests ReadmeRun.built and ReadmeRun.clean cover the preceding commands.
#
#   readme_tutorial.sh SOURCE_FOLDER BUILD_FOLDER
set -euo pipefail
source=$1 build=$(realpath "$2")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export XDG_STATE_HOME=$scratch/state HOME=$scratch/home
unset EVODEVO_COMMAND EVODEVO_PLUGIN_PATH
mkdir "$HOME" "$scratch/build"
# the README calls the build folder build/cpu
ln -s "$build" "$scratch/build/cpu"
ln -s "$source/experiments" "$scratch/experiments"

section=$(sed -n '/^## Ten minutes/,/^## Compose/p' "$source/README.md")
commands=$(sed -n '/^```sh$/,/^```$/p' <<<"$section" | grep -v '^```')
commands=${commands#*report.html$'\n'}
grep -q '^cmake --install' <<<"${commands%%$'\n'*}" || { echo "README.md does not go on with the installation: $commands"; exit 1; }
sed -n '/^```cpp$/,/^```$/p' <<<"$section" | grep -v '^```' >"$scratch/loop"
if [ ! -d "$build/share/evodevo/viewer" ]; then
  echo "without the page, which is not built here"
  commands=$(grep -v '^evodevo report' <<<"$commands")$'\n'
fi

# before the second build, replaces the loop of the template with that of the README
change='sed -i -e "/^    for (.*springs_/{r $scratch/loop" -e "d}" growth.cpp'
commands=${commands/$'\n'cmake --build build$'\n'/$'\n'"$change"$'\n'cmake --build build$'\n'}
# 40 evaluations are enough to see that the run uses the operator
fewer="sed -i 's/^evaluations = .*/evaluations = 40/; s/^population = .*/population = 20/' walk.toml"
commands=${commands/$'\n'evodevo run walk.toml$'\n'/$'\n'"$fewer"$'\n'evodevo run walk.toml$'\n'}
grep -qF 'evaluations = 40' <<<"$commands" || { echo "README.md does not run walk.toml: $commands"; exit 1; }
grep -qF 'sed -i -e' <<<"$commands" || { echo "README.md does not build the operator again"; exit 1; }
cd "$scratch"
set -x
eval "$commands"
set +x

[[ $PWD == */my-lab.growth ]] || { echo "the operator is not where the page says"; exit 1; }
diff <(sed -n '/^    for/,/^    }/p' growth.cpp) "$scratch/loop" || { echo "the operator is not the page's"; exit 1; }
[[ $(evodevo show runs/walk-1 --json) == *'"my-lab.growth"'* ]] ||
  { echo "the run does not use the operator"; exit 1; }
removed=$(evodevo life runs/walk-1)
[[ $removed == *"my-lab.growth: "*" gone"* ]] || { echo "the operator has removed nothing: $removed"; exit 1; }
[ ! -d "$build/share/evodevo/viewer" ] || [ -s walk.html ] || { echo "there is no page"; exit 1; }
