#!/usr/bin/env python3
"""Makes the swatches in assets/swatches (needs numpy; Debian: python3-numpy).

usage: python3 assets/make_swatches.py [NAME...]      without names, all of them

Everything is drawn at 4 x 4 samples a pixel in linear light on a torus, so that a swatch tiles
unless it is cut out of a larger drawing. The same script always writes the same pictures.
"""
import pathlib
import struct
import sys
import zlib

import numpy as np

SAMPLES = 4  # per pixel, along x and along y
FOLDER = pathlib.Path(__file__).resolve().parent / "swatches"


# ---- files ---------------------------------------------------------------------------------------
def write_png(path, pixels):
    """h x w (grey) or h x w x 3 or 4 (RGB, RGBA), uint8 or uint16."""
    height, width = pixels.shape[:2]
    channels = 1 if pixels.ndim == 2 else pixels.shape[2]
    depth = 8 * pixels.dtype.itemsize
    rows = np.ascontiguousarray(pixels.astype(">u2") if depth == 16 else pixels)
    rows = rows.view(np.uint8).reshape(height, -1).astype(np.int16)
    stride = channels * depth // 8
    left, up = np.zeros_like(rows), np.zeros_like(rows)
    left[:, stride:], up[1:] = rows[:, :-stride], rows[:-1]
    filtered = np.stack([rows, rows - left, rows - up, rows - (left + up) // 2]).astype(np.uint8)
    cost = np.abs(filtered.view(np.int8).astype(np.int32)).sum(axis=2)
    best = cost.argmin(axis=0)  # the usual heuristic: least sum of absolute differences
    data = b"".join(bytes([best[y]]) + filtered[best[y], y].tobytes() for y in range(height))

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    colour_type = {1: 0, 3: 2, 4: 6}[channels]
    header = struct.pack(">IIBBBBB", width, height, depth, colour_type, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header)
                     + chunk(b"IDAT", zlib.compress(data, 9)) + chunk(b"IEND", b""))


# ---- colour --------------------------------------------------------------------------------------
def linear(*codes):
    """Linear RGB of "#rrggbb" codes: n x 3, or 3 for one code."""
    srgb = np.array([[int(c[i:i + 2], 16) / 255 for i in (1, 3, 5)] for c in codes])
    rgb = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    return rgb if len(codes) > 1 else rgb[0]


def encode(image):
    """Linear light, 4 x 4 samples a pixel, to sRGB in 0..1, one sample a pixel."""
    h, w = image.shape[0] // SAMPLES, image.shape[1] // SAMPLES
    mean = image.reshape(h, SAMPLES, w, SAMPLES, -1).mean(axis=(1, 3)).clip(0, 1)
    return np.where(mean <= 0.0031308, 12.92 * mean, 1.055 * mean ** (1 / 2.4) - 0.055)


def to_bytes(values):
    return np.rint(values * 255).astype(np.uint8)


def mix(a, b, t):
    t = np.asarray(t)[..., None]
    return a + (b - a) * t


def step(low, high, x):
    """Smooth step from 0 at `low` to 1 at `high`."""
    t = ((x - low) / (high - low)).clip(0, 1)
    return t * t * (3 - 2 * t)


# ---- drawing on a torus --------------------------------------------------------------------------
class Canvas:
    """w x h pixels whose opposite borders meet. All lengths are in pixels of the swatch."""

    def __init__(self, width, height, seed):
        self.w, self.h = width, height
        self.rng = np.random.Generator(np.random.PCG64(seed))
        self.x, self.y = np.meshgrid((np.arange(width * SAMPLES) + 0.5) / SAMPLES,
                                     (np.arange(height * SAMPLES) + 0.5) / SAMPLES)
        fx = np.fft.rfftfreq(width * SAMPLES, 1 / SAMPLES)
        fy = np.fft.fftfreq(height * SAMPLES, 1 / SAMPLES)
        self.fx, self.fy = np.meshgrid(fx, fy)

    def filter(self, field, response):
        return np.fft.irfft2(np.fft.rfft2(field) * response, s=field.shape)

    def blur(self, field, sigma):
        return self.filter(field, np.exp(-2 * (np.pi * sigma) ** 2 * (self.fx ** 2 + self.fy ** 2)))

    def noise(self, size, fall=None, stretch=(1, 1)):
        """Mean 0, deviation 1; blobs of about `size`, smooth, or fractal with spectrum f^-fall."""
        f2 = (self.fx * stretch[0]) ** 2 + (self.fy * stretch[1]) ** 2
        if fall is None:
            response = np.exp(-2 * (np.pi * 0.3 * size) ** 2 * f2)
        else:
            response = (f2 + size ** -2) ** (-fall / 2)
        response[0, 0] = 0
        field = self.filter(self.rng.standard_normal(self.x.shape), response)
        return field / field.std()

    def apart(self, dx, dy):
        """Shortest way on the torus."""
        return dx - self.w * np.rint(dx / self.w), dy - self.h * np.rint(dy / self.h)

    def scatter(self, count, least):
        """Positions at least `least` apart, or as many as find a place."""
        placed = np.empty((0, 2))
        for p in self.rng.random((60 * count, 2)) * (self.w, self.h):
            dx, dy = self.apart(placed[:, 0] - p[0], placed[:, 1] - p[1])
            if len(placed) < count and (dx * dx + dy * dy >= least * least).all():
                placed = np.vstack([placed, p])
        return placed

    def cells(self, sites, roundness, warp=(0, 0), weights=None):
        """Voronoi cells: id of the cell, distance to its rim (corners rounded), offset from its site."""
        x, y = self.x + warp[0], self.y + warp[1]
        strips = range(0, len(x), 32)  # keeps the tables of all sites small
        parts = [self._cells(x[r:r + 32], y[r:r + 32], sites, roundness, weights) for r in strips]
        return tuple(np.concatenate(column) for column in zip(*parts))

    def _cells(self, x, y, sites, roundness, weights):
        dx, dy = self.apart(x[..., None] - sites[:, 0], y[..., None] - sites[:, 1])
        power = dx * dx + dy * dy - (0 if weights is None else weights)
        near = np.argpartition(power, 9, axis=2)[..., :10]
        power, dx, dy = (np.take_along_axis(a, near, 2) for a in (power, dx, dy))
        first = power.argmin(axis=2)[..., None]
        own, own_x, own_y = (np.take_along_axis(a, first, 2) for a in (power, dx, dy))
        between = np.hypot(dx - own_x, dy - own_y)
        rim = (power - own) / (2 * np.maximum(between, 1e-6))
        others = np.where(between > 1e-6, np.exp(-rim / roundness), 0).sum(axis=2)
        ids = np.take_along_axis(near, first, 2)[..., 0]
        return ids, -roundness * np.log(others), own_x[..., 0], own_y[..., 0]

    def slopes(self, height):
        gx = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) * (SAMPLES / 2)
        gy = (np.roll(height, -1, 0) - np.roll(height, 1, 0)) * (SAMPLES / 2)
        return gx, gy

    def light(self, height, towards=(-0.4, -0.6, 1.0), shine=0.0, gloss=30, hollow=2.0, depth=1.0):
        """(diffuse with darkened hollows, highlight) of a height field seen from above."""
        gx, gy = self.slopes(height)
        n = np.stack([-gx, -gy, np.ones_like(gx)], axis=2)
        n /= np.linalg.norm(n, axis=2, keepdims=True)
        towards = np.array(towards) / np.linalg.norm(towards)
        half = towards + (0, 0, 1)
        half /= np.linalg.norm(half)
        diffuse = (n @ towards).clip(0) / towards[2]
        shade = np.exp(np.minimum((height - self.blur(height, hollow)) * depth, 0))
        return diffuse * shade, shine * (n @ half).clip(0) ** gloss


