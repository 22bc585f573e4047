// SPDX-License-Identifier: Apache-2.0
#include "batch/state/run_plan.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "batch/state/run_state.h"
#include "campaign/evaluation/record.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "platform/storage/spool.h"

namespace nonio::batch {
namespace fs = std::filesystem;
using storage::Json;
using Action = CampaignState::Action;

namespace {

/// Names of folders that are not UTF-8 are written as hexadecimal digits.
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

constexpr std::array<const char*, 3> actions{"todo", "done", "unchanged"};

std::string hex_of(std::uint64_t value) {
  std::array<char, 24> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(value));
  return text.data();
}

std::string line_of(const CampaignState& c, const std::vector<CampaignState>& all) {
  Json json = {{"id", c.id}, {"folder", exact(c.folder)}, {"reason", exact(c.reason)}};
  if (c.action != Action::todo) json["action"] = actions.at(static_cast<std::size_t>(c.action));
  if (c.status != evaluation::Status::none) json["status"] = to_text(c.status);
  if (c.named_by_folder) json["named_by_folder"] = true;
  if (!c.is_campaign) json["is_campaign"] = false;
  if (!c.errors.empty()) json["errors"] = errors_json(c.errors);
  for (const auto& [digest, other] : c.twins)
    json["twins"].push_back({hex_of(digest), all[other].id});
  if (c.shows_history) json["history"] = c.history;
  return storage::dump_line(json) + "\n";
}

Listed listed_in(const Json& json) {
  Listed listed;
  CampaignState& c = listed.campaign;
  c.id = json.at("id").get<std::string>();
  c.folder = exact(json.at("folder"));
  c.reason = exact(json.at("reason"));
  const std::string action = json.value("action", "todo");
  const auto at = std::find(actions.begin(), actions.end(), action);
  if (at == actions.end()) throw std::runtime_error("unknown action " + action);
  c.action = static_cast<Action>(at - actions.begin());
  if (json.contains("status")) c.status = status_in(json["status"]);
  c.named_by_folder = json.value("named_by_folder", false);
  c.is_campaign = json.value("is_campaign", true);
  if (json.contains("errors")) c.errors = errors_in(json["errors"]);
  if (json.contains("twins"))
    for (const Json& twin : json["twins"])
      listed.twins.emplace_back(std::stoull(twin.at(0).get<std::string>(), nullptr, 16),
                                twin.at(1).get<std::string>());
  c.shows_history = json.contains("history");
  if (c.shows_history) c.history = json["history"].get<std::string>();
  return listed;
}

Error damaged(const fs::path& path, const std::string& why) {
  return Error{path.string() + " is damaged (" + why + "); plan the run again"};
}

Expected<std::vector<Listed>> read_list(const fs::path& path, const RunPlan::List& list) {
  NONIO_TRY(const auto text, storage::read_file(path));
  if (storage::sha256(text) != list.sha256) return fail(damaged(path, "another digest"));
  std::vector<Listed> all;
  all.reserve(list.campaigns);
  try {
    for (std::size_t from = 0; from < text.size();) {
      const std::size_t to = std::min(text.find('\n', from), text.size());
      all.push_back(listed_in(storage::parse(std::string_view(text).substr(from, to - from))));
      from = to + 1;
    }
  } catch (const std::exception& e) {
    return fail(damaged(path, e.what()));
  }
  return all;
}

/// Writes the campaigns with the indices `of` line by line, because a list may not fit into memory,
/// into a temporary file. Sets the digest of `list`.
Expected<void> write_list(const fs::path& folder, const std::string& name,
                          std::span<const std::uint32_t> of,
                          const std::vector<CampaignState>& campaigns, RunPlan::List& list) {
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
  NONIO_TRY(const auto same, storage::disk_gives_back(path, size, list.sha256));
  if (!same)
    return fail("the disk does not give back what was written to it: " + (folder / name).string());
  return {};
}

constexpr const char* plan_schema = "nonio-plan/1";
constexpr const char* record_schema = "nonio-shard/1";
constexpr const char* rest_name = "rest.jsonl";

fs::path folder_of(const fs::path& out, const RunPlan& plan) {
  return out / state_folder / plan_folder / plan.id;
}

std::string numbered(const char* before, std::uint64_t shard, const char* after) {
  std::array<char, 24> digits{};
  std::snprintf(digits.data(), digits.size(), "%04llu", static_cast<unsigned long long>(shard));
  return before + std::string(digits.data()) + after;
}
std::string list_name(std::uint64_t shard) { return numbered("shard-", shard, ".jsonl"); }
std::string shard_record_name(std::uint64_t shard) {
  return numbered("shard-", shard, ".done.json");
}

Json json_of(const RunPlan::List& list) {
  return {{"campaigns", list.campaigns}, {"sha256", list.sha256}};
}
RunPlan::List list_in(const Json& json) {
  return {json.at("campaigns").get<std::uint64_t>(), json.at("sha256").get<std::string>()};
}

Json json_of(const RunPlan& plan) {
  Json json = {{"schema", plan_schema},    {"plan", plan.id},
               {"night", plan.run.number}, {"date", plan.run.date},
               {"site", exact(plan.site)}, {"seen", plan.seen},
               {"to_do", plan.to_do},      {"register_read", plan.register_read}};
  if (plan.history_known) json["history_known"] = *plan.history_known;
  json["made_with"] = Json::array();
  for (const auto& [name, digest] : plan.made_with) json["made_with"].push_back({name, digest});
  json["notes"] = Json::array();
  for (const std::string& note : plan.notes) json["notes"].push_back(exact(note));
  json["vanished"] = Json::array();
  for (const Vanished& v : plan.vanished)
    json["vanished"].push_back({v.id, exact(v.folder), v.run, exact(v.why)});
  json["rest"] = json_of(plan.rest);
  json["shards"] = Json::array();
  for (const RunPlan::List& list : plan.shards) json["shards"].push_back(json_of(list));
  return json;
}

RunPlan plan_in(const Json& json) {
  if (json.at("schema") != plan_schema) throw std::runtime_error("another schema");
  RunPlan plan;
  plan.id = json.at("plan").get<std::string>();
  if (plan.id.empty() || plan.id.find('/') != plan.id.npos || plan.id.starts_with('.'))
    throw std::runtime_error("no name of a plan");
  plan.run = {json.at("night").get<std::uint64_t>(), json.at("date").get<std::string>()};
  plan.site = exact(json.at("site"));
  plan.seen = json.at("seen").get<std::uint64_t>();
  plan.to_do = json.at("to_do").get<std::uint64_t>();
  plan.register_read = json.at("register_read").get<bool>();
  if (json.contains("history_known"))
    plan.history_known = json["history_known"].get<std::uint64_t>();
  for (const Json& one : json.at("made_with"))
    plan.made_with.emplace_back(one.at(0).get<std::string>(), one.at(1).get<std::string>());
  for (const Json& note : json.at("notes")) plan.notes.push_back(exact(note));
  for (const Json& v : json.at("vanished"))
    plan.vanished.push_back(
        {v.at(0).get<std::string>(), exact(v.at(1)), v.at(2).get<std::uint64_t>(), exact(v.at(3))});
  plan.rest = list_in(json.at("rest"));
  for (const Json& list : json.at("shards")) plan.shards.push_back(list_in(list));
  return plan;
}

std::string word_of_its_own() {
  std::random_device device;
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%08x", device());
  return text.data();
}

/// Whether the last record contains a certificate or a draft, which needs key and register on the
/// host of the merge. Without a record, the shard detects the need.
bool needs_register(const fs::path& out, const CampaignState& c) {
  const auto last = evaluation::last_record(storage::results_folder(out, c.id));
  return last && *last && ((*last)->record.draft || !(*last)->record.certificate.empty());
}

bool is_for_shard(const CampaignState& c) {
  return c.action == Action::todo && c.status != evaluation::Status::failed;
}

std::vector<std::uint32_t> by_list(const fs::path& out, RunPlan& plan,
                                   const std::vector<CampaignState>& campaigns) {
  const auto rest = static_cast<std::uint32_t>(plan.shards.size());
  std::vector<std::uint32_t> list_of(campaigns.size(), rest);
  std::vector<std::size_t> next(plan.shards.size() + 1);  // next free place in each list
  for (std::size_t i = 0; i < campaigns.size(); ++i) {
    const CampaignState& c = campaigns[i];
    const bool to_do = is_for_shard(c);
    if (to_do) ++plan.to_do;
    if (to_do && !needs_register(out, c))
      list_of[i] = static_cast<std::uint32_t>(shard_of(c.id, plan.shards.size()));
    ++(list_of[i] == rest ? plan.rest : plan.shards[list_of[i]]).campaigns;
  }
  for (std::size_t k = 0; k < plan.shards.size(); ++k)
    next[k + 1] = next[k] + plan.shards[k].campaigns;
  std::vector<std::uint32_t> ordered(campaigns.size());
  for (std::size_t i = 0; i < campaigns.size(); ++i)
    ordered[next[list_of[i]]++] = static_cast<std::uint32_t>(i);
  return ordered;
}

}  // namespace

