// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/format.h"

// Instantiated only in json_values.cpp, because each source that instantiates the template takes 5
// to 10 % longer to compile.
#pragma GCC visibility push(default)
#include <nlohmann/json.hpp>
extern template class nlohmann::basic_json<nlohmann::ordered_map>;
#pragma GCC visibility pop

namespace nonio::storage {

using Json = nlohmann::ordered_json;

/// For text that this program wrote; throws `Json::exception` if it is not JSON.
Json parse(std::string_view text);
/// The result is discarded (`is_discarded`) if the text is not JSON.
Json parse_or_discard(std::string_view text);
/// For text of unknown origin. The result is discarded if the text is not JSON, if an object has a
/// key twice (parsers differ in which one they use), or if it is nested more than 64 deep, because
/// a copy could exhaust the stack.
Json parse_once(std::string_view text);

/// Indented by one space per level. Bytes that are not UTF-8 become replacement characters.
std::string dump(const Json& json);
/// Returns one line; bytes that are not UTF-8 become replacement characters.
std::string dump_line(const Json& json);

inline Json to_json(const Error& error) {
  Json json = Json::object();
  if (!error.file.empty()) json["file"] = error.file;
  if (error.line != 0) json["line"] = error.line;
  if (!error.column.empty()) json["column"] = error.column;
  json["message"] = error.message;
  return json;
}

/// Appends the suffix of the unit: "rms_um".
inline std::string key(const std::string& name, Quantity q) {
  return name + std::string(unit_of(q).suffix);
}

/// Adds a value in the unit of its quantity; a missing or non-finite value is omitted.
inline void put(Json& json, const std::string& name, const std::optional<double>& value,
                Quantity q) {
  if (!value) return;
  const double shown = printed(*value, q);
  if (std::isfinite(shown)) json[key(name, q)] = shown;
}

}  // namespace nonio::storage
