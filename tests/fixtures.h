// Point sets with analytic normals and swatches whose contents are known, made in code.
#pragma once

#include <string>

#include "points/neighborhoods.h"
#include "points/point_set.h"
#include "swatch/swatch.h"

namespace dapple::fixtures {

// A rectangle [0, width] x [0, height] of the plane z = 0, normals +z; one point in every cell of
// side `spacing`, moved from the cell's centre by up to `jitter` / 2 cells along each axis.
PointSet makePlane(float width, float height, float spacing, float jitter = 1);

// As a PointSet promises its points to be; positions and normals only.
PointSet inMortonOrder(const PointSet& points);

// `count` points of a Fibonacci spiral on a sphere around the origin.
PointSet makeSphere(std::size_t count, float radius);

// Neighbourhoods without a stop button.
Neighborhoods neighbourhoods(const PointSet& points, std::size_t k = 16);

// Tangent frames with t as near as possible to `up` (any tangent where it has no tangential part).
std::vector<TangentFrame> uprightFrames(const PointSet& points, vec3 up = {0, 1, 0});

// width x height x 3 images. All tile.
Image noise(int size);   // smooth isotropic colour noise, features of about 6 pixels
Image blobs(int size);   // dark discs of three sizes with a bright comma on each: has a hand
Image bricks(int size);  // courses with a dark mark in one corner of every brick: has a hand
Image stripes(int size, int period);  // vertical grey sine stripes
Image flat(int size, vec3 colour);
Image mirrored(const Image& image);  // left and right exchanged
// The part of `image` repeated that begins at (x, y), both >= 0.
Image cutOf(const Image& image, int x, int y, int width, int height);

Swatch swatchOf(const Image& image, Tileable tileable = Tileable::Yes);

}  // namespace dapple::fixtures
