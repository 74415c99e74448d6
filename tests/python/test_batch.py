"""Many shots on threads, and on a Dask cluster of two workers of which one is killed on the way."""

import json
import os
import pathlib
import signal
import sys
import tempfile
import threading
import time
import unittest

import nuno
from program import RIGHT, SCENES, timeless


def family(count):
    """Scenes that differ, each of a few milliseconds."""
    return [
        {**RIGHT, "name": f"shot-{i:02}", "target": [[2, 1], [2.5, 1 + 0.01 * i], [3, 1]]}
        for i in range(count)
    ]


def bits(shots):
    """All numbers of the results, but for what a clock says."""
    return [timeless(json.loads(shot.result.to_json())) for shot in shots]


class Batch(unittest.TestCase):
    def test_gives_the_results_of_optimize_in_order(self):
        scenes = family(6)
        shots = nuno.batch(scenes, jobs=2)
        self.assertEqual([shot.name for shot in shots], [scene["name"] for scene in scenes])
        alone = [nuno.Shot("", nuno.optimize(nuno.make_scene(each)), "ok", "") for each in scenes]
        self.assertEqual(bits(shots), bits(alone))

    def test_tells_a_broken_shot_and_throws_the_others(self):
        scenes = [RIGHT, {**RIGHT, "particles": 1, "name": "few"}, "missing.json", RIGHT]
        shots = nuno.batch(scenes, backend="native")
        self.assertEqual([shot.status for shot in shots], ["ok", "broken", "broken", "ok"])
        self.assertEqual(shots[1].reason, "few: /particles: 1 is not within 3 … 1000000")
        self.assertIn("missing.json: cannot be opened", shots[2].reason)
        self.assertIsNone(shots[1].result)

    def test_takes_the_options_of_a_search(self):
        (shot,) = nuno.batch([RIGHT], effort_limit=0.01)
        self.assertLessEqual(shot.result.control_effort, 0.01)
        (shot,) = nuno.batch([RIGHT], backend="bullet")
        self.assertIn("bullet does not fly a chain", shot.reason)

    def test_takes_one_core_a_shot(self):
        (scene,) = family(1)
        scene["time_step"] = 2e-5  # long enough to be looked at
        counts = set()
        ended = threading.Event()

        def count_threads():
            while not ended.wait(0.001):
                counts.add(len(os.listdir("/proc/self/task")))

        counter = threading.Thread(target=count_threads)
        counter.start()
        before = len(os.listdir("/proc/self/task"))
        nuno.batch([scene], jobs=1)
        ended.set()
        counter.join()
        self.assertLessEqual(max(counts), before + 1)

    def test_reads_folders_and_writes_a_summary(self):
        shots = nuno.batch(SCENES / "nuno")
        names = sorted(str(path) for path in (SCENES / "nuno").glob("*.json"))
        self.assertEqual([shot.name for shot in shots], names)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "summary.csv")
            nuno.write_summary(path, shots)
            lines = path.read_text().splitlines()
        self.assertTrue(lines[0].startswith("shot,status,alpha,error,relative_error,max_error"))
        self.assertEqual(len(lines), 1 + len(names))
        self.assertEqual(float(lines[1].split(",")[3]), shots[0].result.error)


class Cluster(unittest.TestCase):
    def test_of_which_a_worker_is_killed_gives_the_same_bits(self):
        from distributed import Client, LocalCluster

        scenes = [*family(63), {**RIGHT, "particles": 1, "name": "few"}]
        for scene in scenes:
            scene["time_step"] = 2e-5  # long enough to be met on the way
        local = nuno.batch(scenes)
        cluster = LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, host="127.0.0.1",
            dashboard_address=None,
        )
        with cluster, Client(cluster) as client:
            workers = list(client.run(os.getpid).values())
            self.assertEqual(len(workers), 2)
            answers = []
            thread = threading.Thread(
                target=lambda: answers.append(nuno.batch(scenes, client=client))
            )
            thread.start()
            while not any(tasks for tasks in client.processing().values()):
                time.sleep(0.01)
            os.kill(workers[0], signal.SIGKILL)
            thread.join()
            survivors = set(client.run(os.getpid).values())
        self.assertNotIn(workers[0], survivors)
        (shots,) = answers
        self.assertEqual([shot.status for shot in shots], ["ok"] * 63 + ["broken"])
        self.assertEqual([shot[2:] for shot in shots], [shot[2:] for shot in local])
        self.assertEqual(bits(shots[:-1]), bits(local[:-1]))


if __name__ == "__main__":
    unittest.main()
