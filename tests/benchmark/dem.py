# SPDX-License-Identifier: GPL-3.0-or-later
"""Driver of tests/benchmark/dem: python3 dem.py PROGRAM DATA_FOLDER DECK_FOLDER [--peers] [--rounds N] [--width N]

Start states are made once by the program (fixed seed) and kept in DATA_FOLDER. Time is processor time of one
process: the program's own clock around its steps; for a peer that of a whole run less that of a run of no steps.
"""
import argparse
import os
import re
import resource
import statistics
import subprocess

# name: scene, tiles in x and y, steps, skin of the peers (m; what was quickest for them)
SCENES = {
    "bed10k": ("bed", 1, 1, 2000, 5e-5),
    "bed80k": ("bed", 4, 2, 300, 5e-5),
    "gas10k": ("gas", 1, 1, 5000, 1e-4),
}
PEERS = {"Lammps": ("lmp", "lmp"), "Liggghts": ("liggghts", "lig")}
ENVIRONMENT = dict(os.environ, OMP_NUM_THREADS="1", OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")


def run(*command):
    """Output and processor time (s) of a command."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, env=ENVIRONMENT)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        raise SystemExit(" ".join(map(str, command)) + " failed:\n" + done.stdout[-2000:] + done.stderr[-2000:])
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def states(options):
    """Make what is missing; file of each scene."""
    files = {}
    for name, (scene, nx, ny, _, _) in SCENES.items():
        base = os.path.join(options.data, f"dem-{scene}.txt")
        files[name] = base if nx * ny == 1 else os.path.join(options.data, f"dem-{name}.txt")
        if not os.path.exists(base):
            run(options.program, "make", scene, base + ".part")
            os.rename(base + ".part", base)
        if not os.path.exists(files[name]):
            run(options.program, "tile", base, files[name], nx, ny)
    return files


def write_peer_data(source, target, scene, nx, ny):
    rows = [line.split() for line in open(source)]
    edge = 0.02 if scene == "bed" else (10000 * 3.141592653589793 / 6 * 1e-9 / 0.3) ** (1 / 3)
    box = (edge * nx, edge * ny, 0.06 if scene == "bed" else edge)
    with open(target, "w") as out:
        out.write(f"start state\n\n{len(rows)} atoms\n2 atom types\n\n")
        for axis, length in zip("xyz", box):
            out.write(f"0 {length:.17g} {axis}lo {axis}hi\n")
        out.write("\nAtoms\n\n")
        out.writelines(f"{k + 1} 1 {r[3]} 2500 {r[0]} {r[1]} {r[2]}\n" for k, r in enumerate(rows))
        out.write("\nVelocities\n\n")
        out.writelines(f"{k + 1} {r[4]} {r[5]} {r[6]} 0 0 0\n" for k, r in enumerate(rows))


def ours(options, name, path):
    scene, nx, ny, steps, _ = SCENES[name]
    text, _ = run(options.program, "run", scene, path, 1, steps, options.width, nx, ny)
    particles, done, rebuilds, seconds = re.search(r"^steps (\d+) (\d+) (\d+) (\S+)", text, re.M).groups()
    print(f"{name} ours: {particles} particles, {done} steps, {rebuilds} rebuilds, {seconds} s", flush=True)
    return int(particles) * int(done) / float(seconds)


def peer(options, name, data, which, idle):
    scene, _, _, steps, skin = SCENES[name]
    program, ending = PEERS[which]
    deck = os.path.join(options.decks, f"{scene}.{ending}")
    command = [program, "-nocite", "-log", "none", "-in", deck, "-var", "in", data, "-var", "skin", skin, "-var", "steps"]
    if (name, which) not in idle:
        idle[name, which] = min(run(*command, 0)[1] for _ in range(2))
    text, seconds = run(*command, steps)
    loop = re.search(r"Loop time of (\S+) on .* for (\d+) steps with (\d+)", text)
    seconds -= idle[name, which]
    print(f"{name} {which}: {loop.group(3)} particles, {loop.group(2)} steps, {seconds:.3f} s", flush=True)
    return int(loop.group(3)) * int(loop.group(2)) / seconds


def main():
    parser = argparse.ArgumentParser()
    for argument in ("program", "data", "decks"):
        parser.add_argument(argument)
    parser.add_argument("--peers", action="store_true")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--width", type=int, default=0)
    options = parser.parse_args()
    files, idle = states(options), {}
    for name, (scene, nx, ny, _, _) in SCENES.items():
        rates = {which: [] for which in ("ours", *PEERS)}
        data = os.path.join(options.data, f"dem-{name}.data")
        if options.peers:
            write_peer_data(files[name], data, scene, nx, ny)
        for _ in range(options.rounds):
            rates["ours"].append(ours(options, name, files[name]))
            for which in PEERS if options.peers else ():
                rates[which].append(peer(options, name, data, which, idle))
        print(f"metric dem.{name}.rate {statistics.median(rates['ours']):.4g} 1/s")
        for which in PEERS if options.peers else ():
            ratios = [a / b for a, b in zip(rates["ours"], rates[which])]
            print(f"metric dem.{name}.vs{which} {statistics.median(ratios):.3g} -")


main()
