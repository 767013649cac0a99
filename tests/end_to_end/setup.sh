#!/usr/bin/env bash
# Tests what the scripts in tools/ install, configure and build, and their messages on failure. Stand-ins replace
# apt-get, CMake and other programs, so that nothing is installed and no network is used.
#
#   setup.sh SOURCE_FOLDER EVODEVO_PROGRAM CASE
set -euo pipefail
source=$1 program=$(realpath "$2") case=$3
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
unset EVODEVO_COMMAND EVODEVO_CHROMIUM
export EVODEVO_PRESET=cpu

# a checkout with only the files that the setup reads
checkout="$scratch/a (b) & ü"
mkdir -p "$checkout/framework" "$scratch/bin"
cp -r "$source/tools" "$checkout"
cp "$source/CMakeLists.txt" "$checkout"
cp "$source/framework/help.txt" "$checkout/framework"

# PATH contains only the programs that the scripts use, and the stand-ins
for name in bash env sh cat chmod dirname flock grep ln mkdir readlink rm sed awk touch tr; do
  ln -s "$(command -v $name)" "$scratch/bin/$name"
done
called=$scratch/called installed=$scratch/installed
touch "$called" "$installed"
stand_in() {  # NAME   reads the text of the stand-in from standard input
  {
    printf '#!/usr/bin/env bash\ncheckout=%q scratch=%q\n' "$checkout" "$scratch"
    echo 'echo "${0##*/} $*" >>"$scratch/called"'
    cat
  } >"$scratch/bin/$1"
  chmod +x "$scratch/bin/$1"
}
stand_in id <<<'echo 0'
stand_in sleep <<<''
stand_in nproc <<<'echo 2'
stand_in dpkg-query <<<'grep -qx "${!#}" "$scratch/installed" && echo "install ok installed"'
stand_in apt-get <<'END'
for folder in /proc/self/fd/*; do
  [[ $(readlink "$folder") != */.setup-lock ]] || echo "apt-get holds the lock of the build" >>"$scratch/called"
done
installing=
for word in "$@"; do
  [ "$word" != install ] || installing=1
  [[ -z $installing || $word = -* || $word = install ]] || echo "$word" >>"$scratch/installed"
done
[[ $installing != 1 || " $* " != *" npm "* ]] || ln -sf "$scratch/bin/id" "$scratch/bin/npm"
END
stand_in cmake <<'END'
case $1 in
  --preset)
    mkdir -p "$checkout/build/$2"
    for word in "$@"; do
      [[ $word != EVODEVO_TESTS=* ]] || echo "EVODEVO_TESTS:BOOL=${word#*=}" >"$checkout/build/$2/CMakeCache.txt"
    done
    ;;
  --build)
    mkdir -p "$2/bin"
    for name in evodevo evodevo-bench evodevo-accuracy evodevo-stress; do
      printf '#!/bin/sh\necho "%s $*"\n' $name >"$2/bin/$name"
      chmod +x "$2/bin/$name"
    done
    ;;
esac
END
stand_in ninja <<<'[ ! -e "$2/bin/evodevo" ] || echo "ninja: no work to do."'
# a stand-in for Python that has the modules whose packages are marked as installed
stand_in python3 <<'END'
echo "modules from $PYTHONPATH" >>"$scratch/called"
if [ "$2" = -c ]; then
  for module in "${@:4}"; do grep -qx "python3-$module" "$scratch/installed" || exit 1; done
else
  echo "python3 $*"
fi
END
stand_in ctest <<<''

# call COMMAND...   runs it in the checkout; $said holds both output streams, $output only the standard output
call() {
  status=0
  output=$(cd "$checkout" && PATH=$scratch/bin "$@" 2>"$scratch/errors") || status=$?
  errors=$(cat "$scratch/errors")
}
fail() {
  printf '%s\n' "$1" "exit status $status" "standard output:" "$output" "standard error:" "$errors" "calls:" "$(cat "$called")"
  exit 1
}
# does COMMAND..., prints TEXT COMMAND...   call it and expect success
does() {
  call "$@"
  [ "$status" = 0 ] || fail "it failed"
}
prints() {
  does "${@:2}"
  [ "$output" = "$1" ] || fail "it does not print: $1"
}
# fails_in_a_line COMMAND WORDS...   expects a failure with a one-line error message; only messages about installations
# may precede it
fails_in_a_line() {
  call $1
  [ "$status" = 1 ] || fail "the exit status is not 1"
  local line words
  line=$(grep -v '^evodevo: installing [a-z+0-9 -]*$' "$scratch/errors")
  [[ $(wc -l <<<"$line") = 1 && $line == evodevo:* ]] || fail "this is not one line"
  for words in "${@:2}"; do [[ $line == *"$words"* ]] || fail "\"$words\" is missing"; done
}
has() { for package; do grep -qx -- "$package" "$installed" || fail "$package is not installed"; done; }
has_not() { for package; do ! grep -qx -- "$package" "$installed" || fail "$package is installed"; done; }
times() { grep -c -- "$1" "$called" || true; }