def hash_of(ids, rng, *shape):
    """A random value for each id, spread over the picture."""
    return rng.random((int(ids.max()) + 1, *shape))[ids]


# ---- the swatches --------------------------------------------------------------------------------
def pebbles():
    c = Canvas(128, 128, 11)
    sites = c.scatter(52, 13.5)
    size = c.rng.uniform(-40, 40, len(sites))
    warp = (1.3 * c.noise(14), 1.3 * c.noise(14))
    ids, rim, ox, oy = c.cells(sites, 1.5, warp, size)
    palette = linear("#8d8f94", "#6d7681", "#b9b2a6", "#d8d2c6", "#a06a4e", "#7b4a3a", "#c39a6b",
                     "#566069", "#9aa7a4", "#efe9dd", "#3f464f", "#b4836a")
    kind = np.arange(len(sites)) % len(palette)
    c.rng.shuffle(kind)
    colour = palette[kind][ids] * (0.85 + 0.3 * hash_of(ids, c.rng, 1))
    inside = ((rim - 0.3) / 6.0).clip(0, 1)
    height = 5.5 * np.sqrt(1 - (1 - inside) ** 2.4) + 0.10 * c.noise(3, 1.2) * (inside > 0)
    # Bands across some stones, specks on others.
    angle = 2 * np.pi * hash_of(ids, c.rng)
    along = ox * np.cos(angle) + oy * np.sin(angle) + 0.9 * c.noise(9)
    banded = hash_of(ids, c.rng) < 0.3
    centre = 5 * (hash_of(ids, c.rng) - 0.5)
    vein = np.exp(-((along - centre) / 0.75) ** 2) + 0.6 * np.exp(-((along - centre - 3) / 0.4) ** 2)
    colour = mix(colour, linear("#f3efe6"), 0.75 * vein.clip(0, 1) * banded)
    speck = step(0.9, 1.7, c.noise(1.6)) * (hash_of(ids, c.rng) < 0.5)
    colour = mix(colour, 0.35 * colour, 0.7 * speck)
    colour *= (1 + 0.13 * c.noise(7, 1.5))[..., None].clip(0.5, 1.6)
    diffuse, shine = c.light(height, (-0.35, -0.5, 1.0), shine=0.16, gloss=26, hollow=3.0, depth=0.30)
    sand = linear("#2b241d") * (1 + 0.35 * c.noise(1.2))[..., None].clip(0.2, 2)
    image = mix(sand, colour * diffuse[..., None] * 1.1 + shine[..., None], step(0.0, 0.06, inside))
    return to_bytes(encode(image))


