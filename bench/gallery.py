#!/usr/bin/env python3
"""Textures scans from swatches by every method, and writes a page that shows the pictures side by side
with their scores and times.

    bench/gallery.py OUT_FOLDER [--scans FILE...] [--z-up FILE...] [--swatches FILE...]
                     [--methods NAME...] [--points N]

What is in OUT_FOLDER already is not made again, so that a gallery can be stopped and gone on with;
delete a folder of it to have its pictures made anew. Open OUT_FOLDER/index.html.
"""

import argparse
import html
import json
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
METHODS = ["triplanar", "match", "grid", "patches", "hybrid", "mapping", "tiling", "coordinates",
           "auto"]
STYLE = """
body { font: 14px sans-serif; background: #1b1c1e; color: #ddd; margin: 2em }
table { border-collapse: collapse } td, th { padding: 4px 8px; text-align: left; vertical-align: top }
img.result { width: 320px; background: #fff } img.swatch { image-rendering: pixelated; max-width: 128px }
.best { color: #f0a048; font-weight: bold } .figure { font-variant-numeric: tabular-nums }
"""


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/release/dapple")
    parser.add_argument("--scans", type=pathlib.Path, nargs="+",
                        default=[ROOT / "assets/scans/creature.ply"])
    parser.add_argument("--z-up", type=pathlib.Path, nargs="+", default=[],
                        help="more scans, whose z axis points up")
    parser.add_argument("--swatches", type=pathlib.Path, nargs="+",
                        default=sorted((ROOT / "assets/swatches").glob("*.png")))
    parser.add_argument("--methods", nargs="+", default=METHODS)
    parser.add_argument("--points", type=int, default=85000, help="spread over a mesh (0: its vertices)")
    parser.add_argument("--option", action="append", default=[], help="more for `dapple texture`")
    return parser.parse_args()


def texture(given, scan, swatch, method):
    """The report of one run, or None when the program refused: the reason is in its .log."""
    base = given.out / scan.stem / swatch.stem / method
    report = base.with_suffix(".json")
    if not report.exists():
        base.parent.mkdir(parents=True, exist_ok=True)
        command = [given.program, "texture", scan, "--swatch", swatch, "--method", method,
                   "-o", base.with_suffix(".ply"), "--picture", base.with_suffix(".png"),
                   "--report", report, "--quiet", *given.option]
        if scan in given.z_up:
            command.append("--z-up")
        if given.points and scan.suffix in (".ply", ".obj"):
            command += ["--samples", str(given.points)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode == 2 and "--samples" in command:  # a cloud has no area to spread points over
            at = command.index("--samples")
            done = subprocess.run(command[:at] + command[at + 2:], capture_output=True, text=True,
                                  check=False)
        base.with_suffix(".ply").unlink(missing_ok=True)
        base.with_suffix(".log").write_text(done.stderr)
        if done.returncode != 0:
            return None
    return json.loads(report.read_text())


def number(value, digits=2):
    return "-" if value is None else f"{value:.{digits}f}"


def cell(given, scan, swatch, method, report, best):
    if report is None:
        return "<td>refused</td>"
    score = report["score"]
    picture = f"{scan.stem}/{swatch.stem}/{method}.png"
    kind = "best" if score["F"] == best else ""
    return (f'<td><a href="{picture}"><img class="result" loading="lazy" src="{picture}"></a><br>'
            f'<span class="figure {kind}">F {number(score["F"])}, oriented '
            f'{number(score["F_oriented"])}</span>; {number(report["seconds"]["synthesis"])} s</td>')


def copied(given, swatch):
    folder = given.out / "swatches"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / swatch.name).write_bytes(swatch.read_bytes())
    return f"swatches/{swatch.name}"


def page(given, reports):
    lines = [f"<!doctype html><meta charset=utf-8><title>Dapple: gallery</title><style>{STYLE}</style>",
             "<h1>Every method on every swatch</h1>",
             "<p>F: 0 worst, 1 best; seconds of the synthesis alone.</p>", "<table><tr><th>mean F"]
    for method in given.methods:
        scores = [r["score"]["F"] for key, r in reports.items() if key[2] == method and r]
        mean = number(statistics.mean(scores), 3) if scores else "-"
        worst = number(min(scores), 3) if scores else "-"
        lines.append(f"<tr><td>{html.escape(method)}<td>{mean}, worst {worst} of {len(scores)}")
    lines.append("</table>")
    for scan in given.scans:
        lines.append(f"<h2>{html.escape(scan.stem)}</h2><table><tr><th>swatch")
        lines += [f"<th>{html.escape(method)}" for method in given.methods]
        for swatch in given.swatches:
            row = [reports[scan, swatch, method] for method in given.methods]
            best = max((r["score"]["F"] for r in row if r), default=None)
            lines.append(f'<tr><td><img class="swatch" src="{copied(given, swatch)}"><br>{swatch.stem}')
            lines += [cell(given, scan, swatch, method, report, best)
                      for method, report in zip(given.methods, row)]
        lines.append("</table>")
    (given.out / "index.html").write_text("\n".join(lines) + "\n")


def main():
    given = arguments()
    if not given.program.exists():
        sys.exit(f"{given.program} is not there: build it first, or name it with --program")
    given.scans += given.z_up
    reports = {}
    todo = [(scan, swatch, method) for scan in given.scans for swatch in given.swatches
            for method in given.methods]
    for done, key in enumerate(todo, 1):
        scan, swatch, method = key
        reports[key] = texture(given, *key)
        score = number(reports[key]["score"]["F"]) if reports[key] else "refused"
        print(f"{done}/{len(todo)} {scan.stem} {swatch.stem} {method}: {score}", flush=True)
    page(given, reports)
    print(given.out / "index.html")


if __name__ == "__main__":
    main()
