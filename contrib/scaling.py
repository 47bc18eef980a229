"""How pictures divided among many workers grow in speed and cost: measured here, and a model of that for more workers.

    pip install matplotlib
    cargo build --release
    python3 contrib/scaling.py --program target/release/translucid --write \\
        scenes/head.toml=path/to/head_70k.ply scenes/dragon.toml=path/to/dragon_870k.ply

Prints the tables of docs/speed/many-machines.md, and with `--write` puts them there and draws its figure.
`--keep FILE` keeps what was measured, and `--from FILE` takes it from there instead of measuring: another model of the
same measurements.

Times are CPU seconds of whole processes on one thread each, as the system accounts them, unless a table says
otherwise: so that other work on the machine changes them little (through caches and shared units of a processor core).
"""

import argparse
import datetime
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs/speed/many-machines.md"
FIGURE = ROOT / "docs/images/many-machines.svg"
MARKS = ("<!-- measured: contrib/scaling.py -->", "<!-- end of what was measured -->")

SIZE = (3840, 2160)
SAMPLES = 1024
WORKERS = (1, 10, 100, 1000)
BYTES_PER_SECOND = 1e9
"""Assumed: what a shared disk or network gives to a process that writes or reads shards."""
SMALL_SIZE = (640, 360)
SMALL_SAMPLES = 8


class Program:
    """The command, run in a directory with its CPU time taken."""

    def __init__(self, path, directory):
        self.path = str(pathlib.Path(path).resolve())
        self.directory = pathlib.Path(directory)

    def start(self, *words):
        return subprocess.Popen([self.path, *map(str, words)], cwd=self.directory, stdout=subprocess.DEVNULL)

    def end(self, process):
        """CPU seconds of a process that ends well."""
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            sys.exit(f"{' '.join(process.args)} failed with {process.returncode}")
        return usage.ru_utime + usage.ru_stime

    def run(self, *words):
        return self.end(self.start(*words))

    def render(self, scene, output, *words):
        """CPU seconds and statistics of a rendering on one thread."""
        cpu = self.run("render", *scene, *words, "-q", "--threads", 1, "--stats", "stats.json", "-o", output)
        stats = json.loads((self.directory / "stats.json").read_text())
        return {"cpu": cpu, "rendering": stats["cpu_seconds"], "memory": stats["peak_memory_bytes"]}


