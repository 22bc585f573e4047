// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "nonio/sdk/error.h"
#include "nonio/sdk/format.h"

namespace nonio::host {

/// Keys stay in the order in which they are written.
using Json = nlohmann::ordered_json;

/// Indented by one, so that a diff of two nights reads well. Text that is not UTF-8 (a file name, a
/// plugin's message) gets replacement characters instead of stopping the night.
inline std::string dump(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

inline Json to_json(const Error& error) {
  Json json = Json::object();
  if (!error.file.empty()) json["file"] = error.file;
  if (error.line != 0) json["line"] = error.line;
  if (!error.column.empty()) json["column"] = error.column;
  json["message"] = error.message;
  return json;
}

}  // namespace nonio::host
