// SPDX-License-Identifier: Apache-2.0
#include "batch/state/run_state.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>

#include "batch/state/output_lock.h"
#include "batch/state/read_apart.h"
#include "batch/state/run_plan.h"
#include "campaign/evaluation/record.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"

namespace nonio::batch {
namespace fs = std::filesystem;

namespace {

constexpr const char* state_name = "night.json";
constexpr const char* seconds_name = "seconds";

/// Stores the duration (s) as the modification time of an empty file, so that equal inputs give
/// equal bytes of all files.
Expected<void> keep_seconds(const fs::path& out, double seconds) {
  const fs::path folder = out / state_folder;
  std::error_code error;
  if (!fs::exists(folder / seconds_name, error))
    if (auto kept = storage::publish(folder, {{seconds_name, ""}}); !kept) return kept;
  const auto whole = static_cast<std::time_t>(seconds);
  const timespec at{whole, static_cast<long>((seconds - static_cast<double>(whole)) * 1e9)};
  const timespec times[2] = {at, at};
  const fs::path path = folder / seconds_name;
  if (::utimensat(AT_FDCWD, path.c_str(), times, AT_SYMLINK_NOFOLLOW) != 0)
    return fail(Error{std::strerror(errno), path.string()});
  return {};
}

/// Returns std::nullopt for times that cannot be durations, such as those of a copied file.
std::optional<double> seconds_in(const fs::path& out) {
  constexpr std::time_t longest = std::time_t{366} * 86400;
  struct stat info {};
  const fs::path path = out / state_folder / seconds_name;
  if (::stat(path.c_str(), &info) != 0 || info.st_mtim.tv_sec > longest) return std::nullopt;
  const double seconds =
      static_cast<double>(info.st_mtim.tv_sec) + 1e-9 * static_cast<double>(info.st_mtim.tv_nsec);
  return seconds > 0.0 ? std::optional(seconds) : std::nullopt;
}

storage::Json json_of(const RunEnd& end) {
  return {{"night", end.run.number},
          {"date", end.run.date},
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

std::optional<RunEnd> end_in(const storage::Json& json, const char* key) {
  const auto it = json.find(key);
  if (it == json.end() || !it->is_object()) return std::nullopt;
  const auto number = known_count(*it, "night");
  const auto seen = known_count(*it, "seen");
  if (!number || !seen) return std::nullopt;
  return RunEnd{{*number, known_text(*it, "date")}, *seen, known_count(*it, "failed").value_or(0)};
}

Expected<std::optional<storage::Json>> read_state(const fs::path& out) {
  const fs::path path = out / state_folder / state_name;
  std::error_code error;
  if (fs::symlink_status(path, error).type() == fs::file_type::not_found) return std::nullopt;
  NONIO_TRY(const auto file, storage::read_file(path));
  storage::Json json = storage::parse_or_discard(file);
  if (json.is_discarded() || !json.is_object() || !known_count(json, "night"))
    return fail(path.string() + " is damaged; remove it to do every campaign anew");
  return json;
}

Expected<void> write_state(const fs::path& out, const RunState& run,
                           const std::optional<RunEnd>& end) {
  storage::Json json = {{"schema", "nonio-night/1"}, {"night", run.number},
                        {"date", run.date},          {"state", end ? "complete" : "running"},
                        {"force", run.force},        {"site", run.site}};
  if (end) json["end"] = json_of(*end);
  if (run.last) json["last"] = json_of(*run.last);
  if (run.issued_before) json["issued_before"] = *run.issued_before;
  if (run.issued_at_begin) json["issued_at_begin"] = *run.issued_at_begin;
  return storage::publish(out / state_folder, {{state_name, storage::dump(json)}});
}

/// Returns the reason why results of both sites must not share a folder, or an empty string. A site
/// whose former folder does not exist was moved.
std::string other_site(const std::string& other, const std::string& site, const fs::path& out) {
  std::error_code error;
  if (other.empty() || other == site || !fs::is_directory(other, error) ||
      fs::equivalent(other, site, error))
    return {};
  return "the output folder " + out.string() + " holds the results of the site " + other +
         "; expected a folder of its own for " + site;
}

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

Expected<void> check_site(const storage::Json& json, const std::string& site, const fs::path& out) {
  const std::string known = known_text(json, "site");
  if (known == site) return {};
  NONIO_TRY(const auto why,
            read_apart<std::string>("the site " + known, config::Limits{}.disk_seconds,
                                    [&](process::SignsOfLife&) {
                                      return Expected<std::string>(other_site(known, site, out));
                                    }));
  if (!why.empty()) return fail(why);
  return {};
}

}  // namespace

std::string site_of(const fs::path& out) {
  const auto state = read_state(out);
  return state && *state ? known_text(**state, "site") : "";
}

Expected<RunState> reopen_run(const RunOptions& options, const std::string& site) {
  NONIO_TRY(const auto state, read_state(options.out));
  if (!state || known_text(*state, "state") != "complete")
    return fail(
        "--only evaluates one campaign of a complete run again; expected `nonio run SITE --out "
        "OUT` before");
  const storage::Json& json = *state;
  if (auto own = check_site(json, site, options.out); !own) return fail(own.error());
  RunState run;
  run.reopened = true;
  run.site = site;
  run.number = json["night"].get<std::uint64_t>();
  run.date = known_text(json, "date");
  run.last = end_in(json, "last");
  run.issued_before = known_count(json, "issued_at_begin");
  if (!run.issued_before) run.issued_before = known_count(json, "issued_before");
  run.issued_at_begin = run.issued_before;
  return run;
}

Expected<RunState> planned_run(const RunOptions& options, const std::string& site,
                               std::uint64_t number) {
  NONIO_TRY(const auto state, read_state(options.out));
  if (!state || known_text(*state, "state") != "running" || known_count(*state, "night") != number)
    return fail("run " + std::to_string(number) + " was planned in " + options.out.string() +
                ", and is not the run in progress there; expected `nonio run cancel OUT`, "
                "then a new plan");
  const storage::Json& json = *state;
  if (auto own = check_site(json, site, options.out); !own) return fail(own.error());
  RunState run;
  run.number = number;
  run.date = known_text(json, "date");
  run.last = end_in(json, "last");
  run.force = json.value("force", false);
  run.site = known_text(json, "site");
  run.issued_before = known_count(json, "issued_before");
  return run;
}

Expected<RunState> begin_run(const RunOptions& options, const std::string& site,
                             std::optional<std::uint64_t> issued_so_far) {
  RunState run;
  const fs::path& out = options.out;
  run.site = site;
  run.force = options.force;
  run.date = options.date.empty() ? today() : options.date;
  run.issued_before = issued_so_far;
  run.began = std::chrono::steady_clock::now();
  NONIO_TRY(const auto state, read_state(out));
  if (state) {
    const storage::Json& json = *state;
    if (auto own = check_site(json, site, out); !own) return fail(own.error());
    run.resumed = known_text(json, "state") == "running";
    run.number = json["night"].get<std::uint64_t>() + (run.resumed ? 0 : 1);
    // An interrupted run with --force is also completed with --force.
    if (run.resumed) run.force = options.force || json.value("force", false);
    if (run.resumed && options.date.empty() && json.contains("date"))
      run.date = known_text(json, "date");
    if (const auto issued = known_count(json, "issued_before")) run.issued_before = issued;
    run.last = end_in(json, run.resumed ? "last" : "end");
  }
  if (options.dry_run) return run;
  if (auto written = write_state(out, run, {}); !written) return fail(written.error());
  return run;
}

Expected<void> end_run(const fs::path& out, const RunState& run, const RunEnd& end) {
  if (auto written = write_state(out, run, end); !written || run.reopened) return written;
  const auto lasted = run.began ? std::chrono::steady_clock::now() - *run.began
                                : std::chrono::steady_clock::duration::zero();
  return keep_seconds(out, std::chrono::duration<double>(lasted).count());
}

const char* to_text(RunStatus::State state) {
  using State = RunStatus::State;
  return state == State::complete  ? "complete"
         : state == State::running ? "running"
         : state == State::planned ? "planned"
                                   : "cut-short";
}

Expected<RunStatus> run_status(const fs::path& out) {
  NONIO_TRY(const auto state, read_state(out));
  if (!state)
    return fail("no run was started in " + out.string() +
                "; expected the output folder of `nonio run`");
  const storage::Json& json = *state;
  RunStatus status;
  status.run = {*known_count(json, "night"), known_text(json, "date")};
  if (known_text(json, "state") == "complete") {
    status.last = end_in(json, "end");
    if (!status.last) status.last = RunEnd{status.run, 0, 0};
  } else {
    status.used_by = user_of(out);
    status.state = status.used_by.empty() ? RunStatus::State::cut_short : RunStatus::State::running;
    if (const auto plan = find_plan(out); plan && *plan) {
      status.state = RunStatus::State::planned;
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
  status.seconds = seconds_in(out);
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