def measure_workers(program, scene):
    """One run, one worker's shard, and two workers' at once, each with its merge."""
    small = ["--size", "{}x{}".format(*SMALL_SIZE), "--spp", SMALL_SAMPLES]
    result = {}
    begin = time.monotonic()
    cpu = program.render(scene, "run.exr", *small)["cpu"]
    result["one run"] = {"longest": cpu, "all": cpu, "wall": time.monotonic() - begin}
    for count in (1, 2):
        begin = time.monotonic()
        edges = [SMALL_SAMPLES * i // count for i in range(count + 1)]
        parts = [f"worker-{i}.shard" for i in range(count)]
        words = [
            ["render", *scene, *small, "-q", "--threads", 1, "--samples", f"{a}..{b}", "-o", part]
            for a, b, part in zip(edges, edges[1:], parts)
        ]
        processes = [program.start(*word) for word in words]
        times = [program.end(process) for process in processes]
        merge = program.run("merge", "-q", "merged.exr", *parts)
        wall = time.monotonic() - begin
        result[f"workers: {count}"] = {"longest": max(times) + merge, "all": sum(times) + merge, "wall": wall}
    if (program.directory / "merged.png").read_bytes() != (program.directory / "run.png").read_bytes():
        sys.exit("the merged picture is not that of one run")
    return result


def bands(top, bottom, count):
    """Rows of up to so many bands of equal height."""
    edges = sorted({top + (bottom - top) * i // count for i in range(count + 1)})
    return list(zip(edges, edges[1:]))


def measure_scene(program, scene):
    """What the model takes from a scene: the whole picture, and the costliest band of 10, of 100 and of 1000."""
    # Checkpoints of slow renderings would count as the cost of a shard
    common = ["--size", "{}x{}".format(*SIZE), "--spp", SAMPLES, "--checkpoint", 86400]
    pixels = SIZE[0] * SIZE[1]
    corner = program.render(scene, "corner.shard", *common, "--samples", "0..1", "--region", "0,0,16,16")
    whole = program.render(scene, "whole.shard", *common, "--samples", "1..2")
    result = {
        "prepare": corner["cpu"] - corner["rendering"],
        "sample": whole["rendering"],
        "whole": whole,
        "bytes": (program.directory / "whole.shard").stat().st_size,
        "pixels": pixels,
    }
    result["write"] = max(whole["cpu"] - whole["rendering"] - result["prepare"], 0.0)

    merge = lambda *parts: program.run("merge", "-q", "--allow-gaps", *parts)
    top, bottom = 0, SIZE[1]
    parent = whole
    result["bands"] = {"1": {"longest": whole["rendering"], "over": 1.0, "memory": whole["memory"]}}
    over = 1.0
    for count in WORKERS[1:]:
        rows = bands(top, bottom, 10)
        parts, times = [], []
        for y0, y1 in rows:
            parts.append(f"band-{count}-{y0}.shard")
            words = ["--samples", "0..1", "--region", f"0,{y0},{SIZE[0]},{y1}"]
            times.append(program.render(scene, parts[-1], *common, *words))
        if count == 10:
            merge("bands.shard", *parts)
        over *= sum(t["rendering"] for t in times) / parent["rendering"]
        longest = max(range(len(rows)), key=lambda i: times[i]["rendering"])
        top, bottom = rows[longest]
        parent = times[longest]
        result["bands"][str(count)] = {"longest": parent["rendering"], "over": over, "memory": parent["memory"]}

    one, two = merge("out.exr", "whole.shard"), merge("out.exr", "whole.shard", "bands.shard")
    few, many = merge("few.shard", parts[0]), merge("many.shard", *parts)
    bytes_of_small = (program.directory / parts[0]).stat().st_size
    result["merge"] = {
        "picture": one,
        "part": max(two - one, 0.0),
        "small part": max(many - few, 0.0) / (len(parts) - 1),
        "small bytes": bytes_of_small,
    }
    for path in program.directory.glob("*.shard"):
        path.unlink()
    return result


def measure(arguments):
    with tempfile.TemporaryDirectory(dir=arguments.directory) as directory:
        program = Program(arguments.program, directory)
        scenes = {}
        for text in arguments.scenes:
            path, _, mesh = text.partition("=")
            words = [pathlib.Path(path).resolve()]
            if mesh:
                words += ["--mesh", pathlib.Path(mesh).resolve()]
            scenes[pathlib.Path(mesh or path).stem] = words
        version = subprocess.run([program.path, "--version"], capture_output=True, text=True, check=True)
        result = {
            "version": version.stdout.strip(),
            "build": arguments.build,
            "day": datetime.date.today().isoformat(),
            "processors": os.cpu_count(),
            "start": min(program.run("--version") for _ in range(5)),
            "workers": {},
            "scenes": {},
        }
        loads = [os.getloadavg()[0]]

        def take(kind, name, function, scene):
            print(f"{name}: {kind}", file=sys.stderr)
            result[kind][name] = function(program, scene)
            loads.append(os.getloadavg()[0])

        for name, scene in scenes.items():
            take("scenes", name, measure_scene, scene)
        for name, scene in ({"marble": [ROOT / "scenes/marble.toml"]} | scenes).items():
            take("workers", name, measure_workers, scene)
        result["load"] = [min(loads), max(loads)]
    return result


def unevenness(scene):
    ten = scene["bands"]["10"]
    return 10 * ten["longest"] / (ten["over"] * scene["sample"])


def best_shards(scene):
    """The number of shards of samples, one for each worker, that is done soonest with one merge: W/N + N m is least."""
    part = scene["merge"]["part"] + scene["bytes"] / BYTES_PER_SECOND
    return math.sqrt(scene["sample"] * SAMPLES / part)


def model(scene, workers):
    """Seconds until the picture is there, and CPU seconds of all, of three divisions; and of one run."""
    m = scene["merge"]
    move = scene["bytes"] / BYTES_PER_SECOND
    work = scene["sample"] * SAMPLES
    one = scene["prepare"] + work + m["picture"]
    ready = scene["prepare"] + scene["write"]

    longest = scene["sample"] * math.ceil(SAMPLES / workers)
    # The first part is read in `picture`
    part = m["part"] + move
    serial = (workers - 1) * part + m["picture"] + move
    group = math.ceil(math.sqrt(workers))
    tree = 2 * (group - 1) * part + 2 * move + (scene["write"] + move) + m["picture"]
    by_samples = ready + longest + move
    cpu = workers * ready + work + (workers - 1) * m["part"] + m["picture"]
    cpu_tree = cpu + (group * (scene["write"] + m["part"]) if workers > 1 else 0.0)

    band = scene["bands"][str(workers)]
    scale = work / scene["bands"]["1"]["longest"]
    longest = scene["prepare"] + (scene["write"] + move) / workers + band["longest"] * scale
    merge_bands = (workers - 1) * m["small part"] + m["picture"] + move
    cpu_bands = workers * (scene["prepare"] + m["small part"]) + scene["write"] + work * band["over"] + m["picture"]
    result = {
        "one": one,
        "samples": (by_samples + serial, cpu),
        "tree": (by_samples + (tree if workers > 1 else serial), cpu_tree),
        "bands": (longest + merge_bands, cpu_bands),
        "merge": {"samples": serial, "tree": tree if workers > 1 else serial, "bands": merge_bands},
    }
    # Ten bands for each worker, who takes the next when it is free: at worst the costliest comes last
    fine = scene["bands"].get(str(10 * workers))
    if fine and workers > 1:
        shards = 10 * workers
        each = 10 * (scene["prepare"] + (scene["write"] + move) / shards)
        merge = (shards - 1) * m["small part"] + m["picture"] + move
        seconds = each + work * fine["over"] / workers + fine["longest"] * scale + merge
        cpu = shards * (scene["prepare"] + m["small part"]) + scene["write"] + work * fine["over"] + m["picture"]
        result["queue"] = (seconds, cpu)
        result["merge"]["queue"] = merge
    return result


DIVISIONS = {
    "samples": "samples, one merge",
    "tree": "samples, merged as a tree",
    "bands": "a band a worker",
    "queue": "ten bands a worker",
}


def row(*cells):
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def number(x):
    """Three digits."""
    if x == 0:
        return "0"
    if x >= 1000:
        return f"{x:.0f}"
    return f"{x:.{max(0, 2 - math.floor(math.log10(abs(x))))}f}"


def table(head, rows):
    return [row(*head), "|" + "---|" * len(head), *(row(*cells) for cells in rows), ""]


def page(result):
    """The tables as Markdown."""
    low, high = result["load"]
    scenes = result["scenes"]
    lines = [
        f"{result['version']}, built with Cargo's profile `{result['build']}`, on {result['day']}, "
        f"on a machine with {result['processors']} processors whose load was {low:.1f} to {high:.1f} meanwhile.",
        "",
        "One and two workers of one thread each, {}×{}, {} samples a pixel, merge included:".format(*SMALL_SIZE, SMALL_SAMPLES),
        "",
    ]
    rows = []
    for name, runs in result["workers"].items():
        one = runs["one run"]
        for what, t in runs.items():
            rows.append([
                name, what, number(t["all"]), number(t["all"] / one["all"]), number(t["longest"]),
                number(one["longest"] / t["longest"]), number(t["wall"]),
            ])
    head = ["scene", "what", "CPU s of all", "over one run", "CPU s of the longest way", "faster by", "wall s"]
    lines += table(head, rows)
    lines += ["What a shard of 3840×2160 costs, CPU seconds on one thread:", ""]
    rows = [["start of the program", *[number(result["start"])] * len(scenes)]]
    for what, value in (
        ("start, load and prepare the scene", lambda s: number(s["prepare"])),
        ("one sample of every pixel", lambda s: number(s["sample"])),
        ("write the shard, and what else grows with the film", lambda s: number(s["write"])),
        ("merge: a shard more (the largest of the scenes)", lambda s: number(s["merge"]["part"])),
        ("merge: a shard of {} rows more".format(math.ceil(SIZE[1] / WORKERS[-1])), lambda s: number(s["merge"]["small part"])),
        ("merge: read one, write picture and PNG", lambda s: number(s["merge"]["picture"])),
        ("bytes of the shard", lambda s: f"{s['bytes']:,}".replace(",", " ")),
        ("… a pixel", lambda s: number(s["bytes"] / s["pixels"])),
        ("memory of the worker, GiB", lambda s: number(s["whole"]["memory"] / 2**30)),
        ("… of a tenth of the rows", lambda s: number(s["bands"]["10"]["memory"] / 2**30)),
        ("… of a thousandth", lambda s: number(s["bands"]["1000"]["memory"] / 2**30)),
        ("ten bands: CPU of rendering over that of the whole", lambda s: number(s["bands"]["10"]["over"])),
        ("hundred", lambda s: number(s["bands"]["100"]["over"])),
        ("thousand", lambda s: number(s["bands"]["1000"]["over"])),
        ("ten bands: the costliest over their mean", lambda s: number(unevenness(s))),
    ):
        rows.append([what, *map(value, scenes.values())])
    lines += table(["", *scenes], rows)
    lines += [f"The model, 3840×2160 and {SAMPLES} samples a pixel:", ""]
    rows = []
    for name, scene in scenes.items():
        for workers in WORKERS:
            t = model(scene, workers)
            for key, words in DIVISIONS.items():
                if key in t and (workers > 1 or key == "samples"):
                    seconds, cpu = t[key]
                    rows.append([
                        name, workers, words if workers > 1 else "one shard", number(seconds),
                        number(t["one"] / seconds), number(cpu / t["one"]), number(t["merge"][key]),
                    ])
    head = ["scene", "workers", "division", "seconds", "faster by", "CPU over one run", "of the seconds, merge"]
    lines += table(head, rows)
    best = ", ".join(f"{name} {best_shards(scene):.0f}" for name, scene in scenes.items())
    return [*lines, f"Shards of samples with which one merge is done soonest, the root of all rendering over merging one shard more: {best}.", ""]


def draw(result, path):
    import matplotlib

    matplotlib.use("svg")
    from matplotlib import pyplot

    pyplot.rcParams.update({"svg.hashsalt": "translucid", "svg.fonttype": "path", "font.size": 9})
    scenes = result["scenes"]
    figure, axes = pyplot.subplots(2, len(scenes), figsize=(4.4 * len(scenes), 6.4), sharex=True, squeeze=False)
    for column, (name, scene) in enumerate(scenes.items()):
        up, down = axes[:, column]
        up.plot(WORKERS, WORKERS, color="0.7", linewidth=1, label="ideal")
        for (key, words), style in zip(DIVISIONS.items(), ("o-", "s--", "^-", "d:")):
            times = {workers: model(scene, workers) for workers in WORKERS}
            times = {workers: t for workers, t in times.items() if key in t}
            up.plot(list(times), [t["one"] / t[key][0] for t in times.values()], style, label=words)
            down.plot(list(times), [t[key][1] / t["one"] for t in times.values()], style, label=words)
        up.set(xscale="log", yscale="log", title=f"{name}, 3840×2160, {SAMPLES} samples")
        down.set(xscale="log", xlabel="workers of one thread", ylim=(0, None))
        for axis in (up, down):
            axis.grid(alpha=0.3)
    axes[0, 0].set_ylabel("faster than one run by")
    axes[1, 0].set_ylabel("CPU seconds over one run")
    axes[0, 0].legend(frameon=False)
    note = (
        f"A model: CPU seconds measured on one thread, {BYTES_PER_SECOND / 1e9:g} GB/s to write or read shards, "
        "all workers start at once"
    )
    figure.text(0.5, 0.005, note, ha="center", fontsize=7.5)
    figure.tight_layout(rect=(0, 0.02, 1, 1))
    figure.savefig(path, metadata={"Date": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=ROOT / "target/release/translucid", type=pathlib.Path)
    parser.add_argument("--build", default="release", help="Cargo's profile of the program, for the page")
    parser.add_argument("--directory", help="where shards lie meanwhile, up to 5 GB")
    parser.add_argument("--keep", type=pathlib.Path, metavar="FILE")
    parser.add_argument("--from", dest="kept", type=pathlib.Path, metavar="FILE")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("scenes", nargs="*", metavar="SCENE[=MESH]")
    arguments = parser.parse_args()
    if not arguments.kept and not arguments.scenes:
        parser.error("name a scene, or --from what was measured")
    result = json.loads(arguments.kept.read_text()) if arguments.kept else measure(arguments)
    # It depends on the film alone, and is a small difference of two merges: the largest is the least in doubt
    part = max(scene["merge"]["part"] for scene in result["scenes"].values())
    for scene in result["scenes"].values():
        scene["merge"]["part"] = part
    if arguments.keep:
        arguments.keep.write_text(json.dumps(result, indent=1) + "\n")
    text = "\n".join(page(result))
    print(text)
    if arguments.write:
        before, mark, rest = PAGE.read_text().partition(MARKS[0])
        _, end, after = rest.partition(MARKS[1])
        if not mark or not end:
            sys.exit(f"{PAGE} lacks the lines {MARKS[0]} and {MARKS[1]}")
        PAGE.write_text(f"{before}{mark}\n\n{text}\n{end}{after}")
        draw(result, FIGURE)


if __name__ == "__main__":
    main()
