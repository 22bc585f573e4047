// SPDX-License-Identifier: Apache-2.0
#include "batch/state/plan_lists.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <stdexcept>

#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/spool.h"

namespace nonio::batch {
namespace fs = std::filesystem;
using storage::Json;
using Action = CampaignState::Action;

Json exact(const std::string& bytes) {
  if (storage::path_text(bytes) == bytes) return bytes;
  std::string hex;
  for (const unsigned char c : bytes) {
    constexpr const char* digits = "0123456789abcdef";
    hex += digits[c >> 4];
    hex += digits[c & 15];
  }
  return {{"hex", hex}};
}
std::string exact(const Json& json) {
  if (json.is_string()) return json.get<std::string>();
  const auto hex = json.at("hex").get<std::string>();
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  return bytes;
}

Json errors_json(const std::vector<Error>& errors) {
  Json all = Json::array();
  for (const Error& e : errors)
    all.push_back({exact(e.message), exact(e.file), e.line, exact(e.column)});
  return all;
}
std::vector<Error> errors_in(const Json& json) {
  std::vector<Error> all;
  for (const Json& one : json) {
    all.push_back(Error{exact(one.at(0))});
    all.back().file = exact(one.at(1));
    all.back().line = one.at(2).get<std::size_t>();
    all.back().column = exact(one.at(3));
  }
  return all;
}

evaluation::Status status_in(const Json& json) {
  return evaluation::status_named(json.get<std::string>()).value_or(evaluation::Status::none);
}

namespace {

constexpr std::array<const char*, 3> actions{"todo", "done", "unchanged"};

std::string hex_of(std::uint64_t value) {
  std::array<char, 24> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(value));
  return text.data();
}

/// One line. What is as usual is left out.
std::string line_of(const CampaignState& c, const std::vector<CampaignState>& all) {
  Json json = {
      {"id", c.id.view()}, {"folder", exact(c.folder.str())}, {"reason", exact(c.reason.str())}};
  if (c.action != Action::todo) json["action"] = actions.at(static_cast<std::size_t>(c.action));
  if (c.status != evaluation::Status::none) json["status"] = to_text(c.status);
  if (c.named_by_folder) json["named_by_folder"] = true;
  if (!c.is_campaign) json["is_campaign"] = false;
  if (!c.errors().empty()) json["errors"] = errors_json(c.errors());
  for (const auto& [digest, other] : c.twins())
    json["twins"].push_back({hex_of(digest), all[other].id.view()});
  if (c.shows_history) json["history"] = c.history.view();
  return storage::dump_line(json) + "\n";
}

Listed listed_in(const Json& json) {
  Listed listed;
  CampaignState& c = listed.campaign;
  c.id = json.at("id").get<std::string>();
  c.folder = exact(json.at("folder"));
  c.reason = KeptText::shared(exact(json.at("reason")));
  const std::string action = json.value("action", "todo");
  const auto at = std::find(actions.begin(), actions.end(), action);
  if (at == actions.end()) throw std::runtime_error("unknown action " + action);
  c.action = static_cast<Action>(at - actions.begin());
  if (json.contains("status")) c.status = status_in(json["status"]);
  c.named_by_folder = json.value("named_by_folder", false);
  c.is_campaign = json.value("is_campaign", true);
  if (json.contains("errors")) c.set_errors(errors_in(json["errors"]));
  if (json.contains("twins"))
    for (const Json& twin : json["twins"])
      listed.twins.emplace_back(std::stoull(twin.at(0).get<std::string>(), nullptr, 16),
                                twin.at(1).get<std::string>());
  c.shows_history = json.contains("history");
  if (c.shows_history) c.history = json["history"].get<std::string>();
  return listed;
}

}  // namespace

Error damaged(const fs::path& path, const std::string& why) {
  return Error{path.string() + " is damaged (" + why + "); plan the run again"};
}

Expected<std::vector<Listed>> read_list(const fs::path& path, const NightPlan::List& list) {
  const auto text = storage::read_file(path);
  if (!text) return fail(text.error());
  if (storage::sha256(*text) != list.sha256) return fail(damaged(path, "another digest"));
  std::vector<Listed> all;
  all.reserve(list.campaigns);
  try {
    for (std::size_t from = 0; from < text->size();) {
      const std::size_t to = std::min(text->find('\n', from), text->size());
      all.push_back(listed_in(Json::parse(text->begin() + static_cast<std::ptrdiff_t>(from),
                                          text->begin() + static_cast<std::ptrdiff_t>(to))));
      from = to + 1;
    }
  } catch (const std::exception& e) {
    return fail(damaged(path, e.what()));
  }
  return all;
}

Expected<void> write_list(const fs::path& folder, const std::string& name,
                          std::span<const std::uint32_t> of,
                          const std::vector<CampaignState>& campaigns, NightPlan::List& list) {
  const fs::path path = storage::temporary_path(folder, name);
  std::uint64_t size = 0;
  storage::RunningDigest digest;
  {
    storage::Spool file = storage::Spool::at(path);
    for (const std::uint32_t i : of) {
      const std::string line = line_of(campaigns[i], campaigns);
      file.add(line);
      digest.add(line);
      size += line.size();
    }
    if (auto flushed = file.flush(); !flushed)
      return fail("cannot write " + path.string() + ": " + flushed.error().message);
  }
  list.sha256 = digest.hex();
  const auto same = storage::disk_gives_back(path, size, list.sha256);
  if (!same) return fail(same.error());
  if (!*same)
    return fail("the disk does not give back what was written to it: " + (folder / name).string());
  return {};
}

}  // namespace nonio::batch
