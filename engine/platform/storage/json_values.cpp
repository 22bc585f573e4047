// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/json_values.h"

#include <set>

template class nlohmann::basic_json<nlohmann::ordered_map>;

namespace nonio::storage {

Json parse(std::string_view text) { return Json::parse(text); }

Json parse_or_discard(std::string_view text) { return Json::parse(text, nullptr, false); }

Json parse_once(std::string_view text) {
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

std::string dump(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string dump_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace nonio::storage
