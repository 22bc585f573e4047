// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nonio/host/machines.h"
#include "nonio/host/manifest.h"
#include "nonio/host/plugins.h"
#include "nonio/sdk/results.h"

namespace nonio::host {

/// What every campaign of a run shares.
struct Context {
  std::string version;
  SiteFile site;
  std::string site_sha256;    ///< of site.toml; of nothing if there is none
  MachineRecords machines{};  ///< of the site
  const Plugins* plugins = nullptr;
  std::string plugins_sha256;  ///< empty where no results are recorded
  std::string today{};         ///< YYYY-MM-DD; empty where no day is too late
  Templates templates;
  std::string templates_sha256;
  std::string templates_json{};  ///< see `read_templates`; travels in what is signed
};

/// What a campaign's results depend on, in the order in which a change is reported.
using Inputs = std::vector<std::pair<std::string, std::string>>;  // name, SHA-256

inline constexpr const char* manifest_name = "campaign.toml";
inline constexpr const char* site_name = "site.toml";
/// How a measurement file is called in `Inputs`.
std::string input_name(const std::string& file);

/// How it is called in `Inputs` that another campaign has the same file; its value is that
/// campaign's id.
std::string shared_name(const std::string& file);

/// Stands for the SHA-256 of a file that cannot be read.
inline constexpr const char* absent = "absent";

/// The parts of `Inputs` that all campaigns share.
Inputs shared_inputs(const Context& context);

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
  Inputs inputs;       ///< of the campaign's own files, manifest first
  std::string status;  ///< ok, attention, failed
  std::optional<Certificate> certificate{};
  bool retry = false;  ///< it failed for a reason that does not lie in its files
};

/// Told what is about to be called, for the case that it does not come back.
using Stage = std::function<void(const std::string&)>;

/// What has become of a campaign's wish to be issued under a number.
struct AssignedNumber {
  /// What was issued for the same data already, else a draft, else what has a new number.
  std::optional<Certificate> certificate{};
  std::vector<std::string> missing{};  ///< why there is none; what day and register tell, too
  std::optional<Error> error{};        ///< the register could not be asked: to be tried again
};

/// Files of readings (the first 64 bits of their SHA-256) that another campaign has too, and its
/// id.
using Twins = std::vector<std::pair<std::uint64_t, std::string>>;

/// One campaign from its folder to its artifacts, without a number; writes nothing. For verbs: a
/// night does it in four steps (evaluation.h).
Evaluated evaluate(const std::filesystem::path& folder, const std::string& id,
                   const Context& context, const Stage& stage);

/// What is wrong with the names and options of site.toml: it would be wrong in every campaign.
std::vector<Error> site_mistakes(const Context& context);

/// With an upper limit: ISO 14253-1:2013, guard band U (k = 2) to both sides; ILAC-G8:09/2019,
/// simple acceptance (4.2.1) and guard band w = U (4.2.2). Confidence of the reading: medium.
Decision decide(double value, double U, double tolerance, std::string_view rule = "iso14253-1");

}  // namespace nonio::host
