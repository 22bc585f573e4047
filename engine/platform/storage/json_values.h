// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/format.h"

// Compiled once, in json_values.cpp: a source that compiles it itself takes 5 to 10 % longer.
#pragma GCC visibility push(default)
#include <nlohmann/json.hpp>
extern template class nlohmann::basic_json<nlohmann::ordered_map>;
#pragma GCC visibility pop

namespace nonio::storage {

/// Keys stay in the order in which they are written.
using Json = nlohmann::ordered_json;

/// A text that this program wrote. Throws `Json::exception` where it is no JSON.
Json parse(std::string_view text);
/// Discarded where it is no JSON.
Json parse_or_discard(std::string_view text);
/// Discarded where it is no JSON; where an object has a key twice: one program reads the first,
/// another one the last; and where it is nested so deeply that a copy could exhaust the stack.
Json parse_once(std::string_view text);

/// Indented by one, so that a diff of two runs is readable. Text that is not UTF-8 (a file name, a
/// plugin's message) gets replacement characters instead of stopping the run.
std::string dump(const Json& json);
/// The same in one line.
std::string dump_line(const Json& json);

inline Json to_json(const Error& error) {
  Json json = Json::object();
  if (!error.file.empty()) json["file"] = error.file;
  if (error.line != 0) json["line"] = error.line;
  if (!error.column.empty()) json["column"] = error.column;
  json["message"] = error.message;
  return json;
}

/// A name with its unit: "rms_um".
inline std::string key(const std::string& name, Quantity q) {
  return name + std::string(unit_of(q).suffix);
}

/// What is not a number, or missing, is left out.
inline void put(Json& json, const std::string& name, const std::optional<double>& value,
                Quantity q) {
  if (!value) return;
  const double shown = printed(*value, q);
  if (std::isfinite(shown)) json[key(name, q)] = shown;
}

}  // namespace nonio::storage
