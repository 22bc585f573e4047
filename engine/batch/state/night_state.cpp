// SPDX-License-Identifier: Apache-2.0
#include "batch/state/night_state.h"

#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>

#include "batch/state/night_plan.h"
#include "batch/state/output_lock.h"
#include "batch/state/read_apart.h"
#include "campaign/evaluation/record.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"

namespace nonio::batch {
namespace fs = std::filesystem;

namespace {

constexpr const char* state_name = "night.json";

storage::Json json_of(const NightEnd& end) {
  return {{"night", end.night.number},
          {"date", end.night.date},
          {"seen", end.seen},
          {"failed", end.failed}};
}

std::optional<std::uint64_t> known_count(const storage::Json& json, const char* key) {
  const auto it = json.find(key);
  if (it == json.end() || !it->is_number_unsigned()) return std::nullopt;
  return it->get<std::uint64_t>();
}

std::string known_text(const storage::Json& json, const char* key) {
  const auto it = json.find(key);
  return it != json.end() && it->is_string() ? it->get<std::string>() : "";
}

std::optional<NightEnd> end_in(const storage::Json& json, const char* key) {
  const auto it = json.find(key);
  if (it == json.end() || !it->is_object()) return std::nullopt;
  const auto number = known_count(*it, "night");
  const auto seen = known_count(*it, "seen");
  if (!number || !seen) return std::nullopt;
  return NightEnd{
      {*number, known_text(*it, "date")}, *seen, known_count(*it, "failed").value_or(0)};
}

/// None if there is no such file; an error if it cannot be read or is something else.
Expected<std::optional<storage::Json>> read_state(const fs::path& out) {
  const fs::path path = out / state_folder / state_name;
  std::error_code error;
  if (fs::symlink_status(path, error).type() == fs::file_type::not_found) return std::nullopt;
  NONIO_TRY(const auto file, storage::read_file(path));
  storage::Json json = storage::Json::parse(file, nullptr, false);
  if (json.is_discarded() || !json.is_object() || !known_count(json, "night"))
    return fail(path.string() + " is damaged; remove it to do every campaign anew");
  return json;
}

/// `end`: of a run that is complete; none while it is running.
Expected<void> write_state(const fs::path& out, const NightState& night,
                           const std::optional<NightEnd>& end) {
  storage::Json json = {{"schema", "nonio-night/1"}, {"night", night.number},
                        {"date", night.date},        {"state", end ? "complete" : "running"},
                        {"force", night.force},      {"site", night.site}};
  if (end) json["end"] = json_of(*end);
  if (night.last) json["last"] = json_of(*night.last);
  if (night.issued_before) json["issued_before"] = *night.issued_before;
  if (night.issued_at_begin) json["issued_at_begin"] = *night.issued_at_begin;
  return storage::publish(out / state_folder, {{state_name, storage::dump(json)}});
}

/// Why the results of `site` may not go among those of `other`; empty if they may. A site that was
/// moved is the same one under another name, and its old folder no longer exists.
std::string other_site(const std::string& other, const std::string& site, const fs::path& out) {
  std::error_code error;
  if (other.empty() || other == site || !fs::is_directory(other, error) ||
      fs::equivalent(other, site, error))
    return {};
  return "the output folder " + out.string() + " holds the results of the site " + other +
         "; expected a folder of its own for " + site;
}

/// How the first results that are met in an output folder lie; nothing if there are none.
std::optional<bool> lie_hashed(const fs::path& out) {
  std::error_code error;
  const auto has_results = [&](const fs::path& folder) {
    return fs::exists(folder / evaluation::record_name, error);
  };
  for (fs::directory_iterator it(out, error), end; !error && it != end; it.increment(error)) {
    if (has_results(it->path())) return false;
    if (it->path().filename().string().size() != 2) continue;
    std::error_code ignored;
    for (const auto& inner : fs::directory_iterator(it->path(), ignored))
      if (has_results(inner.path())) return true;
  }
  return std::nullopt;
}

}  // namespace

namespace {

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  ::localtime_r(&now, &local);
  std::array<char, 16> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%d", &local)};
}

}  // namespace

namespace {

/// An error if the results are those of another site that is still there.
Expected<void> check_site(const storage::Json& json, const std::string& site, const fs::path& out) {
  const std::string known = known_text(json, "site");
  if (known == site) return {};
  const auto why = read_apart<std::string>(
      "the site " + known, config::Limits{}.disk_seconds,
      [&](process::SignsOfLife&) { return Expected<std::string>(other_site(known, site, out)); });
  if (!why) return fail(why.error());
  if (!why->empty()) return fail(*why);
  return {};
}

}  // namespace

Expected<NightState> reopen_night(const RunOptions& options, const std::string& site) {
  NONIO_TRY(const auto state, read_state(options.out));
  if (!state || known_text(*state, "state") != "complete")
    return fail(
        "--only evaluates one campaign of a complete run again; expected `nonio run SITE --out "
        "OUT` before");
  const storage::Json& json = *state;
  if (auto own = check_site(json, site, options.out); !own) return fail(own.error());
  NightState night;
  night.reopened = true;
  night.site = site;
  night.number = json["night"].get<std::uint64_t>();
  night.date = known_text(json, "date");
  night.last = end_in(json, "last");
  night.issued_before = known_count(json, "issued_at_begin");
  if (!night.issued_before) night.issued_before = known_count(json, "issued_before");
  night.issued_at_begin = night.issued_before;
  return night;
}