case_help() {
  EVODEVO_COMMAND=tools/evodevo "$program" --help >"$scratch/help"
  for asked in --help help; do
    does tools/evodevo $asked
    diff "$scratch/help" <(echo "$output") || fail "framework/help.txt is not what the program prints; write it anew:
$(EVODEVO_COMMAND=@PROGRAM@ "$program" --help | sed "1s/$("$program" --version | sed -n '1s/.* //p')/@VERSION@/")"
  done
  call "$checkout/tools/evodevo" --help
  [[ $output == *"  $(printf %q "$checkout/tools/evodevo") run "* ]] || fail "the command cannot be pasted"
  call tools/evodevo --version
  [ "$output" = "$("$program" --version | head -1)" ] || fail "the version is another than that of the program"
  call tools/evodevo
  [ "$status" = 2 ] && [ "$errors" = "$(cat "$scratch/help")" ] || fail "without arguments it does not show the help"
  for asked in "film --help" "help film" "help experiment"; do
    does tools/evodevo $asked
    [[ $output == "$(cat "$scratch/help")" && $errors == *"tools/evodevo operators"* ]] || fail "it does not say how to know more"
  done
  [ ! -s "$called" ] && [ ! -e "$checkout/build" ] || fail "asking for help sets something up"
  call tools/evodevo operators
  call tools/evodevo film --help
  [ "$output" = "evodevo film --help" ] && has_not chromium || fail "what is built is not asked"
}

case_tool_help() {
  local name
  for name in bench accuracy stress release; do
    does tools/$name --help
    [[ $output == "tools/$name "*"  tools/$name "* ]] || fail "there is no page with an example"
  done
  does tools/test --help
  [[ $output == *"CTest"* ]] || fail "it does not say what it does with arguments"
  for name in compare tune figure; do
    prints "python3 -P -m $name --help" tools/$name --help
  done
  [ "$(times '^apt-get\|^cmake')" = 0 ] && [ ! -e "$checkout/build" ] || fail "asking for help sets something up"
}

case_charts() {
  call tools/evodevo run some.toml
  prints "evodevo-bench --runs 1" tools/bench --runs 1
  has_not python3 python3-matplotlib python3-scipy
  prints "python3 -P -m figure some.json out.svg" tools/figure some.json out.svg
  PYTHONPATH=/elsewhere call tools/figure some.json out.svg
  [[ $(tail -n 1 "$called") = "modules from $checkout/tools/parts:/elsewhere" ]] || fail "the user's modules are hidden"
  has python3-matplotlib
  has_not python3-scipy
  does tools/compare some.toml
  has python3-scipy
  : >"$called"
  does tools/stress charts --quick
  [ "$output" = "$(printf '%s\n' "evodevo-stress charts --quick" "python3 -P -m stress.draw charts")" ] ||
    fail "it does not draw what it measured"
  [ "$(times ^apt-get)" = 0 ] || fail "it installs what is installed"
}

case_no_charts() {
  local name
  stand_in id <<<'echo 1000'
  for name in compare tune figure parts/accuracy/draw parts/stress/draw; do
    fails_in_a_line "tools/$name some other.svg" "needs root" "apt-get install python3 python3-matplotlib"
  done
  stand_in id <<<'echo 0'
  stand_in apt-get <<<"echo \"E: Failed to fetch http://deb.debian.org/p.deb  Temporary failure resolving 'deb.debian.org'\"; exit 100"
  fails_in_a_line "tools/compare some.toml" "resolving 'deb.debian.org'"
  rm "$scratch/bin/apt-get" "$scratch/bin/dpkg-query"
  fails_in_a_line "tools/compare some.toml" "there is no apt-get" "python3-matplotlib python3-scipy"
  # the results of the measurements, which take a long time, are written nevertheless
  does tools/accuracy charts --quick
  [[ $output = "evodevo-accuracy charts --quick" && $errors == *"data without charts: "*"python3-matplotlib"* ]] ||
    fail "it does not measure without charts"
}

