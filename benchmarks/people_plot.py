#!/usr/bin/env python3
"""Draws what people_flow has measured: speed and flow over density, and the flow through openings.

    people_plot.py PEOPLE_FLOW.csv [RVO2.csv] -o docs/pictures/people_flow.png
"""
import argparse
import csv
import math


def weidmann(density):
    """m/s at persons per square metre (Weidmann 1993)."""
    return 1.34 * (1.0 - math.exp(-1.913 * (1.0 / density - 1.0 / 5.4)))


def points(path, experiment):
    with open(path, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["experiment"] == experiment]
    return sorted((float(row["parameter"]), float(row["value"])) for row in rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("troupe")
    parser.add_argument("rvo2", nargs="?")
    parser.add_argument("-o", "--output", required=True)
    arguments = parser.parse_args()
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, (speed, flow, opening) = pyplot.subplots(1, 3, figsize=(12, 3.8), dpi=100)
    densities = [0.02 * i for i in range(10, 221)]
    speed.plot(densities, [weidmann(d) for d in densities], "k", label="Weidmann 1993")
    flow.plot(densities, [d * weidmann(d) for d in densities], "k", label="Weidmann 1993")
    opening.axhspan(1.2, 1.9, color="0.85", label="measurements")
    for path, name, style in [(arguments.troupe, "Troupe", "C0o"), (arguments.rvo2, "RVO2", "C1x")]:
        if path is None:
            continue
        corridor = points(path, "corridor")
        speed.plot(*zip(*corridor), style, label=name)
        flow.plot(*zip(*[(d, d * v) for d, v in corridor]), style, label=name)
        opening.plot(*zip(*points(path, "opening")), style, label=name)
    speed.set(xlabel="persons per m²", ylabel="m/s", title="speed in a corridor", ylim=(0, 1.6))
    flow.set(xlabel="persons per m²", ylabel="persons per m and s", title="flow in a corridor", ylim=(0, 2.5))
    opening.set(xlabel="width, m", ylabel="persons per m and s", title="flow through an opening", ylim=(0, 2.5))
    for axes in (speed, flow, opening):
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(arguments.output)


if __name__ == "__main__":
    main()