Expected<NightState> planned_night(const RunOptions& options, const std::string& site,
                                   std::uint64_t number) {
  NONIO_TRY(const auto state, read_state(options.out));
  if (!state || known_text(*state, "state") != "running" || known_count(*state, "night") != number)
    return fail("run " + std::to_string(number) + " was planned in " + options.out.string() +
                ", and is not the run in progress there; expected `nonio run cancel OUT`, "
                "then a new plan");
  const storage::Json& json = *state;
  if (auto own = check_site(json, site, options.out); !own) return fail(own.error());
  NightState night;
  night.number = number;
  night.date = known_text(json, "date");
  night.last = end_in(json, "last");
  night.force = json.value("force", false);
  night.site = known_text(json, "site");
  night.issued_before = known_count(json, "issued_before");
  return night;
}

Expected<NightState> begin_night(const RunOptions& options, const std::string& site,
                                 std::optional<std::uint64_t> issued_so_far) {
  NightState night;
  const fs::path& out = options.out;
  night.site = site;
  night.force = options.force;
  night.date = options.date.empty() ? today() : options.date;
  night.issued_before = issued_so_far;
  NONIO_TRY(const auto state, read_state(out));
  if (state) {
    const storage::Json& json = *state;
    if (auto own = check_site(json, site, out); !own) return fail(own.error());
    night.resumed = known_text(json, "state") == "running";
    night.number = json["night"].get<std::uint64_t>() + (night.resumed ? 0 : 1);
    // A forced run that was interrupted is finished as what it was.
    if (night.resumed) night.force = options.force || json.value("force", false);
    if (night.resumed && options.date.empty() && json.contains("date"))
      night.date = known_text(json, "date");
    if (const auto issued = known_count(json, "issued_before")) night.issued_before = issued;
    night.last = end_in(json, night.resumed ? "last" : "end");
  }
  if (options.dry_run) return night;
  if (auto written = write_state(out, night, {}); !written) return fail(written.error());
  return night;
}

Expected<void> end_night(const fs::path& out, const NightState& night, const NightEnd& end) {
  return write_state(out, night, end);
}

const char* to_text(NightStatus::State state) {
  using State = NightStatus::State;
  return state == State::complete  ? "complete"
         : state == State::running ? "running"
         : state == State::planned ? "planned"
                                   : "cut-short";
}

Expected<NightStatus> night_status(const fs::path& out) {
  NONIO_TRY(const auto state, read_state(out));
  if (!state)
    return fail("no run was started in " + out.string() +
                "; expected the output folder of `nonio run`");
  const storage::Json& json = *state;
  NightStatus status;
  status.night = {*known_count(json, "night"), known_text(json, "date")};
  if (known_text(json, "state") == "complete") {
    status.last = end_in(json, "end");
    if (!status.last) status.last = NightEnd{status.night, 0, 0};
  } else {
    status.used_by = user_of(out);
    status.state =
        status.used_by.empty() ? NightStatus::State::cut_short : NightStatus::State::running;
    if (const auto plan = find_plan(out); plan && *plan) {
      status.state = NightStatus::State::planned;
      status.shards = (*plan)->shards.size();
      status.reported = reported(out, **plan);
    }
    status.last = end_in(json, "last");
  }
  struct stat summary {};
  const fs::path path = out / "summary.json";
  if (status.last && ::stat(path.c_str(), &summary) != 0)
    return fail("cannot read " + path.string() + ": " + std::strerror(errno));
  status.age = std::difftime(std::time(nullptr), summary.st_mtim.tv_sec);
  return status;
}

Expected<void> settle_folders(const fs::path& out, bool hashed, bool dry_run) {
  NONIO_TRY(const auto marked, storage::is_there(out / storage::hashed_mark));
  if (marked && hashed) return {};
  NONIO_TRY(const auto begun, storage::is_there(out / state_folder / state_name));
  const bool are_hashed = marked || (!begun && lie_hashed(out) == true);
  const bool are_flat = !are_hashed && (begun || lie_hashed(out) == false);
  if (hashed ? are_flat : are_hashed)
    return fail("the output folder " + out.string() + " has its results in OUT/" +
                (hashed ? "<id>" : "ab/<id>") + ", and site.toml wants them in OUT/" +
                (hashed ? "ab/<id> ([results] folders = \"hashed\")" : "<id>") +
                "; expected a new output folder, or its present layout");
  if (dry_run || !hashed) return {};
  return storage::publish((out / storage::hashed_mark).parent_path(),
                          {{(out / storage::hashed_mark).filename().string(), "OUT/ab/<id>\n"}});
}

Expected<void> check_not_planned(const fs::path& out) {
  NONIO_TRY(const auto planned, storage::is_there(out / state_folder / plan_folder / plan_name));
  if (!planned) return {};
  return fail("a run is planned in " + out.string() +
              " and not merged yet; expected its shards and `nonio run merge OUT`, or `nonio "
              "run cancel OUT` to withdraw the plan");
}

}  // namespace nonio::batch