def leopard():
    c = Canvas(128, 124, 23)
    sites = c.scatter(36, 16.5)
    warp = (1.6 * c.noise(18) + 0.45 * c.noise(6), 1.6 * c.noise(18) + 0.45 * c.noise(6))
    ids, rim, _, _ = c.cells(sites, 2.6, warp, c.rng.uniform(-30, 30, len(sites)))
    # A rosette is a broken dark ring around a centre that is darker than the ground.
    ring_at = 3.4 + 0.7 * hash_of(ids, c.rng)
    thick = 1.35 + 0.45 * c.noise(8) - 2.4 * (c.noise(9) - 0.7).clip(0)
    ring = step(-0.5, 0.6, thick - np.abs(rim - ring_at))
    spots = step(0.75, 1.3, -rim + 0.5 * c.noise(7))
    dark = np.maximum(ring, spots)
    hair = c.noise(1.3, 1.4, (1.0, 0.16))
    ground = mix(linear("#d9a04e"), linear("#efc98a"), step(-1.2, 1.4, c.noise(40)))
    coat = mix(ground, linear("#b0702c"), 0.9 * step(-0.8, 1.0, rim - ring_at))
    coat = mix(coat, linear("#1a0f08"), (dark + 0.10 * hair * (dark > 0.02)).clip(0, 1))
    coat *= (1 + 0.17 * hair)[..., None].clip(0.4, 1.7)
    return to_bytes(encode(coat))


def bricks():
    c = Canvas(144, 128, 5)
    across, down = 36.0, 16.0
    warp_x, warp_y = 0.55 * c.noise(10, 1.6), 0.55 * c.noise(10, 1.6)
    row = np.floor((c.y + warp_y) / down).astype(int) % 8
    shift = across * (0.5 * (np.arange(8) % 2) + c.rng.uniform(-0.07, 0.07, 8))
    u = c.x + warp_x + shift[row]
    column = np.floor(u / across).astype(int) % 4
    ids = row * 4 + column
    # Signed distance to a rounded rectangle that differs a little from brick to brick.
    half_x = across / 2 - 1.1 - 0.7 * hash_of(ids, c.rng)
    half_y = down / 2 - 1.0 - 0.6 * hash_of(ids, c.rng)
    px = np.abs((u % across) - across / 2) - half_x + 2.2
    py = np.abs(((c.y + warp_y) % down) - down / 2) - half_y + 2.2
    inside = 2.2 - np.hypot(px.clip(0), py.clip(0)) - np.minimum(np.maximum(px, py), 0)
    inside += 0.35 * c.noise(3, 1.4)
    palette = linear("#9c4a33", "#b35a3c", "#8a3b2c", "#c2714a", "#7a3a34", "#a9553f", "#5e3231",
                     "#c98a62")
    kind = c.rng.choice(8, 32, p=[0.2, 0.2, 0.16, 0.12, 0.1, 0.12, 0.05, 0.05])
    colour = palette[kind][ids] * (0.88 + 0.24 * hash_of(ids, c.rng, 1))
    colour = mix(colour, 0.45 * colour, 0.8 * step(0.3, 1.9, c.noise(12, 1.8)))
    colour = mix(colour, linear("#d8b79c"), 0.30 * step(0.6, 2.0, c.noise(6, 1.7)))
    pits = step(1.3, 2.0, c.noise(1.8))
    height = 2.6 * step(-0.2, 2.2, inside) + 0.16 * c.noise(4, 1.5) - 0.5 * pits * (inside > 0.5)
    mortar = linear("#b8b0a2") * (0.72 + 0.12 * c.noise(1.5, 1.0))[..., None].clip(0.3, 1.2)
    diffuse, _ = c.light(height, (-0.45, -0.75, 1.0), hollow=1.6, depth=0.5)
    colour *= (1 + 0.12 * c.noise(1.6, 0.9))[..., None].clip(0.5, 1.6)
    image = mix(mortar, colour, step(-0.15, 0.35, inside))
    return to_bytes(encode(image * diffuse[..., None]))


