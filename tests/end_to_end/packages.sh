#!/usr/bin/env bash
# Packs the tarball, unpacks it elsewhere, and uses it with an empty environment.
#
#   packages.sh BUILD_FOLDER
set -euo pipefail
build=$(realpath "$1")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fail() {
  echo "$*"
  exit 1
}

cpack --config "$build/CPackConfig.cmake" -G TGZ -B "$scratch/packed" >"$scratch/log" || fail "$(<"$scratch/log")"
mkdir "$scratch/a folder"
tar -C "$scratch/a folder" -xzf "$scratch"/packed/evodevo-*.tar.gz
mv "$scratch/a folder"/evodevo-* "$scratch/a folder/evodevo"
package="$scratch/a folder/evodevo"
evodevo() { env -i HOME="$scratch" PATH=/usr/bin:/bin "$package/bin/evodevo" "$@"; }
cd "$scratch"

# every library is in the package, except the C and the C++ runtime
runtime='linux-vdso|ld-linux|lib(c|m|dl|rt|pthread|gcc_s|stdc\+\+)\.so'
others=$(env -i ldd "$package/bin/evodevo" | grep -vE "$runtime" | grep -vF "/evodevo/bin/../lib/evodevo/libraries/" || true)
[ -z "$others" ] || fail "the package lacks libraries: $others"
[ -d "$package/share/doc/evodevo/licences" ] || ! command -v dpkg-query >/dev/null || fail "there are no licences"

version=$(evodevo --version)
diff <("$build/bin/evodevo" --version) <(echo "$version") || fail "the version differs"
[[ $(evodevo operators) == *" spring-turnover "* ]] || fail "there are no operators"
for experiment in "$package"/share/evodevo/experiments/*.toml; do evodevo check "$experiment" >/dev/null; done
evodevo run "$package/share/evodevo/experiments/quickstart.toml" --out run --set experiment.evaluations=20 \
  --set experiment.population=10 --set development.cycle_time=0.1 --set fitness.0.settle=0 --set fitness.0.window=0.2
[ ! -e "$build/share/evodevo/viewer/page.html" ] || [ -s run/report.html ] || fail "the run has no page"

# the Debian package has the Python package where Debian's Python looks, and the module finds its operators there
module=("$build"/lib/python3.*/site-packages/evodevo)
[ -d "${module[0]}" ] && command -v dpkg-shlibdeps >/dev/null && /usr/bin/python3 -c "import numpy, pandas" 2>/dev/null || exit 0
cpack --config "$build/CPackConfig.cmake" -G DEB -B "$scratch/debian" >"$scratch/log" || fail "$(<"$scratch/log")"
dpkg-deb -x "$scratch"/debian/evodevo*.deb "$scratch/root"
env -i PYTHONPATH="$scratch/root/usr/lib/python3/dist-packages" /usr/bin/python3 -c \
  "import sys; from evodevo import core; core.Experiment(sys.argv[1])" \
  "$scratch/root/usr/share/evodevo/experiments/quickstart.toml" || fail "the Debian package's Python package does not work"
