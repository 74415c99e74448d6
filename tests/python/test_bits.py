"""The module gives the program's own answers, to the last bit."""

import json
import pickle
import unittest

import numpy as np
import nuno
from program import RIGHT, SCENES, SHEETS, complaint, run, timeless


class Bits(unittest.TestCase):
    def assert_same(self, result, expected):
        self.assertEqual(timeless(json.loads(result.to_json())), expected)
        frames = expected["frames"]
        for ours, theirs in (
            (result.frames, frames["positions"]),
            (result.times, frames["times"]),
            (result.final, expected["final"]),
            (result.final_velocity, expected["final_velocity"]),
            (result.launch_velocity, expected["launch_velocity"]),
            (result.scene.target, expected["target"]),
            (result.error, expected["error"]["mean"]),
            (result.max_error, expected["error"]["max"]),
            (result.centroid_error, expected["error"]["centroid"]),
            (result.relative_error, expected["error"]["relative"]),
            (result.alpha, expected["alpha"]),
            (result.time_step, expected["time_step"]),
            (result.steps, expected["steps"]),
            (result.control_effort, expected["control_effort"]),
            (result.max_strain, expected["max_strain"]),
            (result.sensitivity, expected["sensitivity"]),
        ):
            np.testing.assert_array_equal(ours, theirs)

    def test_simulates_every_demo_scene_as_the_program_does(self):
        paths = [*SCENES.glob("*.json"), *SHEETS.glob("*.json")]
        self.assertGreater(len(paths), 8)
        for path in sorted(paths):
            with self.subTest(path.name):
                result = nuno.simulate(nuno.read_scene(path), 0.02)
                self.assert_same(result, run("simulate", path, "--alpha", 0.02))

    def test_optimizes_every_demo_chain_as_the_program_does(self):
        for path in sorted(SCENES.glob("*.json")):
            with self.subTest(path.name):
                self.assert_same(nuno.optimize(nuno.read_scene(path)), run("optimize", path))

    def test_takes_the_options_of_a_search(self):
        path = SCENES / "s-curve-32.json"
        scene = nuno.read_scene(path)
        for name, value in (
            ("backend", "box2d"),
            ("optimizer", "steepest-descent"),
            ("error_limit", 0.03),
            ("effort_limit", 0.05),
            ("coefficients", 2),
            ("robust", True),
            ("refine", True),
        ):
            with self.subTest(name):
                option = ["--" + name.replace("_", "-"), *([] if value is True else [value])]
                self.assert_same(
                    nuno.optimize(scene, **{name: value}), run("optimize", path, *option)
                )

    def test_throws_meshes_as_the_program_does(self):
        start, target = (SHEETS / f"flag-to-half-pipe-{pose}.obj" for pose in ("start", "target"))
        result = nuno.throw(start, target, time=0.8, material="silk", settle=True)
        options = ("--time", 0.8, "--material", "silk", "--settle")
        self.assert_same(result, run("throw", start, target, *options))

    def test_throws_arrays_like_files(self):
        scene = nuno.read_scene(SHEETS / "flag-to-half-pipe.json")
        start, target = (SHEETS / f"flag-to-half-pipe-{pose}.obj" for pose in ("start", "target"))
        of_files = nuno.throw_scene(start, target, time=0.8)
        vertices = [
            [float(word) for word in line.split()[1:]]
            for line in target.read_text().splitlines()
            if line.startswith("v ")
        ]
        of_arrays = nuno.throw_scene(scene.initial, vertices, time=0.8, faces=scene.faces)
        fields = [json.loads(scene.fields_json) for scene in (of_arrays, of_files)]
        self.assertEqual({**fields[0], "name": of_files.name}, fields[1])
        np.testing.assert_array_equal(of_arrays.initial, of_files.initial)
        np.testing.assert_array_equal(of_arrays.target, of_files.target)

    def test_compares_as_the_program_does(self):
        path = SCENES / "s-curve-32.json"
        ours = nuno.compare(nuno.read_scene(path))
        theirs = run("compare", path)["scenes"][0]
        for name, values in theirs["alpha_curve"].items():
            if isinstance(values, list):
                values = [np.inf if value is None else value for value in values]
                np.testing.assert_array_equal(ours["alpha_curve"][name], values)
        self.assertEqual(timeless(ours["rows"]), theirs["rows"])
        self.assertEqual(ours["shape_difference"], theirs["shape_difference"])

    def test_flies_a_refined_answer_again(self):
        fields = json.loads((SCENES / "s-curve-32.json").read_text())
        damped = {**fields, "reference": "morph", "damping_ratio": 0.7}
        refined = nuno.optimize(nuno.make_scene(damped), refine=True)
        again = nuno.simulate(
            refined.scene, refined.alpha, reference_correction=refined.reference_correction
        )
        np.testing.assert_array_equal(again.final, refined.final)
        self.assertNotEqual(again.error, nuno.simulate(refined.scene, refined.alpha).error)

    def test_keeps_a_pickled_scene_and_result_to_the_last_bit(self):
        for scene in (nuno.make_scene(RIGHT), nuno.read_scene(SHEETS / "flag-to-half-pipe.json")):
            result = nuno.simulate(scene, [0.1])
            copy = pickle.loads(pickle.dumps(result))
            self.assertEqual(copy.to_json(), result.to_json())
            self.assertEqual(
                nuno.simulate(pickle.loads(pickle.dumps(scene)), 0.1).to_json(), result.to_json()
            )

    def test_makes_the_scene_of_a_file_from_its_fields(self):
        fields = json.loads((SCENES / "s-curve-32.json").read_text())
        by_file = nuno.simulate(nuno.read_scene(SCENES / "s-curve-32.json"), 0.02)
        arrays = {name: np.array(fields[name]) for name in ("initial", "target")}
        for scene in (
            nuno.make_scene(fields),
            nuno.make_scene({**fields, **arrays}),
            nuno.make_scene(**fields),
        ):
            self.assertEqual(nuno.simulate(scene, 0.02).to_json(), by_file.to_json())


