# SPDX-License-Identifier: GPL-3.0-or-later
"""Used by tests/benchmark/sph: runs its program, and LIGGGHTS with --peers, in turn; prints medians."""
import argparse
import math
import re
import statistics
import subprocess

SCENES = {'still50k': ('still', 32, 32, 50, 100), 'still200k': ('still', 51, 51, 78, 25),
          'dam50k': ('dam', 32, 32, 50, 100), 'dam200k': ('dam', 51, 51, 78, 25)}


def ours(program, scene, width):
    kind, nx, ny, nz, steps = scene
    out = subprocess.run([program, kind, *map(str, (nx, ny, nz, steps, 1, width))], check=True, text=True,
                         stdout=subprocess.PIPE).stdout
    particles, steps, _, pairs, seconds = map(float, out.split()[1:])
    return particles * steps / seconds, pairs * steps / seconds


def liggghts(deck, scene):
    _, nx, ny, nz, steps = scene
    sound = 10.0 * math.sqrt(9.81 * nz * 0.01)
    out = subprocess.run(['liggghts', '-in', deck, '-log', 'none', '-var', 'nx', str(nx), '-var', 'ny', str(ny), '-var', 'nz',
                          str(nz), '-var', 'c', '%.4f' % sound, '-var', 'nst', str(steps)], check=True, text=True,
                         stdout=subprocess.PIPE).stdout
    seconds, steps, atoms = re.findall(r'Loop time of (\S+) on \d+ procs for (\d+) steps with (\d+) atoms', out)[-1]
    return float(atoms) * float(steps) / float(seconds)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('program')
    parser.add_argument('deck')
    parser.add_argument('--peers', action='store_true')
    parser.add_argument('--rounds', type=int, default=5)
    parser.add_argument('--width', type=int, default=0)
    parser.add_argument('--only', action='append', choices=SCENES)
    args = parser.parse_args()
    for name in args.only or SCENES:
        rates, pairs, peer = [], [], []
        for _ in range(args.rounds):
            rate, interactions = ours(args.program, SCENES[name], args.width)
            rates.append(rate)
            pairs.append(interactions)
            if args.peers and name == 'still50k':
                peer.append(liggghts(args.deck, SCENES[name]))
        print('metric sph.%s.rate %.4g particleSteps/s' % (name, statistics.median(rates)))
        print('metric sph.%s.interactions %.4g pairs/s' % (name, statistics.median(pairs)))
        if peer:
            print('metric sph.%s.liggghts %.4g particleSteps/s' % (name, statistics.median(peer)))
            print('metric sph.%s.vsLiggghts %.3f ratio' % (name, statistics.median(a / b for a, b in zip(rates, peer))))


main()
