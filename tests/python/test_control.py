"""Gradients, and control by one's own hand."""

import unittest

import numpy as np
import nuno
from program import RIGHT, SCENES, SHEETS

DAMPED = {**RIGHT, "reference": "morph", "damping_ratio": 0.7}


class Gradients(unittest.TestCase):
    def test_are_the_limit_of_differences(self):
        backend = nuno.Backend(nuno.make_scene(DAMPED))
        at = np.array([0.05, 0.2, 0.7])
        errors, slopes = backend.gradients(at)
        np.testing.assert_allclose(errors, backend.errors(at), rtol=1e-12)
        before = None
        for step in (1e-2, 5e-3, 2.5e-3):  # central: of second order
            difference = (backend.errors(at + step) - backend.errors(at - step)) / (2 * step)
            miss = np.abs(difference - slopes)
            if before is not None:
                np.testing.assert_allclose(before / miss, 4, rtol=0.1)
            before = miss

    def test_have_one_for_every_group(self):
        backend = nuno.Backend(nuno.read_scene(SCENES / "s-curve-32.json"))
        alphas = np.array([[0.02, 0.01], [0.03, 0.05], [0.01, 0.01]])
        errors, slopes = backend.gradients(alphas)
        self.assertEqual(errors.shape, (3,))
        self.assertEqual(slopes.shape, (3, 2))
        one, whole = backend.gradients([0.01])
        self.assertAlmostEqual(errors[2], one[0], delta=1e-12 * one[0])
        # Both groups moved together are the one gain moved.
        self.assertAlmostEqual(slopes[2].sum(), whole[0], delta=1e-9 * abs(whole[0]))

    def test_of_the_error_follow_from_those_of_the_residuals(self):
        backend = nuno.Backend(nuno.make_scene(DAMPED))
        residuals, by_gain = backend.residuals([0.3])
        errors, slopes = backend.gradients([0.3])
        self.assertEqual(residuals.shape, (1, 8, 2))
        distance = np.linalg.norm(residuals, axis=2)
        np.testing.assert_allclose(distance.mean(axis=1), errors, rtol=1e-12)
        # d|r|/da = r . dr/da / |r|
        slope = ((residuals * by_gain).sum(axis=2) / distance).mean(axis=1)
        np.testing.assert_allclose(slope, slopes, rtol=1e-9)

    def test_are_refused_where_an_engine_knows_none(self):
        backend = nuno.Backend(nuno.make_scene(RIGHT), "box2d")
        self.assertFalse(backend.has_derivatives)
        with self.assertRaisesRegex(nuno.InputError, "box2d: knows no derivatives"):
            backend.gradients([0.1])


class OwnControl(unittest.TestCase):
    def test_by_equation_3_is_the_flight_of_simulate(self):
        for scene in (nuno.make_scene(RIGHT), nuno.read_scene(SHEETS / "flag-to-half-pipe.json")):
            if scene.dimension == 3:  # of which the reference moves
                continue
            alpha = 0.3
            backend = nuno.Backend(scene, alpha=alpha)
            cloth = backend.start()
            shape = scene.target - scene.target.mean(axis=0)
            for _ in range(backend.steps):
                now = cloth.positions
                cloth.step(alpha * (shape - (now - now.mean(axis=0))))
            expected = nuno.simulate(scene, alpha).final
            np.testing.assert_allclose(cloth.positions, expected, rtol=0, atol=1e-9)
            self.assertAlmostEqual(cloth.time, scene.arrival_time)

    def test_without_forces_is_launch_only(self):
        backend = nuno.Backend(nuno.make_scene(RIGHT))
        cloth = backend.start(backend.launch())
        for _ in range(backend.steps):
            cloth.step()
        np.testing.assert_array_equal(cloth.positions, nuno.simulate(backend.scene).final)

    def test_takes_only_finite_forces_of_the_right_shape(self):
        cloth = nuno.Backend(nuno.make_scene(RIGHT), "box2d").start()
        for forces in (np.zeros((7, 2)), np.zeros((8, 3)), np.full((8, 2), np.nan)):
            with self.assertRaises(nuno.InputError):
                cloth.step(forces)


if __name__ == "__main__":
    unittest.main()