class Refusals(unittest.TestCase):
    def test_say_what_the_program_says(self):
        path = SCENES / "s-curve-32.json"
        scene = nuno.read_scene(path)
        for call, arguments in (
            (lambda: nuno.read_scene("missing.json"), ["simulate", "missing.json"]),
            (lambda: nuno.simulate(scene, -1), ["simulate", path, "--alpha", "-1"]),
            (lambda: nuno.simulate(scene, backend="ode"), ["simulate", path, "--backend", "ode"]),
            (lambda: nuno.simulate(scene, backend="bullet"),
             ["simulate", path, "--backend", "bullet"]),
            (lambda: nuno.optimize(scene, coefficients=9), ["optimize", path, "--coefficients", 9]),
            (lambda: nuno.optimize(scene, error_limit=-1), ["optimize", path, "--error-limit", -1]),
            (lambda: nuno.optimize(scene, optimizer="x"), ["optimize", path, "--optimizer", "x"]),
            (lambda: nuno.optimize(scene, refine=True, robust=True),
             ["optimize", path, "--refine", "--robust"]),
            (lambda: nuno.optimize(scene, optimizer="global", error_limit=1),
             ["optimize", path, "--optimizer", "global", "--error-limit", 1]),
            (lambda: nuno.throw(path, time=1), ["throw", path, "--time", 1]),
            (lambda: nuno.throw("a.obj", "b.obj", time=0), ["throw", "a.obj", "b.obj", "--time", 0]),
            (lambda: nuno.throw("a.obj", "b.obj", time=1, material="tin"),
             ["throw", "a.obj", "b.obj", "--time", 1, "--material", "tin"]),
        ):
            with self.subTest(arguments=arguments):
                with self.assertRaises(nuno.InputError) as refused:
                    call()
                self.assertEqual(str(refused.exception), complaint(*arguments))

    def test_name_the_field_of_a_scene(self):
        for change, words in (
            ({"particles": 2}, "flag: /particles: 2 is not within 3 … 1000000"),
            ({"cloth": {"mass": -1}}, "flag: /cloth/mass: -1 is not > 0"),
            ({"gravty": 1}, 'flag: /gravty: "gravty" is not a known field; the nearest is "gravity"'),
            ({"initial": np.zeros((4, 3))},
             "flag: /initial: an array of shape (4, 3) is not one of (points, 2)"),
            ({"initial": [[0, 0], [np.nan, 0]]}, "flag: /initial/1/0: nan is not within ±1000000000000"),
            ({"target": None}, "flag: /target: null is not an array of points"),
        ):
            with self.subTest(words):
                with self.assertRaises(ValueError) as refused:
                    nuno.make_scene({**RIGHT, **change}, source="flag")
                self.assertEqual(str(refused.exception), words)

    def test_are_exceptions_that_python_knows(self):
        self.assertTrue(issubclass(nuno.InputError, ValueError))
        self.assertTrue(issubclass(nuno.OutputError, OSError))
        result = nuno.simulate(nuno.make_scene(RIGHT))
        with self.assertRaises(nuno.OutputError):
            result.save("/nowhere/at/all.json")

    def test_a_flight_that_diverges_says_at_which_step(self):
        fields = {**RIGHT, "cloth": {"stretch_stiffness": 1e-9, "mass": 1000}, "gravity": 0}
        fields["target"] = [[0, 1], [1e6, 1]]
        scene = nuno.make_scene(fields, target_length="as-drawn")
        with self.assertRaises(nuno.DivergedError) as diverged:
            nuno.simulate(scene)
        self.assertRegex(str(diverged.exception), "^scene: diverged on native .* in step 1 of")


if __name__ == "__main__":
    unittest.main()
