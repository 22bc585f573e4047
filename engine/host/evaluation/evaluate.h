// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/reading/context.h"
#include "nonio/sdk/results.h"

namespace nonio::host::evaluation {

/// A file of a certificate as it was issued, signature included.
struct IssuedFile {
  std::string output, name, bytes;  ///< of which output plugin
  std::string no_time_stamp{};      ///< why it has none although one was wanted
};

/// What a campaign has been issued under its number, or is to get.
struct Certificate {
  std::string output;  ///< the plugin that makes it
  Issue issue{};
  std::string templates_sha256{};
  bool issued = false;              ///< already: what follows is what was signed then
  bool draft = false;               ///< without number: waits until a person releases it
  std::vector<IssuedFile> files{};  ///< those of `output` first
  std::string results{};            ///< results.json as it is attached
  std::string released{};           ///< JSON: by whom, and why findings may stand
};

struct Evaluated {
  Campaign campaign;
  Results results;
  reading::Inputs inputs;  ///< of the campaign's own files, manifest first
  std::string status;      ///< ok, attention, failed
  std::optional<Certificate> certificate{};
  bool retry = false;     ///< it failed for a reason that does not lie in its files
  std::string purpose{};  ///< as the manifest says it
};

/// What was issued for what is evaluated here, whatever is `missing` for it today; else, if nothing
/// is, a draft or a number; else neither. Adds to `missing` what only the day and the register
/// tell.
using Draw =
    std::function<Expected<Certificate>(const Evaluated&, std::vector<std::string>& missing)>;

/// One campaign from its folder to its artifacts; writes nothing. Without `draw` there is no
/// certificate.
Evaluated evaluate(const std::filesystem::path& folder, const std::string& id,
                   const reading::Context& context, const reading::Stage& stage,
                   const Draw& draw = {}, const reading::Twins& twins = {});

/// With an upper limit: ISO 14253-1:2013, guard band U (k = 2) to both sides; ILAC-G8:09/2019,
/// simple acceptance (4.2.1) and guard band w = U (4.2.2). Confidence of the reading: medium.
Decision decide(double value, double U, double tolerance, std::string_view rule = "iso14253-1");

}  // namespace nonio::host::evaluation
