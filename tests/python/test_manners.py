"""How the module behaves among other Python: memory, threads, Ctrl-C, documentation."""

import inspect
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np
import nuno
from program import LONG, RIGHT, SCENES


def resident():
    """Memory of this process [bytes]."""
    pages = int(pathlib.Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize()


class Arrays(unittest.TestCase):
    def test_are_views_that_cannot_be_written(self):
        result = nuno.simulate(nuno.make_scene(RIGHT), 0.1)
        for array in (result.frames, result.final, result.launch_velocity, result.scene.initial):
            self.assertFalse(array.flags.owndata)
            self.assertFalse(array.flags.writeable)
        self.assertTrue(np.shares_memory(result.frames, result.frames))

    def test_have_particles_in_rows(self):
        result = nuno.simulate(nuno.make_scene(RIGHT), 0.1)
        self.assertEqual(result.frames.shape, (31, 8, 2))
        np.testing.assert_array_equal(result.frames[0], result.scene.initial)
        np.testing.assert_array_equal(result.frames[-1], result.final)
        self.assertEqual(result.times.shape, (31,))

    def test_outlive_what_they_are_of(self):
        frames = nuno.simulate(nuno.make_scene(RIGHT), 0.1).frames
        before = frames.copy()
        for _ in range(50):
            nuno.simulate(nuno.make_scene(RIGHT), 0.2)
        np.testing.assert_array_equal(frames, before)


class Memory(unittest.TestCase):
    def test_is_level_over_a_thousand_throws(self):
        scene = nuno.read_scene(SCENES / "s-curve-32.json")

        def throws(count):
            for _ in range(count):
                nuno.optimize(scene)

        throws(100)  # whatever is made once
        before = resident()
        throws(900)
        a_frame_each = 900 * 32 * 2 * 8
        self.assertLess(resident() - before, a_frame_each)


class Threads(unittest.TestCase):
    def test_others_run_during_a_flight(self):
        scene = nuno.make_scene({**LONG, "arrival_time": 2})
        count = 0
        flying = threading.Thread(target=lambda: nuno.simulate(scene))
        flying.start()
        while flying.is_alive():
            count += 1
            time.sleep(0)
        # A flight that held the lock would leave the loop one round or two.
        self.assertGreater(count, 100)

    def test_share_a_backend(self):
        backend = nuno.Backend(nuno.read_scene(SCENES / "s-curve-32.json"))
        gains = np.linspace(0, 0.1, 9)
        expected = backend.errors(gains)
        answers = [None] * 4

        def ask(i):
            answers[i] = backend.errors(gains)

        threads = [threading.Thread(target=ask, args=(i,)) for i in range(len(answers))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for answer in answers:
            np.testing.assert_array_equal(answer, expected)


class CtrlC(unittest.TestCase):
    """What is not ended takes longer than the time limit of a test."""

    def interrupt(self, work):
        threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        with self.assertRaises(KeyboardInterrupt):
            work()

    def test_ends_a_flight(self):
        self.interrupt(lambda: nuno.simulate(nuno.make_scene(LONG), backend="box2d"))

    def test_ends_a_search(self):
        self.interrupt(lambda: nuno.optimize(nuno.make_scene(LONG)))

    def test_ends_a_batch(self):
        self.interrupt(lambda: nuno.batch([LONG] * 3, jobs=2))
        (shot,) = nuno.batch([RIGHT])  # the next one is thrown
        self.assertEqual(shot.status, "ok")

    def test_leaves_a_backend_that_still_flies(self):
        backend = nuno.Backend(nuno.make_scene(LONG), "box2d")
        self.interrupt(lambda: backend.errors(np.zeros(1)))
        short = nuno.Backend(nuno.make_scene(RIGHT))
        self.assertEqual(short.errors([0]).shape, (1,))
        self.interrupt(lambda: backend.errors(np.zeros(1)))  # it does fly: it takes long again

    def test_of_a_handler_that_raises_nothing_is_waited_out(self):
        heard = []
        before = signal.signal(signal.SIGUSR1, lambda *_: heard.append(1))
        try:
            threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGUSR1)).start()
            nuno.simulate(nuno.make_scene({**LONG, "arrival_time": 2}))
        finally:
            signal.signal(signal.SIGUSR1, before)
        self.assertEqual(heard, [1])


class Files(unittest.TestCase):
    def test_are_those_of_the_program(self):
        result = nuno.throw(
            *(SCENES / "sheets" / f"flag-to-half-pipe-{pose}.obj" for pose in ("start", "target")),
            time=0.5,
        )
        with tempfile.TemporaryDirectory() as folder:
            ours, theirs = pathlib.Path(folder, "ours.glb"), pathlib.Path(folder, "theirs.glb")
            result.save(ours)
            subprocess.run(
                [os.environ["NUNO_PROGRAM"], "throw"]
                + [SCENES / "sheets" / f"flag-to-half-pipe-{pose}.obj" for pose in ("start", "target")]
                + ["--time", "0.5", "--out", theirs],
                check=True,
                stdout=subprocess.DEVNULL,
            )
            self.assertEqual(ours.read_bytes(), theirs.read_bytes())


class Documentation(unittest.TestCase):
    def test_of_every_public_name_is_there(self):
        names = {name: getattr(nuno, name) for name in nuno.__all__ if name != "__version__"}
        members = {
            f"{name}.{member}": inspect.getattr_static(value, member)
            for name, value in names.items()
            if inspect.isclass(value) and not issubclass(value, (Exception, dict))
            for member in dir(value)
            if not member.startswith("_")
        }
        self.assertGreater(len(members), 40)
        for name, value in {"nuno": nuno, **names, **members}.items():
            self.assertTrue((value.__doc__ or "").strip(), f"{name} has no docstring")

    def test_is_shown_by_pydoc(self):
        shown = subprocess.run(
            [sys.executable, "-m", "pydoc", "nuno"], capture_output=True, text=True, check=True
        ).stdout
        for name in set(nuno.__all__) - {"__version__"}:
            self.assertIn(name, shown)

    def test_stubs_name_what_the_extension_has(self):
        stubs = pathlib.Path(nuno.__file__).with_name("_core.pyi").read_text()
        from nuno import _core

        for holder in (_core, _core.Scene, _core.Result, _core.Backend, _core.Simulation):
            for name in dir(holder):
                if not name.startswith("_"):
                    self.assertRegex(stubs, rf"(def|class) {name}\b")


if __name__ == "__main__":
    unittest.main()
