"""The archive of a run. framework/archive/README.md describes its tables."""

import functools
import json
import pathlib
import shlex
import sqlite3
import tempfile
import tomllib

import numpy as np
import pandas as pd

from .body import Body
from .errors import ArchiveError
from .program import json_of, output_of

FORMAT = 17  # of the archive


def _gene_name(names, count, gene):
    """Returns the name of a gene of a block of `count` genes, as `evodevo genes` does. The last name is that of all
    further genes, too, which are counted."""
    listed = len(names)
    name = names.iloc[min(gene, listed - 1)]
    if count <= listed or gene + 1 < listed:
        return name or str(gene)
    return f"{name} {gene + 1 - listed}".strip()


class Run:
    """A run. It may still be going on; each attribute is read when it is first used, and another `Run` reads it anew.

    Columns have the names of the archive's tables. `DataFrame.attrs["units"]` has the units of those that are
    quantities. Raises ArchiveError if the folder is no run, or is in another format.
    """

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        file = self.folder / "run.sqlite"
        if not file.is_file():
            raise ArchiveError(f"{folder}: is no run, since it has no file run.sqlite; give the folder of a run")
        # a path may have characters that mean something in a URI
        self._connection = sqlite3.connect(f"{file.resolve().as_uri()}?mode=ro", uri=True)
        try:
            self.record = dict(self._connection.execute("SELECT key, value FROM record"))
        except sqlite3.OperationalError as error:
            # a rollback journal: another process is writing, or was killed while it wrote
            raise ArchiveError(f"{file}: {error}; try again in a moment, or if no process writes to it, let `evodevo show "
                               f"{shlex.quote(str(folder))}` put it in order first") from error
        except sqlite3.DatabaseError as error:
            raise ArchiveError(f"{file}: {error}; put back an undamaged copy of it") from error
        found = self.record.get("format")
        if found != str(FORMAT):
            raise ArchiveError(f"{file}: has format {found}, and this package reads {FORMAT}; use that of evodevo "
                               f"{self.record.get('evodevo')}")

    def __repr__(self):
        return f"Run({str(self.folder)!r}: {self.record['name']}, seed {self.record['seed']})"

    def query(self, sql, *values):
        """Returns the rows of an SQL query as a DataFrame. `values` stand in for the question marks."""
        return pd.read_sql_query(sql, self._connection, params=values)

    # ---- the whole run ----

    @functools.cached_property
    def experiment(self):
        """The experiment with every default, as nested dictionaries like its TOML."""
        return tomllib.loads(self.record["experiment"])

    @functools.cached_property
    def objectives(self):
        """The objectives by position: name, unit, maximise."""
        table = self.query("SELECT * FROM objectives ORDER BY position").set_index("position")
        return table.astype({"maximise": bool})

    @functools.cached_property
    def measures(self):
        """The scores that are not objectives by position: name, unit, role, low, high, bins."""
        return self.query("SELECT * FROM measures ORDER BY position").set_index("position")

    @functools.cached_property
    def generations(self):
        """A row for each generation: evaluations (so far), best and median of the first objective, numbers of newborns
        that diverged, invalid, of individuals that became artefact, lucky or passive, clones, spring_evaluations, wall_time (s).
        """
        table = self.query("SELECT * FROM generations ORDER BY generation").set_index("generation")
        unit = self.objectives.unit.iloc[0]
        table.attrs["units"] = {"best": unit, "median": unit, "wall_time": "s"}
        return table

    @functools.cached_property
    def individuals(self):
        """A row for each individual that ever lived, by id: born, died (missing while it lives), origin, parent, mate,
        made_by, provenance, lives, measured, status, reason, ended_at (s), spring_evaluations, and a column for each objective and each
        measure, under its name. Those without a fitness have no scores. If a name is taken, a number follows it, as in
        distance_1; `objective_columns` has the names for the objectives."""
        table = self.query("SELECT id, born, died, origin, parent, mate, made_by, provenance, lives, measured, status, "
                           "reason, ended_at, spring_evaluations FROM individuals ORDER BY id").set_index("id")
        table = table.astype({"died": "Int64", "parent": "Int64", "mate": "Int64", "ended_at": float})
        units, columns = {"ended_at": "s"}, []
        for kinds, rows, key in ((self.objectives, "scores", "objective"), (self.measures, "measured", "measure")):
            for position, kind in kinds.iterrows():
                name = kind["name"]
                number = 0
                while name in table:
                    number += 1
                    name = f"{kind['name']}_{number}"
                values = self.query(f"SELECT individual, value FROM {rows} WHERE {key} = ?", position)
                table[name] = values.set_index("individual")["value"]
                units[name] = kind["unit"]
                columns.append(name)
        table.attrs["units"] = units
        table.attrs["scores"] = columns
        return table

    @property
    def objective_columns(self):
        """The columns of `individuals` with the objectives, in their order."""
        return self.individuals.attrs["scores"][:len(self.objectives)]

    @functools.cached_property
    def tests(self):
        """The scores in each repeat of each scenario: individual, life, scenario, repeat, objective, value."""
        return self.query("SELECT individual, life, scenarios.name AS scenario, repeat, objectives.name AS objective, "
                          "value FROM tests JOIN scenarios USING (scenario) JOIN objectives ON position = objective "
                          "ORDER BY individual, life, tests.scenario, repeat, tests.objective")

    @functools.cached_property
    def life_scores(self):
        """The scores in each life of individuals that have had several: individual, life, objective, value."""
        return self.query("SELECT individual, life, objectives.name AS objective, value FROM life_scores "
                          "JOIN objectives ON position = objective ORDER BY individual, life, life_scores.objective")

    @functools.cached_property
    def verifications(self):
        """The trials of verified individuals: individual, trial, status, reason, value (of the first objective)."""
        return self.query("SELECT individual, trial, status, reason, value FROM verifications "
                          "ORDER BY individual, position")

    @functools.cached_property
    def signal(self):
        """What repeats in scores and what children inherit, as `evodevo signal` has measured it: population, quantity,
        of, scale, value, low, high (95 % interval), count. It has no rows if nothing was measured since the last
        generation."""
        return self.query("SELECT population, quantity, of, scale, value, low, high, count FROM signal ORDER BY position")

    @functools.cached_property
    def members(self):
        """The survivors of each generation: generation, individual, age (generations)."""
        return self.query("SELECT * FROM members ORDER BY generation, individual")

    def best(self, count=1):
        """Returns the rows of `individuals` with the best first objective of the whole run, the best first. Of equal
        ones, the older comes first."""
        column = self.objective_columns[0]
        scored = self.individuals.dropna(subset=[column])
        return scored.sort_values(column, ascending=not self.objectives["maximise"].iloc[0], kind="stable").head(count)

    # ---- one individual ----

    def _row(self, individual, columns):
        row = self._connection.execute(f"SELECT {columns} FROM individuals WHERE id = ?", (int(individual),)).fetchone()
        if row is None:
            raise ArchiveError(f"{self.folder}: has no individual {individual}; ids go from 0 to "
                               f"{len(self.individuals) - 1}")
        return row

    def genome(self, individual):
        """Returns the genes of an individual as [genes] numpy.float32, section by section."""
        return np.frombuffer(self._row(individual, "genes")[0], "<f4").copy()

    def genes(self, individual):
        """Returns a row for each gene of an individual, in the order of `genome`: section (the operator that owns it),
        block (counted from 0 in its section), type (of the block), gene (its name, as `evodevo genes` gives it),
        value, low, high (bounds of a real gene), option (the name of the option that a choice gene chooses; empty if
        it has none)."""
        values = self.genome(individual)
        types = self.query("SELECT type, section, owner, block_types.name FROM block_types "
                           "JOIN sections USING (section)")
        types = types.set_index("type")
        kinds = dict(tuple(self.query("SELECT * FROM gene_types ORDER BY type, position").groupby("type")))
        options = self.query("SELECT * FROM gene_options").set_index(["type", "position", "option"])["name"].to_dict()
        rows, first, blocks_in = [], 0, {}
        for kind, count in self._blocks(individual):
            section, owner, name = types.loc[kind]
            block = blocks_in[section] = blocks_in.get(section, -1) + 1
            genes = kinds[kind]
            for i in range(count):
                position = min(i, len(genes) - 1)  # the last describes all further ones
                gene = genes.iloc[position]
                rows.append((owner, block, name, _gene_name(genes["name"], count, i), values[first + i], gene["low"],
                             gene["high"], options.get((kind, position, float(values[first + i])), "")))
            first += count
        return pd.DataFrame(rows, columns=["section", "block", "type", "gene", "value", "low", "high", "option"])

    def _blocks(self, individual):
        """Returns the type and the number of genes of each block of a genome."""
        fixed = self.query("SELECT block_types.section, type, genes FROM first_blocks JOIN block_types USING (type) "
                           "ORDER BY block")
        stored = self._row(individual, "blocks")[0]
        if stored is None:
            return list(zip(fixed["type"], fixed["genes"]))
        types = self.query("SELECT type, section, least, most FROM block_types").set_index("type")
        own = np.frombuffer(stored, np.dtype([("type", "<u4"), ("genes", "<u4"), ("id", "<u8")]))
        blocks = []
        for section, of_section in types.groupby("section"):
            if (of_section["least"] == of_section["most"]).all():
                rows = fixed[fixed["section"] == section]
                blocks += zip(rows["type"], rows["genes"])
            else:
                blocks += [(int(one["type"]), int(one["genes"])) for one in own
                           if types.at[int(one["type"]), "section"] == section]
        return blocks

    def lineage(self, individual):
        """Returns the rows of `individuals` from this one back to the random individual that it descends from, through
        parents whose copies were varied; the founder comes last."""
        ids, at = [], individual
        while at is not None:
            ids.append(int(at))
            (at,) = self._row(at, "parent")
        return self.individuals.reindex(ids)

    def life(self, individual, life=1):
        """Returns the edits that development made to a robot in one of its lives, a row for each, in their order: cycle, operator, event,
        spring (two numbers of masses) or mass, identity (of a mass, UInt64), cause, measure, unit, and so on; the columns
        are those of `evodevo life --json`. Simulates the development again with `program()`."""
        edits = json_of("life", self.folder, "--individual", individual, "--life", life, "--json")["edits"]
        frame = pd.DataFrame(edits)
        if "identity" in frame:  # springs have none, and floats would not hold those of masses
            frame["identity"] = pd.array([edit.get("identity") for edit in edits], dtype="UInt64")
        return frame

    def body(self, individual, matured=False, life=1):
        """Returns the Body of an individual, as it was born or, if `matured`, after its development in one of its lives,
        which is then simulated again with `program()`."""
        if life != 1 and not matured:
            raise ValueError(f"life = {life}: robots are born with the same body in every life; give matured=True")
        options = ["--matured", "--life", life] if matured else []
        return Body.from_json(json_of("body", self.folder, "--individual", individual, *options))

    def motion(self, individual, seconds, life=1):
        """Returns how a robot that has matured in one of its lives moves in the scene of the run for `seconds`: [frames] times since birth (s) and
        [frames, masses, 3] positions (m), with a frame about every 0.01 s. Simulates it with `program()`."""
        body = self.body(individual, matured=True, life=life)
        with tempfile.TemporaryDirectory() as scratch:
            scratch = pathlib.Path(scratch)
            (scratch / "body.json").write_text(json.dumps(body.json), encoding="utf-8")
            (scratch / "experiment.toml").write_text(self.record["experiment"], encoding="utf-8")
            for path, content in self._connection.execute("SELECT path, content FROM files"):
                file = scratch / path
                if not file.resolve().is_relative_to(scratch.resolve()):
                    continue  # the program reads such a file where it was
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_bytes(content)
            # whatever device the run had, this machine may lack it
            output_of("simulate", scratch / "body.json", scratch / "experiment.toml", "--duration", seconds, "--device",
                      "auto", "--trajectory", scratch / "motion.csv", "--quiet")
            table = pd.read_csv(scratch / "motion.csv")
        times = table["time"].unique()
        return times, table[["x", "y", "z"]].to_numpy().reshape(len(times), -1, 3)
