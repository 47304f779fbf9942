# SPDX-License-Identifier: GPL-3.0-or-later
"""Driver of tests/benchmark/sizes: python3 sizes.py PROGRAM DATA_FOLDER [--rounds N] [--width N] [--instructions]

Start states are made once by the program (minutes for the beds) and kept in DATA_FOLDER. Time is processor time of
one process around its steps. The two distributions of a scene run in turn; the metric is the median of the ratios.
"""
import argparse
import os
import re
import statistics
import subprocess

SCENES = {"gas": 1000, "bed": 300}  # steps
ENVIRONMENT = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")


def run(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, env=ENVIRONMENT)
    if done.returncode != 0:
        raise SystemExit(" ".join(map(str, command)) + " failed:\n" + done.stdout[-2000:] + done.stderr[-2000:])
    return done.stdout + done.stderr


def state(options, scene, ratio):
    path = os.path.join(options.data, f"sizes-{scene}-{ratio}.txt")
    if not os.path.exists(path):
        run(options.program, "make", scene, ratio, path + ".part")
        os.rename(path + ".part", path)
    return path


def measure(options, scene, ratio, path):
    """Seconds of a particle-step."""
    text = run(options.program, "run", scene, ratio, path, 1, SCENES[scene], options.width)
    n, steps, rebuilds, listed, contacts, ghosts, seconds = re.search(r"^steps" + r" (\S+)" * 7, text, re.M).groups()
    cost = float(seconds) / (int(n) * int(steps))
    print(f"{scene} ratio {ratio}: {n} particles, {steps} steps, {rebuilds} rebuilds, {listed} pairs and {contacts} "
          f"contacts a particle, {ghosts} ghosts, {1e9 * cost:.1f} ns a particle-step", flush=True)
    return cost


def instructions(options, scene, ratio, path):
    """Instructions of a particle-step: a run of 300 steps less one of 100."""
    counts = []
    for steps in (100, 300):
        text = run("valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", options.program, "run", scene, ratio, path, 1, steps, 4)
        counts.append(int(re.search(r"Collected : (\d+)", text).group(1)))
    return (counts[1] - counts[0]) / (200 * 100000)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("data")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--width", type=int, default=0)
    parser.add_argument("--instructions", action="store_true")
    options = parser.parse_args()
    for scene in SCENES:
        files = {ratio: state(options, scene, ratio) for ratio in (1, 50)}
        costs = {1: [], 50: []}
        for _ in range(options.rounds):
            for ratio, path in files.items():
                costs[ratio].append(measure(options, scene, ratio, path))
        ratios = [wide / one for one, wide in zip(costs[1], costs[50])]
        name = "ratio50" if scene == "gas" else "ratio50bed"
        print(f"metric dem.sizes.{name}.costRatio {statistics.median(ratios):.3g} -", flush=True)
        print(f"metric dem.sizes.{name}.rate {1 / statistics.median(costs[50]):.4g} 1/s", flush=True)
        if options.instructions:
            for ratio, path in files.items():
                count = instructions(options, scene, ratio, path)
                print(f"metric dem.sizes.{'one' if ratio == 1 else 'ratio50'}{scene}.instructions {count:.4g} -", flush=True)


main()