def scales():
    c = Canvas(128, 128, 37)
    across, down = 16.0, 8.0
    warp_x, warp_y = 0.7 * c.noise(24), 0.7 * c.noise(24)
    x, y = c.x + warp_x, c.y + warp_y
    best, height, ids = np.full(x.shape, -1.0), np.zeros(x.shape), np.zeros(x.shape, int)
    keel_x, keel_y = np.zeros(x.shape), np.zeros(x.shape)
    # Each row of scales covers the bases of the row below it: the topmost one that reaches wins.
    for back in (3, 2, 1, 0):
        row = np.floor(y / down).astype(int) - back
        shift = 0.5 * across * (row % 2)
        column = np.floor((x + shift) / across).astype(int)
        u = ((x + shift) % across) / across * 2 - 1
        v = (y - row * down) / (down * 2.62)
        body = 1 - (np.abs(u) / 1.02) ** 2.2 - (v.clip(0) * 1.02) ** 3.0 * (1 + 0.9 * np.abs(u))
        take = (body > 0) & (v >= 0) & (best < 0)
        best = np.where(take, 1.0, best)
        dome = np.sqrt(body.clip(0, 1))
        height = np.where(take, 2.8 * dome + 2.4 * v + 0.7 * np.exp(-(u / 0.16) ** 2), height)
        ids = np.where(take, (row % 16) * 8 + column % 8, ids)
        keel_x, keel_y = np.where(take, u, keel_x), np.where(take, v, keel_y)
    # The pattern is decided scale by scale, so that none is of two colours.
    centre_row, centre_column = np.divmod(np.arange(128), 8)
    at_x = ((centre_column + 0.5 - 0.5 * (centre_row % 2)) * across * SAMPLES).astype(int) % x.shape[1]
    at_y = ((centre_row + 1) * down * SAMPLES).astype(int) % x.shape[0]
    broad = c.noise(30)[at_y, at_x] + 0.25 * c.rng.standard_normal(128)
    skin = linear("#3a6a3c", "#6a9a3f", "#a3bd4e", "#e0cf74", "#1f3a33")
    level = np.interp(broad, [-1.1, -0.6, 0.1, 0.8, 1.5], [4, 0, 1, 2, 3])
    table = np.stack([np.interp(level, [0, 1, 2, 3, 4], skin[:, k]) for k in range(3)], axis=1)
    colour = table[ids] * (0.85 + 0.3 * hash_of(ids, c.rng, 1))
    colour = mix(colour, linear("#1c2412"), 0.55 * step(0.55, 0.15, keel_y))
    colour = mix(colour, linear("#e9e2a8"), 0.35 * np.exp(-(keel_x / 0.22) ** 2) * step(0.3, 0.8, keel_y))
    colour *= (1 + 0.10 * c.noise(2, 1.2))[..., None].clip(0.5, 1.5)
    diffuse, shine = c.light(height + 0.05 * c.noise(2, 1), (0.0, -0.55, 1.0), shine=0.28, gloss=30,
                             hollow=2.0, depth=0.9)
    return to_bytes(encode(colour * diffuse[..., None] + shine[..., None]))


