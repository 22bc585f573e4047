// SPDX-License-Identifier: Apache-2.0
#include "batch/workers/one_campaign.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <iterator>
#include <new>

#include "batch/commit/store.h"
#include "batch/survey/twins.h"
#include "certificates/certificates.h"
#include "platform/storage/database.h"
#include "platform/storage/files.h"

namespace nonio::batch {
namespace fs = std::filesystem;

namespace {

constexpr const char* register_elsewhere = "the register of certificates is on another host";
constexpr const char* register_locked =
    "the certificate register has been locked by another process since the run started";

/// Whether the host caused the error: lack of memory, or a disk or share that does not respond.
bool is_of_the_machine(const Error& e) {
  if (e.message.find("out of memory") != e.message.npos) return true;
  constexpr int codes[] = {EIO, ESTALE, ETIMEDOUT, ENOTCONN, EHOSTDOWN, EHOSTUNREACH, ENOMEM};
  return std::any_of(std::begin(codes), std::end(codes),
                     [&](int code) { return e.message.ends_with(std::strerror(code)); });
}
bool is_of_the_machine(const evaluation::Evaluated& evaluated) {
  const auto& errors = evaluated.results.errors;
  return std::any_of(errors.begin(), errors.end(),
                     [](const Error& e) { return is_of_the_machine(e); });
}

void fail_certificate(evaluation::Evaluated& evaluated, const Error& why) {
  certificates::remove_unsigned(evaluated);
  evaluated.results.errors.push_back(why);
  evaluated.status = evaluation::Status::failed;
  evaluated.retry = true;
}

/// The error is set if the register is on another host, damaged or locked. `locked` is set if the
/// register may be available later.
evaluation::AssignedNumber number_of(const SiteWork& site, const RegisterState& state,
                                     const evaluation::Evaluated& evaluated,
                                     const std::vector<std::string>& missing,
                                     certificates::CampaignFiles& files, bool as_draft,
                                     bool& locked) {
  evaluation::AssignedNumber assigned{std::nullopt, missing, std::nullopt};
  if (site.elsewhere) {
    locked = true;
    assigned.error = Error{register_elsewhere};
    return assigned;
  }
  if (!state.unsound.empty()) {
    assigned.error = Error{state.unsound};
  } else if (!state.read) {
    locked = true;
    assigned.error = Error{register_locked};
  } else {
    assigned = site.numbers.assign(evaluated, files, missing, as_draft);
    locked = locked || (assigned.error && storage::is_locked(*assigned.error));
  }
  return assigned;
}

Expected<std::optional<HistorySoFar>> history_of(const SiteWork& site, const CampaignState& c) {
  const auto basis = site.histories.find(c.id);
  if (basis == site.histories.end()) return std::optional<HistorySoFar>();
  NONIO_TRY(auto history, assessment::history_so_far(site.options.out, basis->second));
  return std::optional(std::move(history));
}

bool wants_signature(const evaluation::Evaluated& evaluated) {
  const auto& outputs = evaluated.results.outputs;
  return std::any_of(outputs.begin(), outputs.end(), [](const Results::Written& w) {
    return std::any_of(w.result.artifacts.begin(), w.result.artifacts.end(),
                       [](const Artifact& a) { return a.sign; });
  });
}

Expected<evaluation::Evaluated> evaluated_apart(const SiteWork& site, const RegisterState& state,
                                                const CampaignState& c, const fs::path& folder,
                                                certificates::CampaignFiles& files, bool as_draft,
                                                bool& locked, Evaluator& evaluator) {
  NONIO_TRY(const auto history, history_of(site, c));
  NONIO_TRY(const auto analysed,
            evaluator.analyse(folder, c.id, site.twins ? *site.twins : twins_of(c, site.campaigns),
                              history));
  std::optional<evaluation::AssignedNumber> number;
  if (analysed.missing)
    number = number_of(site, state, analysed.evaluated, *analysed.missing, files, as_draft, locked);
  return evaluator.write_documents(c.id, std::move(number));
}

/// Sets `locked` if the campaign must wait for the register.
Expected<evaluation::Evaluated> certified(const SiteWork& site, const RegisterState& state,
                                          const CampaignState& c, process::SharedStatus& stage,
                                          bool& locked, Evaluator& evaluator) {
  const fs::path folder = site.options.site / c.folder;
  certificates::CampaignFiles files(folder);
  auto evaluation = evaluated_apart(site, state, c, folder, files, false, locked, evaluator);
  if (evaluation && site.numbers.held_up(*evaluation))
    evaluation = evaluated_apart(site, state, c, folder, files, true, locked, evaluator);
  if (!evaluation) return evaluation;
  evaluation::Evaluated& evaluated = *evaluation;
  if (locked && site.elsewhere) return evaluation;
  if (evaluated.status != evaluation::Status::failed) site.numbers.hold_unreleased(evaluated);
  if (site.elsewhere && evaluated.status != evaluation::Status::failed) {
    locked = wants_signature(evaluated);
    return evaluation;
  }
  stage.set("signing");
  auto done =
      certificates::sign_artifacts(evaluated, files, site.context, site.signer, std::time(nullptr));
  if (done) done = site.numbers.issue(evaluated, c.folder);
  locked = locked || (!done && storage::is_locked(done.error()));
  if (!done) fail_certificate(evaluated, done.error());
  return evaluation;
}

Answer work(const SiteWork& site, const RegisterState& state, std::size_t index, bool first,
            process::SharedStatus& stage, Evaluator& evaluator, bool& shows_history) {
  if (first && site.signer != nullptr) site.signer->leave_to_worker();
  const CampaignState& c = site.campaigns[index];
  bool locked = false;
  const auto evaluation = certified(site, state, c, stage, locked, evaluator);
  if (!evaluation) {
    stage.set(evaluation.error().message);
    return Answer::not_stored;
  }
  const evaluation::Evaluated& evaluated = *evaluation;
  shows_history = evaluated.history.has_value();
  if (locked && !state.last_trial) return Answer::waits;
  if (evaluated.status == evaluation::Status::failed && !first) return Answer::again;
  const bool may_pass = evaluated.retry || is_of_the_machine(evaluated);
  if (evaluated.status == evaluation::Status::failed && !locked && !site.elsewhere &&
      !evaluated.results.errors.empty())
    site.numbers.note_failure(c.id, evaluated.results.errors.front().message);
  if (site.twins != nullptr && !(evaluated.certificate && evaluated.certificate->issued)) {
    stage.set(evaluated.results.errors.empty() ? "data are missing: run `nonio run` again"
                                               : evaluated.results.errors.front().message);
    return Answer::not_stored;
  }
  stage.set("writing the results");
  const auto staged = batch::stage(site.options.out, evaluated, site.context,
                                   {c.folder, site.run.of(), c.reason, may_pass});
  if (!staged) {
    stage.set(staged.error().message);
    return Answer::not_stored;
  }
  return evaluated.status == evaluation::Status::failed      ? Answer::failed
         : evaluated.status == evaluation::Status::attention ? Answer::attention
                                                             : Answer::ok;
}

}  // namespace

Answer do_campaign(const SiteWork& site, const RegisterState& state, std::size_t index, bool first,
                   process::SharedStatus& stage, Evaluator& evaluator, bool& shows_history) {
  try {
    return work(site, state, index, first, stage, evaluator, shows_history);
  } catch (const std::bad_alloc&) {
    stage.set(stage.get() +
              ": out of memory (the limit for one campaign is in site.toml, [limits])");
  } catch (const std::exception& e) {
    stage.set(stage.get() + ": " + e.what());
  }
  storage::remove_leftovers(storage::own_folder(site.options.out, site.campaigns[index].id));
  return Answer::not_stored;
}

}  // namespace nonio::batch