case_packages() {
  prints "evodevo operators" tools/evodevo operators
  has g++ cmake make ninja-build libhwy-dev
  has_not libgtest-dev libgmock-dev python3 pybind11-dev nodejs npm ffmpeg chromium
  : >"$called"
  call tools/evodevo run some.toml
  [ "$(times '^apt-get\|^cmake')" = 0 ] || fail "it sets up what is set up"
  does tools/evodevo report runs/some-1
  has npm
  has_not libgtest-dev ffmpeg chromium
  grep -q '^ID=ubuntu' /etc/os-release || {
    call tools/evodevo film runs/some-1
    has ffmpeg chromium libegl1
    has_not libgtest-dev
  }
  [[ $(cat "$called") != *"holds the lock"* ]] || fail "what is installed could hold the lock for good"
}

case_page_of_the_first_run() {
  prints "evodevo run some.toml" tools/evodevo run some.toml
  has g++ nodejs npm
  has_not libgtest-dev ffmpeg chromium
  grep -q '^ninja .* evodevo_viewer$' "$called" || fail "it does not build the viewer"
  : >"$called"
  call tools/evodevo run some.toml
  [ "$(times '^apt-get\|^cmake')" = 0 ] || fail "it sets up what is set up"
}

case_tests() {
  call tools/evodevo operators
  [ "$(times 'EVODEVO_TESTS=OFF')" = 1 ] || fail "a command has the tests configured"
  does tools/test -R some
  has libgtest-dev libgmock-dev python3 pybind11-dev python3-dev python3-matplotlib python3-scipy python3-pandas
  [ "$(times 'EVODEVO_TESTS=ON')" = 1 ] || fail "the tests are not configured"
  grep -q '^ctest .*-R some' "$called" || fail "no test is run"
  call tools/test
  call tools/evodevo operators
  [ "$(times '^cmake --preset')" = 2 ] || fail "it is configured again and again"
}

case_no_module() {
  stand_in apt-get <<'END'
[[ " $* " != *" pybind11-dev "* ]] || { echo "E: Unable to locate package pybind11-dev"; exit 100; }
END
  does tools/test -R some
  [[ $errors == *"no compiled Python module"*"Unable to locate package pybind11-dev"* ]] || fail "it does not say why"
  grep -q '^ctest .*-R some' "$called" || fail "no test is run"
  printf '%s\n' pybind11-dev python3-dev >>"$installed"
  call tools/evodevo operators
  call tools/evodevo operators
  [ "$(times '^cmake --preset')" = 2 ] || fail "it is not configured once more for the packages that are there now"
}

case_held_locks() {
  for lock in lists/lock /var/cache/apt/archives/lock; do
    stand_in apt-get <<END
[ "\$(grep -c '^apt-get' "\$scratch/called")" -gt 3 ] || { echo "E: Could not get lock $lock. It is held by process 5 (apt)"; exit 100; }
END
    rm -rf "$checkout/build"
    : >"$called"
    does tools/evodevo operators
    [ "$(times ^sleep)" = 3 ] && [ "$(grep -c waiting <<<"$errors")" = 1 ] || fail "it does not wait, or does not say so once"
  done
  grep -q '^apt-get.* DPkg::Lock::Timeout=[1-9].* install' "$called" || fail "apt-get does not wait for dpkg's lock"
  stand_in apt-get <<<'echo "E: Could not get lock /lists/lock. It is held by process 5 (apt)"; exit 100'
  rm -rf "$checkout/build"
  call tools/evodevo operators
  [[ $status = 1 && $errors == *"held by process 5"* ]] || fail "it does not say who holds the lock for ever"
}

case_no_network() {
  stand_in apt-get <<'END'
echo "W: Failed to fetch http://deb.debian.org/debian/dists/bookworm/InRelease  Temporary failure resolving 'deb.debian.org'"
[[ " $* " == *" update "* ]] || { for i in {1..95}; do echo "E: Unable to locate package some-$i"; done; exit 100; }
END
  fails_in_a_line "tools/evodevo operators" "resolving 'deb.debian.org'" "$checkout/build/.apt-log"
  [ "$(grep -c some- "$checkout/build/.apt-log")" = 95 ] || fail "the log has not all"
  fails_in_a_line "tools/test" "resolving 'deb.debian.org'"
}

