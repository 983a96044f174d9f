"""Plots of growth, as PNG."""
import pathlib

from . import report


def draw(folder, title, label, series):
    """series: name -> (counts, medians). Nothing without matplotlib."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(7, 4.2), dpi=110)
    for name, (counts, values) in series.items():
        axes.plot(counts, values, marker="o", label=name)
    marks = sorted({count for counts, _ in series.values() for count in counts})
    axes.set_xscale("log")
    axes.set_xticks(marks, [f"{mark:,}" for mark in marks])
    axes.minorticks_off()
    axes.set_xlabel(label)
    axes.set_ylabel("us per robot and tick (median)")
    axes.set_ylim(0, 1.1 * axes.get_ylim()[1])
    axes.set_title(title)
    axes.grid(alpha=0.3)
    axes.legend()
    figure.tight_layout()
    path = pathlib.Path(folder) / (title.split(",")[0].replace(" ", "_") + ".png")
    figure.savefig(path)
    pyplot.close(figure)
    return path


def line(rows, key, column="wall_us"):
    counts = sorted({int(row[key]) for row in rows})
    return counts, [report.pick([row for row in rows if int(row[key]) == count], column).median for count in counts]


def draw_all(folder):
    """The paths of the plots."""
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        print("no plots: python3-matplotlib is missing")
        return []
    drawn = []
    barrier, processes, robots = (report.read(folder, name) for name in ["barrier", "processes", "robots"])
    series = {}
    for transport, name in [("memory", "plain shared memory, answers only"),
                            ("sharing", "data sharing, answers only"),
                            ("udp", "plain UDP, answers only"), ("dds", "DDS, answers only")]:
        rows = [row for row in barrier if row["transport"] == transport]
        if rows:
            series[name] = line(rows, "processes")
    if processes:
        series["troupe run, idle robots"] = line([row for row in processes if int(row["robots"]) <= 200], "robots")
    if series:
        drawn.append(draw(folder, "growth with processes, a process for each robot", "processes", series))
    if robots:
        drawn.append(draw(folder, "growth with robots, in one process", "robots",
                          {"12 infrared rays each": line(robots, "robots")}))
    return drawn
