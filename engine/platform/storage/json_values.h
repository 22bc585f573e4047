// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/format.h"

namespace nonio::storage {

/// Keys stay in the order in which they are written.
using Json = nlohmann::ordered_json;

/// Discarded where it is no JSON; where an object has a key twice: one program reads the first,
/// another one the last; and where it is nested so deeply that a copy could exhaust the stack.
inline Json parse_once(std::string_view text) {
  constexpr int deepest = 64;
  std::vector<std::set<std::string>> open;
  bool wrong = false;
  Json json = Json::parse(
      text,
      [&](int depth, Json::parse_event_t event, Json& value) {
        if (depth > deepest) wrong = true;
        if (wrong) return false;
        if (event == Json::parse_event_t::object_start) open.emplace_back();
        if (event == Json::parse_event_t::object_end) open.pop_back();
        if (event == Json::parse_event_t::key &&
            !open.back().insert(value.get<std::string>()).second)
          wrong = true;
        return !wrong;
      },
      false);
  if (wrong) return Json(Json::value_t::discarded);
  return json;
}

/// Indented by one, so that a diff of two runs is readable. Text that is not UTF-8 (a file name, a
/// plugin's message) gets replacement characters instead of stopping the run.
inline std::string dump(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// The same in one line.
inline std::string dump_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

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
