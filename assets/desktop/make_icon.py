#!/usr/bin/env python3
"""Draws Dapple's icon: a sphere of splats, bare scan points on one side, dappled on the other.

usage: make_icon.py    writes icons/org.dapple.Dapple.svg and icons/SIZE.png beside this script
The PNG files are the SVG as rsvg-convert draws it (Debian's librsvg2-bin).
"""
import math
import pathlib
import subprocess

APPLICATION = "org.dapple.Dapple"
SIZES = (48, 64, 128, 256, 512)
CANVAS = 512
CENTRE = (256.0, 256.0)
RADIUS = 224.0
SPLATS = 620  # over the whole sphere: at 48 pixels a splat is still two pixels wide
SPLAT_RADIUS = 1.24  # in spacings: neighbours overlap and hide the ground
POINT_RADIUS = 0.46  # of bare points: they stay apart
LIGHT = (-0.48, -0.62, 0.62)
GROWTH = (-0.62, 0.30, 0.50)  # the texture has spread from here ...
FRONT = 0.02  # ... to where the cosine is this
SHADE = (16, 38, 58)
BARE = (214, 226, 238)
GROUND = ((13, 116, 125), (24, 148, 148))
SPOT = ((255, 183, 77), (255, 224, 158))

# Spots are written down, not random: at 48 pixels each has to sit well.
SPOTS = [
    # x, y (right, down; in radii), angular radius
    (-0.40, -0.50, 0.25),
    (0.16, -0.68, 0.20),
    (-0.82, -0.06, 0.25),
    (-0.36, 0.12, 0.24),
    (0.16, -0.12, 0.23),
    (-0.58, 0.56, 0.25),
    (0.06, 0.62, 0.25),
    (0.45, 0.28, 0.18),
    (-0.16, 0.96, 0.18),
    (-0.30, -0.94, 0.18),
]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def normalised(a):
    length = math.sqrt(dot(a, a))
    return tuple(x / length for x in a)


def mixed(a, b, share):
    return tuple(x + (y - x) * share for x, y in zip(a, b))


def stepped(low, high, x):
    t = min(max((x - low) / (high - low), 0.0), 1.0)
    return t * t * (3 - 2 * t)


def noise(index, salt):
    """A number from 0 to 1, the same in every run."""
    return math.modf(abs(math.sin(index * 12.9898 + salt * 78.233)) * 43758.5453)[0]


def sphere_points():
    """Evenly spread unit vectors: x right, y down, z to the eye; the spiral's axis tilted away."""
    turn = math.pi * (3 - math.sqrt(5))
    cos, sin = math.cos(0.55), math.sin(0.55)
    for i in range(SPLATS):
        up = 1 - (2 * i + 1) / SPLATS
        r = math.sqrt(1 - up * up)
        x, y, z = r * math.cos(i * turn), up, r * math.sin(i * turn)
        yield i, (x, y * cos - z * sin, y * sin + z * cos)


def in_spot(normal):
    for x, y, radius in SPOTS:
        centre = (x, y, math.sqrt(max(0.0, 1 - x * x - y * y)))
        if dot(normal, normalised(centre)) > math.cos(radius):
            return True
    return False


def splat_colour(index, normal, textured):
    shine = noise(index, 1)
    dappled = mixed(*(SPOT if in_spot(normal) else GROUND), shine)
    flat = dappled if textured else mixed(BARE, (255, 255, 255), 0.25 * shine)
    light = max(0.0, dot(normal, normalised(LIGHT)))
    lit = mixed(SHADE, flat, 0.42 + 0.58 * stepped(-0.1, 0.85, light))
    return mixed(lit, (255, 255, 255), 0.35 * light**14)


def splats():
    """(depth, centre x, centre y, long radius, short radius, degrees, colour), back to front."""
    spacing = math.sqrt(4 * math.pi / SPLATS)
    drawn = []
    for index, normal in sphere_points():
        textured = dot(normal, normalised(GROWTH)) + 0.10 * (noise(index, 2) - 0.5) > FRONT
        # Those past the outline are drawn only where they peep out and round it.
        if normal[2] < (-0.06 if textured else 0.06):
            continue
        size = spacing * (SPLAT_RADIUS if textured else POINT_RADIUS)
        reach = 1 - size * 0.45 * (1 - normal[2])  # keeps the outline a circle
        x, y = (c + RADIUS * reach * n for c, n in zip(CENTRE, normal))
        long = RADIUS * size * 0.62
        short = long * max(0.30, normal[2])
        degrees = math.degrees(math.atan2(normal[1], normal[0])) + 90
        drawn.append((normal[2], x, y, long, short, degrees, splat_colour(index, normal, textured)))
    return sorted(drawn)


def svg():
    ball = f'cx="{CENTRE[0]:g}" cy="{CENTRE[1]:g}" r="{RADIUS - 5:g}"'
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{CANVAS}" height="{CANVAS}" '
        f'viewBox="0 0 {CANVAS} {CANVAS}">',
        "<title>Dapple</title>",
        '<radialGradient id="ball" cx="0.34" cy="0.28" r="0.85">'
        '<stop offset="0" stop-color="#5d7c9a"/><stop offset="1" stop-color="#23384f"/>'
        "</radialGradient>",
        f'<circle {ball} fill="url(#ball)"/>',
    ]
    for _, x, y, long, short, degrees, colour in splats():
        shade = "".join(f"{round(min(max(c, 0), 255)):02x}" for c in colour)
        lines.append(
            f'<ellipse rx="{long:.1f}" ry="{short:.1f}" fill="#{shade}" '
            f'transform="translate({x:.1f} {y:.1f}) rotate({degrees:.0f})"/>'
        )
    return "\n".join(lines + ["</svg>", ""])


def main():
    folder = pathlib.Path(__file__).resolve().parent / "icons"
    folder.mkdir(exist_ok=True)
    drawing = folder / f"{APPLICATION}.svg"
    drawing.write_text(svg(), encoding="utf-8")
    for size in SIZES:
        picture = folder / f"{size}.png"
        subprocess.run(
            ["rsvg-convert", "-w", str(size), "-h", str(size), "-o", picture, drawing], check=True
        )


if __name__ == "__main__":
    main()
