"""Plots of growth, as PNG."""
import pathlib

from . import report


def draw(folder, title, label, series, values="us per robot and tick (median)", styles=None):
    """series: name -> (counts, medians). styles: name -> how its line looks; with them both axes are logarithmic."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(7, 4.9 if styles else 4.2), dpi=110)
    for name, (counts, medians) in series.items():
        axes.plot(counts, medians, **{"marker": "o", "label": name, **(styles or {}).get(name, {})})
    marks = sorted({count for counts, _ in series.values() for count in counts})
    axes.set_xscale("log")
    axes.set_xticks(marks, [f"{mark:,}" for mark in marks])
    axes.minorticks_off()
    axes.set_xlabel(label)
    axes.set_ylabel(values)
    if styles:
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    else:
        axes.set_ylim(0, 1.1 * axes.get_ylim()[1])
    axes.set_title(title)
    axes.grid(alpha=0.3)
    # The lines of peers cross the whole plot.
    axes.legend(**({"loc": "upper center", "bbox_to_anchor": (0.5, -0.14), "ncols": 2} if styles else {}))
    figure.tight_layout()
    path = pathlib.Path(folder) / (title.split(",")[0].replace(" ", "_") + ".png")
    figure.savefig(path)
    pyplot.close(figure)
    return path


def line(rows, key, column="wall_us"):
    counts = sorted({int(row[key]) for row in rows})
    return counts, [report.pick([row for row in rows if int(row[key]) == count], column).median for count in counts]


def draw_peers(folder, rows):
    """Works have a colour; of the programs that do the same one, Troupe has the whole line."""
    series, styles = {}, {}
    colors = {work: f"C{number}" for number, work in enumerate(["12 rays", "24 rays", "lidar"])}
    for work, program, name in report.PEERS:
        mine = [row for row in rows if (row["work"], row["program"]) == (work, program)]
        if mine:
            series[name] = line(mine, "robots", "processor_us")
            styles[name] = {"color": colors[work],
                            **({} if program == "troupe" else {"linestyle": "--", "marker": "s"})}
    return draw(folder, "growth beside peers, one thread each", "robots", series,
                "us of processor time per robot and tick (median)", styles)


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
    peers = report.read(folder, "peers")
    if peers:
        drawn.append(draw_peers(folder, peers))
    return drawn