def knit():
    c = Canvas(144, 120, 41)
    wide, tall = 9.0, 7.5  # one stitch; 16 x 16 of them
    x, y = c.x + 0.25 * c.noise(9), c.y + 0.25 * c.noise(9)
    motif = ["................", "x.......x.......", ".o.....o.o.....o", "..o...o...o...o.",
             "...o.o.....o.o..", "x...r...x...r...", "...r.r.....r.r..", "..r.x.r...r.x.r.",
             "...r.r.....r.r..", "x...r...x...r...", "...o.o.....o.o..", "..o...o...o...o.",
             ".o.....o.o.....o", "x.......x.......", "................", "xx..xx..xx..xx.."]
    yarns = {".": 0, "x": 1, "o": 2, "r": 3}
    wool = linear("#efe6d2", "#24385c", "#3f7d86", "#b23a35")
    pattern = np.array([[yarns[s] for s in line] for line in motif])
    height, ids, twist = np.zeros(x.shape), np.zeros(x.shape, int), np.zeros(x.shape)
    for below in (0, 1):  # a leg of a stitch reaches up into the row above
        row = np.floor(y / tall).astype(int) + below
        column = np.floor(x / wide).astype(int)
        u = (x / wide - column) * 2 - 1
        v = (y - row * tall) / tall  # 0 at the top of the stitch's own row
        side = np.sign(u)
        # Each leg is a thick slanted ellipse; both meet at the foot: a V.
        lx = (np.abs(u) - 0.5) * wide / 2 + (v - 0.35) * 1.7
        ly = (v - 0.35) * tall - 0.25 * lx
        body = 1 - (lx / 2.25) ** 2 - (ly / 5.6) ** 2
        leg = 2.4 * np.sqrt(body.clip(0)) + (0.5 * v if below == 0 else 0.0)
        take = (body > 0) & (leg > height)
        height = np.where(take, leg, height)
        ids = np.where(take, pattern[row % 16, column % 16], ids)
        twist = np.where(take, np.sin(2 * np.pi * (0.42 * ly + side * 0.0 + 0.34 * lx)), twist)
    fuzz = c.noise(1.0, 1.0)
    colour = wool[ids] * (0.96 + 0.10 * twist + 0.09 * fuzz)[..., None].clip(0.4, 1.4)
    diffuse, _ = c.light(height + 0.16 * twist + 0.08 * fuzz, (-0.2, -0.45, 1.0), hollow=1.7, depth=0.75)
    dark = 0.12 + 0.88 * step(0.0, 1.0, height)
    image = encode(colour * (diffuse * dark)[..., None])
    return to_bytes(np.roll(image, (4, 2), (0, 1)))  # no border runs between stitches


def wood():
    c = Canvas(128, 192, 53)
    x = c.x + 0.9 * c.noise(30) + 0.35 * c.noise(5, None, (1, 10))
    y = c.y
    # A plank cuts the cone of the tree's rings beside its axis; a knot bends them.
    knot = np.exp(-((x - 88) ** 2 + ((y - 70) / 1.5) ** 2) / 15 ** 2)
    radius = np.hypot(x - 48, 10 + 0.30 * (y + 12)) + 3.5 * c.noise(70) + 21 * knot
    ring = radius / 6.2 + 0.9 * np.sin(radius / 23)
    t = ring % 1
    late = step(0.25, 0.93, t) * step(1.0, 0.955, t)
    year = np.floor(ring).astype(int)
    late *= 0.55 + 0.45 * hash_of(year - year.min(), c.rng)
    colour = mix(linear("#e0b27a"), linear("#8a4a20"), late)
    colour = mix(colour, linear("#4a2412"), 0.85 * step(0.80, 0.97, knot))
    colour = mix(colour, linear("#b4713a"), 0.45 * step(0.25, 0.75, knot) * step(0.99, 0.9, knot))
    fibre = c.noise(1.1, 1.2, (1, 18))
    pores = step(1.35, 2.2, c.noise(0.9, None, (1, 9)))
    colour = mix(colour, linear("#50290f"), 0.6 * pores * (0.35 + 0.65 * late))
    colour *= (1 + 0.10 * fibre + 0.06 * c.noise(45))[..., None].clip(0.5, 1.5)
    silk = 1 + 0.07 * c.noise(16, None, (0.5, 2.5))
    return to_bytes(encode(colour * silk[..., None]))


