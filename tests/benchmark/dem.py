# SPDX-License-Identifier: GPL-3.0-or-later
"""Driver of tests/benchmark/dem: python3 dem.py PROGRAM DATA_FOLDER DECK_FOLDER [options]; see the head of dem

Start states are made once by the program (fixed seed) and kept in DATA_FOLDER. Time is processor time of one
process: the program's own clock around its steps; for a peer that of a whole run less that of a run of no steps.
Two ranks against one by the clock on the wall, which needs two free cores: the share of a core that the ranks had is a metric, too.
"""
import argparse
import os
import re
import resource
import statistics
import subprocess

# name: scene, tiles in x and y, steps, skin of the peers (m; what was quickest for them), peers
SCENES = {
    "bed10k": ("bed", 1, 1, 2000, 5e-5, ("Lammps", "Liggghts")),
    "bed80k": ("bed", 4, 2, 300, 5e-5, ("Lammps", "Liggghts")),
    "gas10k": ("gas", 1, 1, 5000, 1e-4, ("Lammps", "Liggghts")),
    "drum": ("drum", 1, 1, 1500, 2e-4, ("Liggghts",)),
}
AVX2 = ("bed10k", "gas10k")  # also with vectors no wider than AVX2 has them
PEERS = {"Lammps": ("lmp", "lmp"), "Liggghts": ("liggghts", "lig")}
ENVIRONMENT = dict(os.environ, OMP_NUM_THREADS="1", OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
DRUM_RIM, DRUM_GAP, DRUM_LENGTH = 0.053, 5e-4, 0.02


def run(*command):
    """Output (of both streams) and processor time (s) of a command."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, env=ENVIRONMENT)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        raise SystemExit(" ".join(map(str, command)) + " failed:\n" + done.stdout[-2000:] + done.stderr[-2000:])
    return done.stdout + done.stderr, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def state(options, name):
    """Make what is missing; file of the scene."""
    scene, nx, ny = SCENES[name][:3]
    base = os.path.join(options.data, f"dem-{scene}.txt")
    tiled = os.path.join(options.data, f"dem-{name}.txt")
    if not os.path.exists(base):
        run(options.program, "make", scene, base + ".part")
        if scene == "drum":
            os.rename(base + ".part.stl", base + ".stl")
        os.rename(base + ".part", base)
    if nx * ny == 1:
        return base
    if not os.path.exists(tiled):
        run(options.program, "tile", base, tiled, nx, ny)
    return tiled


def box_of(scene, nx, ny):
    if scene == "drum":
        return (-DRUM_RIM, DRUM_RIM), (-DRUM_GAP, DRUM_LENGTH + DRUM_GAP), (-DRUM_RIM, DRUM_RIM)
    edge = 0.02 if scene == "bed" else (10000 * 3.141592653589793 / 6 * 1e-9 / 0.3) ** (1 / 3)
    return (0, edge * nx), (0, edge * ny), (0, 0.06 if scene == "bed" else edge)


def write_peer_data(source, target, scene, nx, ny):
    rows = [line.split() for line in open(source)]
    with open(target, "w") as out:
        out.write(f"start state\n\n{len(rows)} atoms\n2 atom types\n\n")
        for axis, (low, high) in zip("xyz", box_of(scene, nx, ny)):
            out.write(f"{low:.17g} {high:.17g} {axis}lo {axis}hi\n")
        out.write("\nAtoms\n\n")
        out.writelines(f"{k + 1} 1 {r[3]} 2500 {r[0]} {r[1]} {r[2]}\n" for k, r in enumerate(rows))
        out.write("\nVelocities\n\n")
        out.writelines(f"{k + 1} {r[4]} {r[5]} {r[6]} 0 0 0\n" for k, r in enumerate(rows))


def ours(options, name, path, width, before=(), steps=None):
    """particles, steps, seconds: processor, wall, processor without waiting; share; bytes; whole output."""
    scene, nx, ny, usual = SCENES[name][:4]
    text, _ = run(*before, options.program, "run", scene, path, 1, steps or usual, width, nx, ny)
    values = re.search(r"^steps" + r" (\S+)" * 8, text, re.M).groups()
    return [float(v) for k, v in enumerate(values) if k != 2], text


def rate(options, name, path, width):
    (particles, steps, seconds, *_), _ = ours(options, name, path, width)
    print(f"{name} ours, width {width}: {particles:.0f} particles, {steps:.0f} steps, {seconds} s", flush=True)
    return particles * steps / seconds


def peer(options, name, path, which, idle):
    scene, _, _, steps, skin, _ = SCENES[name]
    data = os.path.join(options.data, f"dem-{name}.data")
    program, ending = PEERS[which]
    deck = os.path.join(options.decks, f"{scene}.{ending}")
    command = [program, "-nocite", "-log", "none", "-in", deck, "-var", "in", data, "-var", "skin", skin]
    command += ["-var", "stl", path + ".stl", "-var", "steps"]
    if (name, which) not in idle:
        idle[name, which] = min(run(*command, 0)[1] for _ in range(2))
    text, seconds = run(*command, steps)
    loop = re.search(r"Loop time of (\S+) on .* for (\d+) steps with (\d+)", text)
    seconds -= idle[name, which]
    print(f"{name} {which}: {loop.group(3)} particles, {loop.group(2)} steps, {seconds:.3f} s", flush=True)
    return int(loop.group(3)) * int(loop.group(2)) / seconds


def one_core(options, name, path):
    scene, nx, ny, _, _, peers = SCENES[name]
    peers = peers if options.peers else ()
    kinds = ("ours", "avx2") if name in AVX2 and options.width in (0, 8) else ("ours",)
    rates = {which: [] for which in kinds + peers}
    idle = {}
    if peers:
        write_peer_data(path, os.path.join(options.data, f"dem-{name}.data"), scene, nx, ny)
    for _ in range(options.rounds):
        for which in kinds:
            rates[which].append(rate(options, name, path, options.width if which == "ours" else 4))
        for which in peers:
            rates[which].append(peer(options, name, path, which, idle))
    for kind, rate_name, versus in (("ours", "rate", "vs"), ("avx2", "avx2Rate", "avx2Vs"))[: len(kinds)]:
        print(f"metric dem.{name}.{rate_name} {statistics.median(rates[kind]):.4g} 1/s", flush=True)
        for which in peers:
            ratios = [a / b for a, b in zip(rates[kind], rates[which])]
            print(f"metric dem.{name}.{versus}{which} {statistics.median(ratios):.3g} -", flush=True)


def two_ranks(options, name, path):
    """Rate of two ranks, over that of one just before; the share of a core that each rank had at least; the same ratio without
    what a rank waited for the other, which does not depend on free cores; bytes that both sent, per step."""
    rates, ratios, shares, works, sent = [], [], [], [], 0.0
    for _ in range(options.rounds):
        (particles, steps, _, alone, work, _, _), _ = ours(options, name, path, options.width, steps=600)
        (_, _, _, both, half, share, sent), _ = ours(options, name, path, options.width, ("mpirun", "-np", 2), steps=600)
        rates.append(particles * steps / both)
        ratios.append(alone / both)
        shares.append(share)
        works.append(work / half)
        print(f"{name} two ranks: {both:.3f} s on the wall, {half:.3f} s of work, one rank {alone:.3f} s, {work:.3f} s; "
              f"each rank had {share:.2f} of a core", flush=True)
    print(f"metric dem.{name}.ranks2 {statistics.median(rates):.4g} 1/s")
    print(f"metric dem.{name}.ranks2Ratio {statistics.median(ratios):.3g} -")
    print(f"metric dem.{name}.ranks2WorkRatio {statistics.median(works):.3g} -")
    print(f"metric dem.{name}.ranks2CoreShare {statistics.median(shares):.3g} -")
    print(f"metric dem.{name}.ranks2Bytes {sent / steps:.4g} B", flush=True)


def instructions(options, name, path):
    """Instructions of a particle-step on one rank, counted by valgrind: a run of 300 steps less one of 100; AVX2."""
    counts, count = [], ("valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null")
    for steps in (100, 300):
        (particles, *_), text = ours(options, name, path, 4, count, steps)
        counts.append(int(re.search(r"Collected : (\d+)", text).group(1)))
    print(f"metric dem.{name}.instructions {(counts[1] - counts[0]) / (200 * particles):.4g} -", flush=True)


def dilute(options):
    """Steps taken over those of skip off: one sphere that falls on a plane, and a hundred that fly."""
    worst = 0.0
    for scene in "fall", "fly":
        text, _ = run(options.program, "dilute", scene, 0.5)
        few, every, difference = re.search(r"^dilute (\S+) (\S+) (\S+)", text, re.M).groups()
        print(f"{scene}: {few} of {every} steps, positions differ by {difference} m", flush=True)
        worst = max(worst, int(few) / int(every))
    print(f"metric dem.dilute.stepsRatio {worst:.3g} -", flush=True)


def main():
    parser = argparse.ArgumentParser()
    for argument in ("program", "data", "decks"):
        parser.add_argument(argument)
    parser.add_argument("--peers", action="store_true")
    parser.add_argument("--instructions", action="store_true")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--width", type=int, default=0)
    parser.add_argument("--only", action="append", choices=[*SCENES, "ranks2", "dilute"])
    options = parser.parse_args()
    wanted = options.only or [*SCENES, "ranks2", "dilute"]
    for name in SCENES:
        if name in wanted:
            path = state(options, name)
            one_core(options, name, path)
            if options.instructions:
                instructions(options, name, path)
    if "ranks2" in wanted:
        two_ranks(options, "bed80k", state(options, "bed80k"))
    if "dilute" in wanted:
        dilute(options)


main()
