// SPDX-License-Identifier: Apache-2.0
// Any bytes as campaign.toml, site.toml and a template: an answer or errors, never a crash.
#include <cstdint>
#include <cstdlib>

#include "campaign/config/manifest.h"

namespace {

nonio::Option key(const char* name, nonio::Setting value, bool required = false) {
  return {.name = name,
          .default_value = std::move(value),
          .unit = "",
          .help = "",
          .required = required};
}

/// A method with keys of each type, and those that fill members of a measurement.
const std::vector<nonio::Method>& methods() {
  static const std::vector<nonio::Method> all{
      {.info = {"axis",
                "1",
                "",
                {key("axis", std::string(), true), key("lateral", std::string()),
                 key("square", std::string()), key("square_turned", false),
                 key("reversal_of", std::string())}}},
      {.info = {"circle",
                "1",
                "",
                {key("plane", std::string(), true), key("radius_mm", 0.0, true),
                 key("centre", nonio::NumberTable{}, true)}}},
      {.info = {"other",
                "1",
                "",
                {key("whole", std::int64_t{1}), key("numbers", std::vector<double>{}),
                 key("texts", std::vector<std::string>{}), key("from", nonio::NumberTable{})}}}};
  return all;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace nonio;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto manifest = config::parse_manifest(text, "campaign.toml", methods());
  (void)config::parse_without_methods(text, "campaign.toml");
  if (manifest) {
    // What was accepted keeps what every later stage relies on.
    const bool plans = manifest->run.analyses && manifest->run.outputs;
    if (!config::is_campaign_id(manifest->campaign.id)) std::abort();
    if (manifest->campaign.measurements.empty() && !plans) std::abort();
    const Info plugin{
        "p",
        "1",
        "",
        {{"n", 1.0, "", "", {}, 0.0, 2.0}, {"t", std::string("a"), "", "", {"a"}, {}, {}}}};
    (void)config::settle_options(plugin, {}, manifest->options);
  } else if (manifest.error().empty()) {
    std::abort();
  }
  (void)config::parse_site(text, "site.toml");
  (void)config::parse_settings(text, "x.toml");
  const std::string id = config::extract_id(text);
  if (!id.empty() && !config::is_campaign_id(id)) std::abort();
  return 0;
}