def lichen():
    c = Canvas(160, 160, 61)
    grain = c.noise(2.2, 1.1)
    stone = mix(linear("#4d4c4e"), linear("#7d7871"), step(-1.6, 1.6, c.noise(30, 1.9)))
    stone = mix(stone, linear("#b9b3aa"), 0.6 * step(1.1, 2.0, c.noise(1.7)))
    stone = stone * (1 + 0.22 * grain)[..., None].clip(0.35, 1.8)
    height = 0.5 * c.noise(6, 1.7)
    lobes, frill, crumbs = c.noise(9), c.noise(3.2), c.noise(1.5)
    kinds = [("#a9b79a", "#dfe5cf", "#5d6b58", 23), ("#8fa39a", "#cfdcd2", "#475a57", 20),
             ("#d58a1e", "#f3b73c", "#9a4f12", 14), ("#c9c27a", "#ece6a8", "#7c7436", 17)]
    image = stone
    for i, (at_x, at_y) in enumerate(c.scatter(24, 24)):
        body, rim_colour, cup, size = kinds[[0, 1, 0, 2, 3, 1, 0, 2][i % 8]]
        size *= c.rng.uniform(0.55, 1.05)
        dx, dy = c.apart(c.x - at_x, c.y - at_y)
        far = np.hypot(dx, dy) + 2.3 * lobes + 1.0 * frill
        inside = size - far
        cover = step(-0.2, 0.5, inside + 0.5 * crumbs)
        tone = mix(linear(body), linear(rim_colour), np.exp(-((inside - 1.6) / 1.7) ** 2))
        worn = step(0.45, 0.95, inside / size + 0.16 * frill)  # old middles fall out
        tone = mix(tone, linear(cup), (0.75 * worn).clip(0, 1))
        cups = step(0.9, 1.35, c.noise(2.3)) * step(3, 5, inside)
        tone = mix(tone, linear(cup) * 0.7, 0.8 * cups)
        tone = tone * (1 + 0.16 * crumbs + 0.10 * frill)[..., None].clip(0.4, 1.6)
        image = mix(image, tone, cover)
        height = height + cover * (0.9 + 0.4 * frill + 0.25 * crumbs) - 0.5 * cups * cover
    clumps = c.noise(26) + 0.45 * c.noise(7)
    moss = step(1.0, 1.35, clumps)
    leaf = c.noise(1.6)
    tint = mix(linear("#2d4a16"), linear("#86a83a"), step(-1.6, 2.0, leaf + 0.9 * (clumps - 1.4)))
    image = mix(image, tint, moss)
    height = height + moss * (2.6 * np.sqrt((clumps - 0.95).clip(0)) + 0.35 * leaf)
    diffuse, _ = c.light(height, (-0.4, -0.55, 1.0), hollow=2.0, depth=0.5)
    return to_bytes(encode(image * diffuse[..., None]))


def terrazzo():
    c = Canvas(192, 192, 71)  # cut below: a slab that does not tile
    palette = linear("#efe6d8", "#d9b8a4", "#c4583f", "#2f4a4f", "#5f8a86", "#e2a33b", "#3a3536",
                     "#b9c2bd", "#8d3b3a", "#f6f1e6")
    cement = linear("#d8cfc1") * (1 + 0.045 * c.noise(1.1) + 0.03 * c.noise(14))[..., None]
    image = cement
    taken = np.zeros(c.x.shape)
    for count, least, gap, share, roundness in ((75, 14, 2.3, 0.55, 0.5), (900, 4.4, 0.8, 0.8, 0.25)):
        sites = c.scatter(count, least)
        warp = (0.35 * c.noise(5), 0.35 * c.noise(5))
        ids, rim, _, _ = c.cells(sites, roundness, warp, c.rng.uniform(-1, 1, count)[:len(sites)] * least)
        tone = palette[c.rng.integers(0, len(palette), len(sites))][ids]
        tone = tone * (0.92 + 0.16 * hash_of(ids, c.rng, 1))
        cloud = 1 + 0.09 * c.noise(4, 1.4) + 0.05 * c.noise(1.2)
        tone = mix(tone, linear("#fffaf0"), 0.4 * step(1.3, 1.9, c.noise(5)) * (hash_of(ids, c.rng) < 0.4))
        border = gap * (0.6 + 0.8 * hash_of(ids, c.rng))
        chip = step(border - 0.15, border + 0.15, rim)
        # A chip is whole or is not there: the small ones only fill what the large ones leave.
        free = np.bincount(ids.ravel(), (chip * taken).ravel())[ids] == 0
        chip *= free & (hash_of(ids, c.rng) < share)
        image = mix(image, tone * cloud[..., None], chip)
        taken = np.maximum(taken, c.blur(chip, 0.5) > 0.02)
    return to_bytes(encode(image))[:160, :160]


def stripes():
    """Exactly 0.5 + 0.4 cos(2 pi ((x + 0.5) / 16 - k / 3)) for k = 0 (red), 1 (green), 2 (blue)."""
    turn = ((np.arange(64) + 0.5) / 16)[:, None] - np.arange(3) / 3
    row = 0.5 + 0.4 * np.cos(2 * np.pi * turn)
    return to_bytes(np.tile(row, (64, 1, 1)))