std::uint64_t shard_of(const std::string& campaign, std::uint64_t shards) {
  return storage::short_digest(storage::sha256(campaign)) % shards;
}

Expected<void> write_plan(const fs::path& out, RunPlan& plan,
                          const std::vector<CampaignState>& campaigns) {
  plan.id = std::to_string(plan.run.number) + "-" + word_of_its_own();
  plan.seen = campaigns.size();
  const std::vector<std::uint32_t> ordered = by_list(out, plan, campaigns);
  const fs::path folder = folder_of(out, plan);
  std::vector<std::string> names;
  for (std::uint64_t i = 0; i < plan.shards.size(); ++i) names.push_back(list_name(i));
  names.emplace_back(rest_name);
  const auto list_at = [&](std::size_t i) -> RunPlan::List& {
    return i < plan.shards.size() ? plan.shards[i] : plan.rest;
  };
  auto done = storage::write_temporaries(folder, {});  // creates the folder
  std::span<const std::uint32_t> left = ordered;
  for (std::size_t i = 0; done && i < names.size(); ++i) {
    RunPlan::List& list = list_at(i);
    done = write_list(folder, names[i], left.first(list.campaigns), campaigns, list);
    left = left.subspan(list.campaigns);
  }
  if (done)
    done = storage::rename_temporaries(folder, names, [&](const std::string& name) {
      const auto at = std::find(names.begin(), names.end(), name) - names.begin();
      const auto now = storage::sha256_of_file(folder / name);
      return now && *now == list_at(static_cast<std::size_t>(at)).sha256;
    });
  if (!done) {
    storage::remove_temporaries(folder, names);
    return done;
  }
  return storage::publish(out / state_folder / plan_folder,
                          {{plan_name, storage::dump(json_of(plan))}});
}

