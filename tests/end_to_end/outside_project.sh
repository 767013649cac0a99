#!/usr/bin/env bash
# Installs evodevo and builds the operators of outside_project/ against the installed package alone. Checks them, and
# runs experiments with them twice: once without interruption, and once killed, moved and resumed. Both runs must have
# the same rows, and a selection operator must remember the same bytes.
#
#   outside_project.sh BUILD_FOLDER
set -euo pipefail
command -v python3 >/dev/null || { echo "skipped: there is no python3"; exit 77; }
build=$(realpath "$1")
source=$(dirname "$(realpath "${BASH_SOURCE[0]}")")/outside_project
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export XDG_STATE_HOME=$scratch/state
unset EVODEVO_COMMAND EVODEVO_PLUGIN_PATH

fail() {
  echo "$*"
  exit 1
}

# an operator needs no cast that reinterprets, no environment and no state; constants are no state
casts='(reinterpret|const|dynamic)_cast|\((const )?([\w:]+ ?[*&]+|char|int|float|double|unsigned|(std::)?u?int\d+_t)\) ?(?!const|override)[a-z(]'
static='^ *static (?!const)[^(]*[;={]'
globals='^(?!namespace )[a-z][\w:<>]* \w+ ?[;={]'
forbidden="$casts|$static|$globals|getenv|\b(thread_local|mutable|extern)\b"
grep -nP "$forbidden" "$source"/*.cpp && fail "operators need none of these"
[ $? = 1 ] || fail "grep has no -P"

cmake --install "$build" --prefix "$scratch/package" >/dev/null
cmp "$build/bin/evodevo" "$scratch/package/bin/evodevo" || fail "runs of the installed command would seem to be of another build"
PATH=$scratch/package/bin:$PATH
cp -r "$source" "$scratch/project"
cd "$scratch/project"
cmake -B build >/dev/null
cmake --build build --parallel 2
conform() { # LIBRARY [EXPERIMENT]
  evodevo conform "build/lib/evodevo/outside.$1.evodevo.so" ${2:+--experiment "$2"} | tee verdicts
  local allowed='skipped .* (it has no parameters|its traits say that it is not elitist|its traits say nothing of locality)'
  if grep -vE "^(passed |$allowed|[0-9]+ passed, [0-9]+ skipped, 0 failed)" verdicts; then fail "a case was skipped"; fi
}
for library in limbs adaptive-reset graft plan callus scores; do conform "$library" experiment.toml; done
conform novelty
conform cross-entropy cross_entropy.toml
conform cooling cooling.toml
for experiment in *.toml; do evodevo check "$experiment"; done

# an operator of an older interface is refused by the compiler with a sentence that says what to write instead
sed 's/const evodevo::VariationContext& context/const evodevo::Layout\& layout/; s/context\.layout/layout/
     s/const evodevo::Layout& layout = layout;//; s/ override//' graft.cpp >old.cpp
cmp -s graft.cpp old.cpp && fail "the older interface is that of today"
old() { "${CXX:-c++}" -std=c++20 -fsyntax-only -I "$scratch/package/include" \
  -DEVODEVO_PLUGIN_VERSION='"1"' -DEVODEVO_PLUGIN_LICENSE='"MIT"' "$1" 2>message; }
old graft.cpp || fail "the compiler takes nothing: $(<message)"
old old.cpp && fail "an operator that gets a Layout is accepted"
grep -q 'static.* fail.*evodevo: since ABI epoch.*VariationContext in place of the Layout.*context\.layout' message ||
  fail "the compiler does not say what to write: $(<message)"
if grep -q 'lacks a function' message; then fail "the compiler gives two reasons: $(<message)"; fi

# a bad data file is refused by its name and line
cp plan.txt good.txt
echo many >>plan.txt
if evodevo check experiment.toml 2>message; then fail "a plan with a line that is no number is accepted"; fi
grep -q 'experiment.toml:.*plan.txt: line 4: .*whole number' message || fail "the refusal does not name the place: $(<message)"
mv good.txt plan.txt

show() { evodevo show "$1" --json; }

# a run that is killed when it has printed its third generation, of twenty
killed() { # EXPERIMENT FOLDER
  coproc run { exec evodevo run "$1" --out "$2" 2>&1; }
  local process=$run_PID line
  for _ in 1 2 3 4; do
    read -r line <&"${run[0]}" || fail "the run ended before it could be killed"
  done
  kill -KILL "$process"
  wait "$process" && fail "the run was done before it could be killed"
  [[ $(show "$2") == *'"finished": false'* ]] || fail "the run was done before it could be killed"
}

evodevo run experiment.toml --out straight >log
killed experiment.toml killed
mkdir elsewhere
mv killed elsewhere/moved
rm plan.txt
evodevo resume elsewhere/moved >log

# compares everything except the folder and the time of day
rows() { show "$1" | grep -vE '"(folder|created|wall_time)":'; }
diff <(rows straight) <(rows elsewhere/moved) || fail "the resumed run has other generations"
count=$(show straight | sed -n 's/^ *"evaluations_asked": \([0-9]*\),$/\1/p')
genes() { for ((id = 0; id < count; ++id)); do evodevo genes "$1" --individual "$id" --json; done; }
((count == 240)) || fail "there are $count individuals"
genes straight >straight.json
genes elsewhere/moved >moved.json
cmp straight.json moved.json || fail "the resumed run has other genes"
diff <(evodevo life straight --all) <(evodevo life elsewhere/moved --all) || fail "the best robot of the resumed run lived otherwise"

# branches have come and gone, and the rate of the mutation has evolved
sizes=$(awk '/"individual":/ { if (n) print n; n = 0 } /"type": "branch"/ { ++n } END { print n }' straight.json | sort -n)
((${sizes%%$'\n'*} < 12 && ${sizes##*$'\n'} > 12)) || fail "genomes do not differ in length: $sizes"
(($(grep -o '"ln(rate)": [-0-9.e]*' straight.json | sort -u | wc -l) > 10)) || fail "the rate does not evolve"

# a child by graft alone is its parent with blocks of the mate: the same values, and references to the same blocks
python3 - <<'END' || fail "a graft is not what the mate has"
import json, sqlite3
run = sqlite3.connect("straight/run.sqlite")
decoder, text, blocks = json.JSONDecoder(), open("straight.json").read(), {}
while text := text.lstrip():
    one, end = decoder.raw_decode(text)
    blocks[one["individual"]] = {block["id"]: block["genes"] for section in one["sections"]
                                 if section["owner"] == "outside.limbs" for block in section["blocks"]}
    text = text[end:]
assert all(isinstance(genes["material"], str) for of_one in blocks.values() for genes in of_one.values())
grafted = 0
for child, parent, mate in run.execute("SELECT id, parent, mate FROM individuals WHERE made_by = 'outside.graft'"):
    assert blocks[child].items() >= blocks[parent].items(), child
    new = blocks[child].keys() - blocks[parent].keys()
    assert all(blocks[child][one] == blocks[mate][one] for one in new), child
    grafted += len(new)
assert grafted > 3, grafted
END

# the plan has been carried out, and what is recorded can be simulated again
removed=$(evodevo life elsewhere/moved --all | grep -c 'outside.plan: spring ') || fail "the plan has removed nothing"
((removed <= 5)) || fail "the plan has removed $removed springs"

# springs have become harder by a rule that has evolved, and what it remembers has let masses come
evodevo life elsewhere/moved --all >life.txt
grep -q 'outside.callus: spring .* changed, wear .*, stiffness ' life.txt || fail "the callus has hardened nothing"
(($(grep -o '"hardening": [-0-9.e]*' straight.json | sort -u | wc -l) > 10)) || fail "the callus does not evolve"

evodevo verify elsewhere/moved --best 1 --json >verified.json
python3 - <<'END' || fail "the best robot has another fitness when it is simulated again: $(<verified.json)"
import json, sys
best = json.load(open("verified.json"))[0]
sys.exit(best["fitness"] != {trial["trial"]: trial["value"] for trial in best["trials"]}["again"])  # to the bit
END

# the fitness operators have seen all scenes, and the constraint has refused somebody
show elsewhere/moved >moved.txt
grep -q '"rhythm": 0\.' moved.txt || fail "there is no measure of the gait"
grep -q '"leap": ' moved.txt || fail "nobody leaps"
(($(grep -c '"scenario": ' moved.txt) == 3)) || fail "there are not three scenes"
grep -q 'constraint overweight: .* kg above 0' moved.txt || fail "nobody was too heavy"

evodevo genes elsewhere/moved

# the largest step of each generation is that of its number
evodevo run cooling.toml --out cooled >log
python3 - <<'END' || fail "the steps do not follow the generations"
import array, sqlite3
run = sqlite3.connect("cooled/run.sqlite")
genes = {one: array.array("f", blob) for one, blob in run.execute("SELECT id, genes FROM individuals")}
largest = {}  # step of each generation, relative to the range of a gene, which is 2
for child, parent, born in run.execute("SELECT id, parent, born FROM individuals WHERE made_by = 'outside.cooling'"):
    step = max(abs(a - b) for a, b in zip(genes[child], genes[parent], strict=True)) / 2
    largest[born] = max(step, largest.get(born, 0))
assert sorted(largest) == list(range(1, 7)), largest
assert all(0.95 < step / (0.2 / 2 ** born) < 1 + 1e-5 for born, step in largest.items()), largest
END

# what a selection operator remembers and notes survives, to the bit
contents() {
  python3 - "$1" <<'END'
import sqlite3, sys
run = sqlite3.connect(sys.argv[1] + "/run.sqlite")
for query in ("SELECT id, born, died, origin, parent, mate, made_by, hex(genes), status, spring_evaluations FROM individuals",
              "SELECT * FROM scores", "SELECT * FROM notes",
              "SELECT generation, evaluations, best, median, diverged, invalid, clones FROM generations",
              "SELECT role, name, generation, version, hex(numbers) FROM memory"):
    rows = run.execute(query).fetchall()
    assert rows, query + " has no rows"
    print(query, *rows, sep="\n")
END
}
evodevo run cross_entropy.toml --out sampled >log
killed cross_entropy.toml sampled.killed
evodevo resume sampled.killed >log
contents sampled >contents
cmp contents <(contents sampled.killed) || fail "the resumed run differs"
evodevo show sampled >shown
grep -q 'distance from the mean [0-9]' shown || fail "there are no notes: $(<shown)"
grep -qF '(outside.cross-entropy)' shown || fail "the children have another maker"
best=$(sed -n 's/^  *\([0-9]*\): distance.*/\1/p' shown | head -1)
evodevo show sampled --individual "$best" --json | grep -q '"distance from the mean": [0-9]' || fail "individual $best has no note"