def arc(cx, cy, rx, ry, start, end):
    """Points of an ellipse's arc; degrees, 0 to the right, 90 down."""
    a = np.radians(np.linspace(start, end, 17))
    return list(zip(cx + rx * np.cos(a), cy + ry * np.sin(a)))


GLYPHS = {  # polylines in a box 1 wide, 1.4 high; none is its own mirror image
    "F": [[(1, 0), (0, 0), (0, 1.4)], [(0, 0.66), (0.8, 0.66)]],
    "R": [[(0, 1.4), (0, 0), *arc(0.55, 0.37, 0.42, 0.37, -90, 90), (0, 0.74)], [(0.5, 0.74), (1, 1.4)]],
    "G": [[*arc(0.55, 0.7, 0.55, 0.7, -40, -320), (1, 0.78), (0.6, 0.78)]],
    "J": [[(0.3, 0), (0.9, 0), *arc(0.48, 0.98, 0.42, 0.42, 0, 165)]],
    "4": [[(0.72, 1.4), (0.72, 0), (0, 0.95), (1.05, 0.95)]],
    "P": [[(0, 1.4), (0, 0), *arc(0.55, 0.4, 0.42, 0.4, -90, 90), (0, 0.8)]],
    "7": [[(0, 0), (1, 0), (0.35, 1.4)]],
    "L": [[(0, 0), (0, 1.4), (0.9, 1.4)]],
    "Q": [[*arc(0.5, 0.68, 0.5, 0.66, 0, 360)], [(0.6, 1.0), (1.05, 1.5)]],
    "2": [[*arc(0.48, 0.42, 0.44, 0.42, 190, 395), (0, 1.4), (1, 1.4)]],
    "5": [[(0.9, 0), (0.15, 0), (0.08, 0.6), *arc(0.43, 0.93, 0.47, 0.46, -115, 140)]],
    "h": [[(0, 0), (0, 1.4)], [(0, 0.9), *arc(0.42, 0.9, 0.42, 0.38, 180, 360), (0.84, 1.4)]],
    "y": [[(0, 0.3), (0.45, 1.0)], [(0.95, 0.3), (0.25, 1.5)]],
    "r": [[(0.1, 0.3), (0.1, 1.4)], [(0.1, 0.85), *arc(0.6, 0.85, 0.5, 0.5, 180, 290)]],
    "1": [[(0.15, 0.35), (0.6, 0), (0.6, 1.4)]],
    "f": [[*arc(0.75, 0.4, 0.35, 0.38, -30, -180), (0.4, 1.4)], [(0.05, 0.62), (0.8, 0.62)]],
}


def letters():
    c = Canvas(128, 128, 83)
    inks = linear("#1f2a44", "#b3372f", "#1f6a5d", "#c6862a", "#5b3a6e")
    paper = linear("#f2ead8") * (1 + 0.035 * c.noise(1.3) + 0.03 * c.noise(20))[..., None]
    image = paper
    worn = 0.35 * c.noise(1.6)
    for i, lines in enumerate(GLYPHS.values()):
        row, column = divmod(i, 4)
        left, top = 32 * column + 8.2 + c.rng.uniform(-1, 1), 32 * row + 5.2 + c.rng.uniform(-1, 1)
        nearest = np.full(c.x.shape, 1e9)
        for line in lines:
            points = np.array(line) * 15.2 + (left, top)
            for p, q in zip(points[:-1], points[1:]):
                px, py = c.apart(c.x - p[0], c.y - p[1])
                d = q - p
                t = ((px * d[0] + py * d[1]) / max(d @ d, 1e-9)).clip(0, 1)
                nearest = np.minimum(nearest, np.hypot(px - t * d[0], py - t * d[1]))
        ink = inks[(i * 2 + row) % len(inks)] * (1 + 0.10 * c.noise(3))[..., None]
        image = mix(image, ink, step(2.35, 1.95, nearest + 0.25 * worn))
    return to_bytes(encode(image))