Expected<std::optional<RunPlan>> find_plan(const fs::path& out) {
  const fs::path path = out / state_folder / plan_folder / plan_name;
  NONIO_TRY(const auto there, storage::is_there(path));
  if (!there) return std::nullopt;
  NONIO_TRY(const auto text, storage::read_file(path));
  try {
    return plan_in(storage::parse(text));
  } catch (const std::exception& e) {
    return fail(damaged(path, e.what()));
  }
}

Expected<RunPlan> read_plan(const fs::path& out) {
  NONIO_TRY(auto plan, find_plan(out));
  if (plan) return std::move(*plan);
  return fail("no run is planned in " + out.string() +
              "; expected `nonio run plan SITE --out OUT --shards S` before");
}

Expected<void> remove_plan(const fs::path& out) {
  const fs::path folder = out / state_folder / plan_folder;
  std::error_code error;
  fs::remove(folder / plan_name, error);
  if (!error) fs::remove_all(folder, error);
  if (error) return fail("cannot remove " + folder.string() + ": " + error.message());
  return {};
}

Expected<void> check_made_with(const RunPlan& plan, const reading::Context& context) {
  const reading::Inputs here = reading::shared_inputs(context);
  std::string other;
  const auto add = [&](const std::string& name) { other += (other.empty() ? "" : ", ") + name; };
  for (const auto& one : here)
    if (std::find(plan.made_with.begin(), plan.made_with.end(), one) == plan.made_with.end())
      add(one.first);
  if (other.empty() && here.size() != plan.made_with.size()) add("what all campaigns share");
  if (other.empty()) return {};
  return fail("not the same as when run " + std::to_string(plan.run.number) +
              " was planned: " + other +
              "; expected the same program, plugins and templates on every host; if site.toml or a "
              "template was changed, plan the run again");
}

