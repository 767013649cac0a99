"""Tests that tools/accuracy draws each of its charts when given small tables."""

import pathlib
import tempfile
import unittest
import xml.etree.ElementTree

from accuracy import draw
from common import results


RANKING = "scene,body,kind,method,precision,dt (s),cost (s per simulated s),rank correlation (1),low (1),high (1)," \
    "best of 20 in reference's best 3 (1),diverged (1),robots\n"
DATA = {
    "work_precision": "scene,reference,method,precision,dt (s),error (1),cost (s per simulated s),noise ceiling (1)\n"
    "a <b>,Odeint,paper-euler,float,0.0005,0.01,0.001,0\na <b>,Odeint,paper-euler,float,0.001,,0.0005,0\n"
    "a <b>,Odeint,rk4,double,0.0005,1e-6,0.01,0\n",
    "ranking": RANKING + "elastic floor,as it is,reference moved by 1e-9 m,rk4,double,3e-5,0.05,0.99,0.98,1,1,0,500\n"
    "elastic floor,as it is,another life,paper-euler,float,0.0005,0.001,0.625,0.5,0.7,0.8,0,500\n"
    "elastic floor,as it is,setting,paper-euler,float,0.0005,0.001,0.9,0.8,1,0.9,0,500\n"
    "elastic floor,32 masses,coarser body,paper-euler,float,0.0005,0.0005,0.2,0.1,0.3,0.4,0,500\n",
    "convergence": "scene,contact,method,dt (s),error (1)\nspring,no,rk4,0.004,1e-8\nspring,no,rk4,0.002,6e-10\n",
    "orders": "scene,contact,method,order in theory,observed order\nspring,no,rk4,4,3.99\n",
    "beam": "length (voxels),deflection (m),Euler-Bernoulli deflection (m),first frequency (Hz),"
    "Euler-Bernoulli first frequency (Hz)\n5,1,1.01,2,2\n10,1,1,2,2\n",
    "features": "feature,cost (% of the time without it)\nfloor,3\ndrag,-1\n",
    "energy": "method,precision,steps,energy (of the first)\nrk4,float,10,0.9\nrk4,float,20,0.8\nrk4,double,10,0.9\n",
    "stability_map": "method,damping rate * dt (1),angular frequency * dt (1),bounded\n"
    "rk4,0.5,1,1\nrk4,0.5,5,0\nrk4,1,1,1\nrk4,1,5,0\n",
    "stability_boundary": "method,damping rate * dt (1),lowest angular frequency * dt (1),"
    "highest angular frequency * dt (1)\nrk4,0,0,2.8\nrk4,1,0,2.9\n",
    "contact_gain": "method,dt * sqrt(floor stiffness / mass) (1),largest gain of a bounce (1),"
    "bound of the Euler methods (1),largest gain on a rigid floor (1)\nrk4,0.5,1,1.1,1\nrk4,1,1.2,1.4,1\n",
    "contact_map": "mass (kg),floor stiffness (N/m),largest gain of a bounce (1)\n"
    "0.1,1e5,1\n0.1,1e6,2\n0.2,1e5,1\n0.2,1e6,1.5\n",
    "divergence": "floor,mass (kg),dt (s),floor stiffness (N/m),dt * sqrt(floor stiffness / mass) (1),bodies,diverged (1),"
    "kept by the best ten at dt / 4 (1)\nelastic,0.1,0.0005,1e6,1.6,300,0.077,0.98\n"
    "elastic,0.2,0.0005,1e6,1.1,300,0,1.03\nrigid,0.1,0.0005,,,300,0,0.99\nrigid,0.2,0.0005,,,300,0,1.01\n",
}


class Charts(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        (self.folder / "origin.txt").write_text("tools/accuracy charts\ncpu\n")

    def write(self, *tables):
        for table in tables:
            (self.folder / f"{table}.csv").write_text(DATA[table])

    def drawn(self):
        results.draw(draw.CHARTS, "accuracy", [str(self.folder)])
        return {path.stem: path.read_text() for path in self.folder.glob("*.svg")}

    def test_the_front_holds_what_nothing_beats(self):
        points = [(2, 5), (1, 9), (3, 6), (4, 1), (4, 2)]
        self.assertEqual(draw.front(points), [(1, 9), (2, 5), (4, 1)])

    def test_all_that_there_is_data_for_is_drawn(self):
        self.write(*DATA)
        charts = self.drawn()
        self.assertEqual(sorted(charts), sorted(draw.CHARTS))
        for picture in charts.values():
            root = xml.etree.ElementTree.fromstring(picture)
            texts = [element.text for element in root.iter("{http://www.w3.org/2000/svg}text")]
            self.assertIn("tools/accuracy charts  |  cpu", texts)

    def test_what_there_is_no_data_for_is_left_out(self):
        self.write("beam")
        self.assertEqual(list(self.drawn()), ["beam"])

    def test_the_defaults_are_marked_and_what_diverged_is_no_point(self):
        self.write("work_precision")
        (axes,) = draw.work_precision(self.folder, "").axes
        rings = [line.get_xydata().tolist() for line in axes.lines if line.get_gid() == "defaults"]
        self.assertEqual(rings, [[[0.001, 0.01]]])
        points = [line.get_xydata().tolist() for line in axes.lines if line.get_marker() == "o" and not line.get_gid()]
        self.assertEqual(points, [[[0.001, 0.01]], [[0.01, 1e-6]]])
        self.assertEqual(axes.get_title("left"), "a <b>")

    def test_a_rigid_floor_is_drawn_beside_the_elastic_one_with_divergence_in_percent(self):
        self.write(*DATA)
        *_, gain, _, divergence = [axes for axes in draw.stability(self.folder, "").axes if axes.get_title("left")]
        for axes, points in ((gain, [[0.5, 1], [1, 1]]), (divergence, [[0.1, 0], [0.2, 0]])):
            lines = [line.get_xydata().tolist() for line in axes.lines if line.get_gid() == "rigid"]
            self.assertEqual(lines, [points])
        texts = [text.get_text() for text in divergence.texts]
        self.assertIn("7.7 %", texts)
        for told in ("99.0 to 101.0 %", "0.1 kg: the best ten keep 98 % of their fitness at dt / 4"):
            self.assertIn(told, "\n".join(texts))

    def test_ranking_has_a_row_for_each_scene_and_tells_what_another_life_says(self):
        self.write("ranking")
        rows = (self.folder / "ranking.csv").read_text()
        (self.folder / "ranking.csv").write_text(rows + rows.split("\n", 1)[1].replace("elastic floor,", "lively scene,"))
        panels = draw.ranking(self.folder, "").axes
        titles = [axes.get_title("left") for axes in panels]
        self.assertEqual([title.rsplit(", ")[-1] for title in titles], 2 * ["elastic floor"] + 2 * ["lively scene"])
        for axes, told in zip(panels, ("0.625", "0.800", "0.625", "0.800")):
            lives = [text.get_text() for text in axes.texts if "another life" in text.get_text()]
            self.assertEqual(len(lives), 1)
            self.assertIn(told, lives[0])


if __name__ == "__main__":
    unittest.main()