def leaves():
    c = Canvas(160, 160, 97)
    blades = [("#c8421f", "#e98a2b", "#7d1f16"), ("#e0a32e", "#f2cf5b", "#9a5a17"),
              ("#8fa33a", "#c9c85a", "#4d6420"), ("#a8281f", "#d9573a", "#5e1414"),
              ("#c9762a", "#edb45a", "#7a3d15"), ("#5f7f35", "#9fb356", "#33491d")]
    colour, alpha = np.zeros((*c.x.shape, 3)), np.zeros(c.x.shape)
    mottle, fine, bend = c.noise(5), c.noise(1.3), c.noise(14)
    for i, (at_x, at_y) in enumerate(c.scatter(110, 9.0)):
        body, bright, dark = (linear(code) for code in blades[c.rng.integers(len(blades))])
        length, turn, curl = c.rng.uniform(14, 19), c.rng.uniform(0, 2 * np.pi), c.rng.uniform(-0.12, 0.12)
        dx, dy = c.apart(c.x - at_x, c.y - at_y)
        a = (dx * np.cos(turn) + dy * np.sin(turn)) / length
        b = (dy * np.cos(turn) - dx * np.sin(turn)) / length + curl * (a * a - 0.4)
        teeth = 0.018 * (((a - 0.5 * np.abs(b)) * 7) % 1 - 0.5)
        half = 0.46 * (1 - a).clip(0) ** 0.75 * (1 + a).clip(0) ** 0.55 + teeth
        inside = np.where(np.abs(a) < 1, (half - np.abs(b) + 0.012 * bend) * length, -9)
        stalk = 0.55 - np.abs(b * length) - np.where((a < -0.9) & (a > -1.4), 0, 9)
        cover = np.maximum(step(-0.25, 0.25, inside), step(-0.25, 0.25, stalk))
        across = np.abs(b) / np.maximum(half, 0.02)
        vein = np.exp(-((((a - 0.75 * np.abs(b)) * 5.5 + 0.5) % 1 - 0.5) / 0.10) ** 2) * step(1.0, 0.6, across)
        rib = np.exp(-(b * length / 0.55) ** 2)
        tone = mix(body, bright, step(-1.0, 1.6, mottle + 1.3 * (0.5 - across)))
        tone = mix(tone, dark, 0.65 * step(0.55, 1.05, across + 0.15 * mottle))
        tone = mix(tone, bright * 1.15, 0.45 * vein)
        tone = mix(tone, linear("#f3dc9a"), 0.75 * rib * step(-1.4, 0.8, 0.8 - a))
        lit = 1 + 0.22 * np.sign(b) * np.sin(turn + 0.9) * step(0, 0.15, np.abs(b)) + 0.06 * fine
        shadow = step(-2.2, 0.6, inside)  # a soft shadow on the leaves below
        colour = colour * (1 - 0.55 * shadow * (1 - cover))[..., None]
        colour = mix(colour, tone * lit[..., None], cover)
        alpha = np.maximum(alpha, cover)
    # Means of colour times alpha, divided by the mean of alpha: no dark fringe.
    weight = alpha.reshape(160, SAMPLES, 160, SAMPLES).mean(axis=(1, 3))
    seen = (colour * alpha[..., None]).reshape(160, SAMPLES, 160, SAMPLES, 3).mean(axis=(1, 3))
    flat = np.repeat(np.repeat(seen / np.maximum(weight, 1e-6)[..., None], SAMPLES, 0), SAMPLES, 1)
    rgba = np.dstack([encode(flat), weight])
    rgba[weight < 1 / 510] = 0
    return to_bytes(rgba)


def ripples():
    """16-bit grey: wind ripples in sand, lit from the side; slow slopes that 8 bits would band."""
    c = Canvas(128, 128, 101)
    wave = 1 / 10.5
    band = np.exp(-((np.abs(c.fy) - wave) / 0.018) ** 2 - (c.fx / 0.026) ** 2)
    height = c.filter(c.rng.standard_normal(c.x.shape), band)
    height = 1.6 * np.tanh(height / height.std() - 0.5) + 0.25 * c.noise(30) + 0.03 * c.noise(1.4)
    diffuse, _ = c.light(height, (0.25, 0.85, 1.0), hollow=3.0, depth=0.35)
    sand = 0.36 * diffuse ** 1.3 * (1 + 0.05 * c.noise(1.1)) * (1 + 0.10 * c.noise(40))
    grey = np.roll(encode(sand)[..., 0], 5, axis=0)  # no crest on the border
    return np.rint(grey * 65535).astype(np.uint16)


SWATCHES = {f.__name__: f for f in (pebbles, leopard, bricks, scales, knit, wood, lichen, terrazzo,
                                    stripes, letters, leaves, ripples)}


def main():
    names = sys.argv[1:] or list(SWATCHES)
    FOLDER.mkdir(exist_ok=True)
    for name in names:
        if name not in SWATCHES:
            sys.exit(f"no swatch \"{name}\"; there are: {', '.join(SWATCHES)}")
        write_png(FOLDER / f"{name}.png", SWATCHES[name]())
        print(f"{name}.png  {(FOLDER / name).with_suffix('.png').stat().st_size} bytes")


if __name__ == "__main__":
    main()
