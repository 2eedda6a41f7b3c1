// Results as JSON: keys are stable, README lists them.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "document/automatic_options.h"
#include "document/texture_job.h"

namespace dapple {

nlohmann::ordered_json scoreJson(const TextureScore& score);

// Of a swatch, as `dapple info` prints it.
nlohmann::ordered_json analysisJson(const SwatchAnalysis& analysis);

struct ReportInput {
  const PreparedScan& prepared;
  const TexturedPoints& textured;
  const AutomaticOptions& automatic;
  const std::optional<SwatchAnalysis>& analysis;  // there when the method was chosen
  unsigned threads = 1;
  double saveSeconds = 0;
  const std::optional<TextureScore>& score;
};
nlohmann::ordered_json reportJson(const ReportInput& input);

// Points per second of all stages but load and save.
double pointsPerSecond(const PreparedScan& prepared, const TexturedPoints& textured);

// Throws IoError when no file can be made at `path`, to be called before the long work. An empty
// path is fine; a device or pipe is left alone, for closing a pipe would end its reader.
void checkWritable(const std::string& path);

// Writes text beside `path` and renames it into place. Throws IoError.
void writeTextFile(const std::string& path, const std::string& text);

}  // namespace dapple