Expected<std::vector<Listed>> read_shard_list(const fs::path& out, const RunPlan& plan,
                                              std::uint64_t shard) {
  return read_list(folder_of(out, plan) / list_name(shard), plan.shards[shard]);
}

Expected<std::vector<Listed>> read_rest(const fs::path& out, const RunPlan& plan) {
  return read_list(folder_of(out, plan) / rest_name, plan.rest);
}

Expected<void> write_shard_record(const fs::path& out, const RunPlan& plan, std::uint64_t shard,
                                  const ShardRecord& record) {
  Json json = {{"schema", record_schema},
               {"plan", plan.id},
               {"shard", shard},
               {"list_sha256", plan.shards[shard].sha256},
               {"campaigns", Json::array()}};
  if (record.pack)
    json["pack"] = {
        {"name", record.pack->name}, {"bytes", record.pack->size}, {"sha256", record.pack->sha256}};
  for (const ShardResult& r : record.results) {
    Json one = {{"id", r.campaign}, {"status", to_text(r.status)}};
    if (r.status == evaluation::Status::none) one["status"] = "left to the merge";
    if (!r.stored) one["stored"] = false;
    if (r.packed) one["packed"] = true;
    if (!r.errors.empty()) one["errors"] = errors_json(r.errors);
    json["campaigns"].push_back(std::move(one));
  }
  return storage::publish(folder_of(out, plan), {{shard_record_name(shard), storage::dump(json)}});
}

Expected<std::optional<ShardRecord>> read_shard_record(const fs::path& out, const RunPlan& plan,
                                                       std::uint64_t shard) {
  const fs::path path = folder_of(out, plan) / shard_record_name(shard);
  const auto text = storage::read_file(path);
  if (!text) {
    const auto there = storage::is_there(path);
    if (there && !*there) return std::nullopt;
    return fail(text.error());
  }
  ShardRecord record;
  try {
    const Json json = storage::parse(*text);
    if (json.at("schema") != record_schema || json.at("plan") != plan.id ||
        json.at("shard") != shard || json.at("list_sha256") != plan.shards[shard].sha256)
      return fail(path.string() + " is of another plan; run the shard again");
    if (json.contains("pack")) {
      const Json& pack = json["pack"];
      record.pack = storage::PackFile{pack.at("name").get<std::string>(),
                                      pack.at("bytes").get<std::uint64_t>(),
                                      pack.at("sha256").get<std::string>()};
      if (!storage::is_pack_name(record.pack->name)) throw std::runtime_error("no name of a pack");
    }
    for (const Json& one : json.at("campaigns")) {
      ShardResult r;
      r.campaign = one.at("id").get<std::string>();
      r.status = status_in(one.at("status"));
      r.stored = one.value("stored", true);
      r.packed = one.value("packed", false);
      if (one.contains("errors")) r.errors = errors_in(one["errors"]);
      record.results.push_back(std::move(r));
    }
  } catch (const std::exception& e) {
    return fail(path.string() + " is damaged (" + e.what() + "); run the shard again");
  }
  return record;
}

std::uint64_t reported(const fs::path& out, const RunPlan& plan) {
  std::uint64_t count = 0;
  for (std::uint64_t i = 0; i < plan.shards.size(); ++i)
    if (storage::is_there(folder_of(out, plan) / shard_record_name(i)).value_or(false)) ++count;
  return count;
}

}  // namespace nonio::batch
