// Milliseconds a picture of 1280 x 720 takes, on the processor and by OpenGL (in software where
// there is no graphics hardware), beside OpenGL's bare points of one pixel, for three sizes of
// scan. Medians of several pictures; nothing is asserted.
//
// dapple_render_bench [--quick]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "app/render/cpu_splatter.h"
#include "app/render/gl_objects.h"
#include "app/render/image_compare.h"
#include "app/render/live_view.h"
#include "app/render/offscreen.h"
#include "app/render/splat_renderer.h"
#include "tests/fixtures.h"

namespace {

using namespace dapple;

constexpr int kWidth = 1280, kHeight = 720;
constexpr std::size_t kSizes[] = {35000, 500000, 2000000};

double medianMilliseconds(int runs, const std::function<void()>& draw) {
  draw();
  std::vector<double> times;
  for (int r = 0; r < runs; ++r) {
    const auto start = std::chrono::steady_clock::now();
    draw();
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    times.push_back(took.count());
  }
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

// A bumpy ball that fills most of the picture's height, as a scan with a source map.
struct Ball {
  PointSet points;
  std::vector<vec3> colours;
  std::vector<float> radii;
  std::vector<vec2> texels;
  std::vector<TangentFrame> frames;
  float scale;  // local units per swatch pixel

  explicit Ball(std::size_t n) : points(fixtures::makeSphere(n, 1)) {
    const float spacing = std::sqrt(4 * std::numbers::pi_v<float> / static_cast<float>(n));
    scale = spacing;
    radii.assign(n, splatRadius(spacing));
    frames = fixtures::uprightFrames(points);
    for (vec3& p : points.positions) {
      const vec3 wave = glm::sin(vec3(9, 8, 7) * p);
      p *= 1 + 0.04f * wave.x * wave.y * wave.z;
      colours.push_back(0.5f + 0.5f * glm::sin(vec3(40, 50, 30) * p));
      texels.emplace_back(vec2(p.x, -p.y) / scale);
    }
  }
};

// What OpenGL needs at least to show the points at all.
double barePointsMilliseconds(const Ball& ball, const Camera& camera, int runs) {
  const GlStage stages[] = {{GL_VERTEX_SHADER, "points.vert"}, {GL_FRAGMENT_SHADER, "points.frag"}};
  const GlProgram program(stages, {});
  const GlVertexArray array;
  const GlBuffer positions, colours;
  const GlTexture colour = makeTexture(GL_RGBA8, kWidth, kHeight),
                  depth = makeTexture(GL_DEPTH_COMPONENT32F, kWidth, kHeight);
  const GlFramebuffer frame = makeFramebuffer(colour, &depth);
  glBindVertexArray(array.id());
  const auto upload = [](GLuint attribute, const GlBuffer& buffer,
                         const std::vector<vec3>& column) {
    glBindBuffer(GL_ARRAY_BUFFER, buffer.id());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(column.size() * sizeof(vec3)),
                 column.data(), GL_STATIC_DRAW);
    glVertexAttribPointer(attribute, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
    glEnableVertexAttribArray(attribute);
  };
  upload(0, positions, ball.points.positions);
  upload(1, colours, ball.colours);
  const glm::mat4 view = viewMatrix(camera);
  const float focal = 1 / std::tan(0.5f * camera.verticalFov);
  const double took = medianMilliseconds(runs, [&] {
    glBindFramebuffer(GL_FRAMEBUFFER, frame.id());
    glViewport(0, 0, kWidth, kHeight);
    glEnable(GL_DEPTH_TEST);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glUseProgram(program.id());
    glUniformMatrix4fv(program.uniform("localToView"), 1, GL_FALSE, &view[0][0]);
    glUniform2f(program.uniform("focal"), focal * kHeight / kWidth, focal);
    glUniform2f(program.uniform("depthRange"), camera.nearPlane, camera.farPlane);
    glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(ball.points.size()));
    glFinish();
  });
  glDisable(GL_DEPTH_TEST);
  return took;
}

void benchmark(std::size_t n, int runs) {
  const Ball ball(n);
  const Camera camera =
      standardView("front", ball.points.positions, static_cast<float>(kWidth) / kHeight);
  const Swatch swatch = fixtures::swatchOf(fixtures::noise(128), Tileable::Yes);
  const SplatTexture texture{.swatch = swatch,
                             .texel = ball.texels,
                             .frame = ball.frames,
                             .unit = ball.scale,
                             .longestStep = std::numeric_limits<float>::max()};
  const SplatOptions options{.shading = Shading::Headlight};
  const auto columns = [&](bool withTexels) {
    return SplatColumns{ball.points.positions, ball.points.normals, ball.colours, ball.radii,
                        withTexels ? &texture : nullptr};
  };
  fmt::print("{:>9}", n);
  Raster raster;
  for (const bool withTexels : {false, true})
    for (const unsigned threads : {1u, 2u}) {
      Workers workers(threads);
      CpuSplatter splatter(workers);
      splatter.update(columns(withTexels));
      fmt::print(" {:>10.1f}", medianMilliseconds(runs, [&] {
                   splatter.draw(camera, kWidth, kHeight, options, raster);
                 }));
      if (!withTexels && threads == 2) {
        std::vector<vec3> colours = ball.colours;
        fmt::print(" {:>10.1f}", medianMilliseconds(runs, [&] { splatter.recolour(colours); }));
      }
    }
  const OffscreenContext context;
  SplatRenderer renderer;
  Image picture;
  for (const bool withTexels : {true, false}) {  // without last: compared below
    renderer.update(columns(withTexels));
    fmt::print(" {:>10.1f}", medianMilliseconds(std::max(1, runs / 3), [&] {
                 picture = renderer.draw(camera, kWidth, kHeight, options);
               }));
  }
  fmt::print(" {:>10.1f}", barePointsMilliseconds(ball, camera, std::max(1, runs / 3)));
  Workers workers(2);
  CpuSplatter splatter(workers);
  splatter.update(columns(false));
  splatter.draw(camera, kWidth, kHeight, options, raster);
  fmt::print(" {:>10.4f}\n", structuralSimilarity(picture, toImage(raster)));
  std::fflush(stdout);
}

// A window's pictures of 33 ms at most: the camera turns, then rests.
void benchmarkWindow(std::size_t n, int pictures) {
  using Clock = std::chrono::steady_clock;
  using Milliseconds = DetailPacer::Milliseconds;
  constexpr Milliseconds kBudget(33);
  constexpr float kTurn = 0.05f;  // from picture to picture, radians
  const auto since = [](Clock::time_point start) {
    return Milliseconds(Clock::now() - start).count();
  };
  const Ball ball(n);
  Workers workers(2);
  LiveView view(workers);
  const Clock::time_point loaded = Clock::now();
  view.update({ball.points.positions, ball.points.normals, ball.colours, ball.radii});
  Camera camera =
      standardView("front", ball.points.positions, static_cast<float>(kWidth) / kHeight);
  const vec3 start = camera.eye - camera.target;
  const SplatOptions options{.shading = Shading::Headlight};
  const auto draw = [&] { return view.frame(camera, kWidth, kHeight, options, kBudget); };
  draw();
  const double first = since(loaded);
  std::vector<double> times;
  for (int k = 1; k <= pictures; ++k) {
    const float angle = kTurn * static_cast<float>(k);
    camera.eye =
        camera.target + vec3(std::cos(angle) * start.x + std::sin(angle) * start.z, start.y,
                             std::cos(angle) * start.z - std::sin(angle) * start.x);
    const Clock::time_point begun = Clock::now();
    draw();
    times.push_back(since(begun));
  }
  const std::size_t drawn = view.pointsDrawn();
  const Clock::time_point rested = Clock::now();
  double longest = 0;
  for (bool complete = false; !complete;) {
    const Clock::time_point begun = Clock::now();
    complete = draw() == LiveView::Progress::Complete;
    longest = std::max(longest, since(begun));
  }
  const double complete = since(rested);
  const double mean = std::accumulate(times.begin(), times.end(), 0.0) / pictures;
  fmt::print("{:>9} {:>10.1f} {:>10.1f} {:>10.1f} {:>10.2f} {:>10.1f} {:>10.1f}\n", n, first, mean,
             *std::max_element(times.begin(), times.end()),
             static_cast<double>(drawn) / static_cast<double>(n), complete, longest);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int runs = argc > 1 && std::string(argv[1]) == "--quick" ? 3 : 15;
  try {
    fmt::print("milliseconds a picture of {} x {}, medians of {}\n", kWidth, kHeight, runs);
    fmt::print("{:>9} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "",
               "cpu, 1", "cpu, 2", "new", "texels,", "texels,", "OpenGL,", "", "OpenGL,", "alike,");
    fmt::print("{:>9} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "points",
               "thread", "threads", "colours", "1", "2", "texels", "OpenGL", "bare", "cpu & GL");
    for (const std::size_t n : kSizes) benchmark(n, runs);
    fmt::print("\na window's pictures, on the processor, 2 threads, ms; asked for: 33 at most\n");
    fmt::print("{:>9} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "", "first,",
               "moving:", "longest", "share of", "at rest:", "longest");
    fmt::print("{:>9} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "points", "from data", "mean",
               "", "points", "complete", "picture");
    for (const std::size_t n : kSizes) benchmarkWindow(n, 20 * runs);
  } catch (const std::exception& error) {
    fmt::print(stderr, "dapple_render_bench: {}\n", error.what());
    return 2;
  }
  return 0;
}