case_no_viewer_without_network() {
  call tools/evodevo operators
  stand_in apt-get <<<"echo \"E: Failed to fetch http://deb.debian.org/n.deb  Temporary failure resolving 'deb.debian.org'\"; exit 100"
  does tools/evodevo report runs/some-1
  [[ $(grep -vc 'installing nodejs npm' <<<"$errors") = 1 && $errors == *"the viewer is left out"*"resolving 'deb.debian.org'"* ]] ||
    fail "it does not say in a line why there is no viewer"
}

case_no_root() {
  stand_in id <<<'echo 1000'
  fails_in_a_line "tools/evodevo operators" "needs root" "apt-get install g++"
  fails_in_a_line "tools/test" "needs root" "libgtest-dev"
  stand_in sudo <<<'echo "sudo: a password is required" >&2; exit 1'
  fails_in_a_line "tools/evodevo operators" "sudo: a password is required"
  stand_in sudo <<<'exec "$@"'
  does tools/evodevo operators
  has g++
}

case_no_apt() {
  rm "$scratch/bin/apt-get" "$scratch/bin/dpkg-query"
  does tools/evodevo operators
  rm -r "$checkout/build"
  stand_in cmake <<'END'
printf '%s\n' '-- Found Threads: TRUE' 'CMake Error at CMakeLists.txt:37 (find_package):' '  By not providing "Findhwy.cmake"' \
  '  CMake did not find one.' '' '  Could not find a package configuration file' '' 'CMake Error at other.txt:1:' >&2
exit 1
END
  fails_in_a_line "tools/evodevo operators" 'CMakeLists.txt:37' 'By not providing "Findhwy.cmake" CMake did not find one.' 'libhwy-dev' \
    "$checkout/build/cpu/.setup-log"
  rm "$scratch/bin/cmake"
  fails_in_a_line "tools/evodevo operators" "there is no apt-get" "libhwy-dev"
  fails_in_a_line "tools/test" "there is no apt-get" "libgtest-dev"
}

case_unusable_cuda() {
  unset EVODEVO_PRESET
  stand_in nvcc <<<''
  stand_in cmake <<'END'
[ "$2" != cuda ] || { printf '%s\n' 'CMake Error at CMakeLists.txt:48 (message):' '  no CUDA toolkit of version 12.8' '' ''; exit 1; }
mkdir -p "$2/bin" && printf '#!/bin/sh\necho "$0"\n' >"$2/bin/evodevo" && chmod +x "$2/bin/evodevo"
END
  does tools/evodevo operators
  [[ $output == */build/cpu/bin/evodevo ]] || fail "it does not go on without CUDA"
  [ "$(grep -c 'no CUDA toolkit of version 12.8' <<<"$errors")" = 1 ] || fail "it does not say why"
  call tools/evodevo operators
  [ -z "$errors" ] || fail "it says it again and again"
}

case_paths() {
  local mark
  for mark in '[' ']' ';' '$' '"' '\' '#' ',' '|' '<' '>' '*' '?' "'" '`' ':' $'\n'; do
    mv "$checkout" "$scratch/a${mark}b"
    checkout=$scratch/a${mark}b
    fails_in_a_line "tools/evodevo operators" "$(printf %q "$checkout")" "move it"
    [ "$(times '^apt-get\|^cmake')" = 0 ] || fail "it sets something up first"
  done
}

case_two_at_once() {
  mkfifo "$scratch/building" "$scratch/go" "$scratch/second"
  stand_in cmake <<'END'
[ "$1" = --build ] || exit 0
echo >"$scratch/building"
read -r <"$scratch/go"
mkdir -p "$2/bin"
printf '#!/bin/sh\necho "evodevo $*"\n' >"$2/bin/evodevo"
chmod +x "$2/bin/evodevo"
END
  cd "$checkout"
  PATH=$scratch/bin tools/evodevo operators >"$scratch/first-output" 2>"$scratch/errors" &
  local first=$!
  read -r <"$scratch/building"
  PATH=$scratch/bin tools/evodevo check some.toml 2>"$scratch/second" >"$scratch/second-output" &
  local second=$! line
  read -r line <"$scratch/second"
  echo >"$scratch/go"
  status=0 output= errors=$line
  wait $first && wait $second || fail "one of them failed"
  [[ $line == *waiting* ]] || fail "the second does not say that it waits"
  [ "$(times '^cmake --build')" = 1 ] || fail "both build"
  [ "$(cat "$scratch/first-output" "$scratch/second-output")" = "$(printf '%s\n' "evodevo operators" "evodevo check some.toml")" ] ||
    fail "they do not both run"
}

"case_$case"
