// SPDX-License-Identifier: Apache-2.0
#include "batch/workers/computing.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <set>

#include "batch/state/wire.h"
#include "campaign/evaluation/evaluation.h"
#include "platform/process/channel.h"
#include "platform/process/child.h"
#include "platform/storage/files.h"

namespace nonio::batch {
namespace fs = std::filesystem;

namespace {

constexpr char wants_file = 'f', has_analysed = 'a', has_done = 'e';

int ask_for_file(int stream, const fs::path& path) {
  if (!process::write_text(stream, wants_file + path.string())) ::_exit(0);
  auto handed = process::receive_descriptors(stream);
  if (!handed) ::_exit(0);
  if (!handed->descriptors.empty()) return handed->descriptors.front().release();
  errno = static_cast<unsigned char>(handed->word);
  return -1;
}

/// Reports the end of the analysis. If a number is required, sends the results and waits for it.
std::optional<evaluation::AssignedNumber> ask_for_number(
    int stream, const evaluation::AnalysedCampaign& analysed) {
  if (!analysed.number) {
    if (!process::write_text(stream, std::string(1, has_analysed))) ::_exit(0);
    return std::nullopt;
  }
  evaluation::AssignedNumber assigned;
  std::string reply;
  if (!process::write_text(
          stream, has_analysed + storage::pack(analysed.evaluated, analysed.number->missing)) ||
      !process::read_text(stream, reply) || !storage::unpack(reply, assigned))
    ::_exit(0);
  return assigned;
}

/// Returns the reason why the answer is not valid, or an empty string. The checked values decide
/// which files are written.
std::string unsound_answer(const evaluation::Evaluated& e, const std::string& id) {
  if (e.campaign.id != id) return "another campaign's results";
  if (e.status != evaluation::Status::ok && e.status != evaluation::Status::attention &&
      e.status != evaluation::Status::failed)
    return "no status";
  if ((e.status == evaluation::Status::failed) == e.results.errors.empty())
    return "a status against its errors";
  std::set<std::string> names;
  for (const Results::Written& w : e.results.outputs)
    for (const Artifact& a : w.result.artifacts)
      if (!storage::is_artifact_name(a.name) || !names.insert(a.name).second)
        return "an artifact that cannot be called \"" + a.name + "\"";
  return {};
}

}  // namespace

void evaluate_for(int stream, const reading::Context& context, process::SharedStatus& stage,
                  Prints& prints) {
  storage::open_files_with([stream](const fs::path& path) { return ask_for_file(stream, path); });
  process::keep_freed_memory();
  const std::size_t at_start = process::memory_held();
  std::string now;
  const reading::Stage tell = [&](const std::string& words) {
    prints.pass_on(now);
    now = words;
    stage.set(words);
  };
  for (std::string request; process::read_text(stream, request);) {
    fs::path folder;
    std::string id;
    reading::Twins twins;
    std::optional<HistorySoFar> history;
    if (!storage::unpack(request, folder, id, twins, history)) return;
    evaluation::AnalysedCampaign analysed = evaluation::analyse(
        reading::read_campaign(folder, context, tell), id, context, tell, twins);
    const auto number = ask_for_number(stream, analysed);
    const evaluation::Evaluated evaluated =
        evaluation::write_documents(std::move(analysed), number ? &*number : nullptr, context, tell,
                                    history ? &*history : nullptr);
    prints.pass_on(now);
    const bool grown = process::has_grown(at_start);
    if (!process::write_text(stream, has_done + storage::pack(evaluated, grown))) return;
  }
}

/// Sends a descriptor of a file of the campaign, or EACCES for secrets and for files outside the
/// campaign, except a manifest that is a link. Returns false if the message cannot be sent.
bool Evaluator::hand_out(const fs::path& folder, const std::string& path) const {
  std::error_code error;
  const fs::path root = fs::path(path).is_absolute() ? storage::real_folder(folder, error) : folder;
  const std::string inside = fs::path(path).lexically_relative(root).string();
  const auto full = inside == config::manifest_name
                        ? Expected<fs::path>(folder / config::manifest_name)
                        : storage::path_inside(folder, inside);
  const bool secret = full && std::any_of(secrets_.begin(), secrets_.end(), [&](const fs::path& s) {
                        return fs::equivalent(*full, s, error);
                      });
  if (!full || secret) return process::send_descriptors(stream_, static_cast<char>(EACCES), {});
  const process::Handle file(::open(full->c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  const int code = errno;
  return file ? process::send_descriptors(stream_, 0, {file.get()})
              : process::send_descriptors(stream_, static_cast<char>(code), {});
}

namespace {

constexpr const char* no_process_of_ours =
    "the process that evaluates states what no process of ours states";

}  // namespace

Expected<Evaluator::Analysed> Evaluator::analyse(const fs::path& folder, const std::string& id,
                                                 const reading::Twins& twins,
                                                 const std::optional<HistorySoFar>& history) {
  if (!process::write_text(stream_, storage::pack(folder, id, twins, history))) ::_exit(0);
  for (std::string said;;) {
    if (!process::read_text(stream_, said)) ::_exit(0);
    if (said.empty()) break;
    const std::string_view rest = std::string_view(said).substr(1);
    if (said[0] == wants_file) {
      if (!hand_out(folder, std::string(rest))) ::_exit(0);
      continue;
    }
    Analysed analysed;
    if (said[0] != has_analysed) break;
    if (rest.empty()) return analysed;
    if (!storage::unpack(rest, analysed.evaluated, analysed.missing.emplace()) ||
        analysed.evaluated.campaign.id != id)
      break;
    return analysed;
  }
  return fail(no_process_of_ours);
}

Expected<evaluation::Evaluated> Evaluator::write_documents(
    const std::string& id, std::optional<evaluation::AssignedNumber> assigned) {
  if (assigned && !process::write_text(stream_, storage::pack(*assigned))) ::_exit(0);
  std::string said;
  evaluation::Evaluated evaluated;
  if (!process::read_text(stream_, said)) ::_exit(0);
  if (said.empty() || said[0] != has_done ||
      !storage::unpack(std::string_view(said).substr(1), evaluated, grown_))
    return fail(no_process_of_ours);
  if (const std::string why = unsound_answer(evaluated, id); !why.empty())
    return fail("the process that evaluates gave " + why);
  // Only the output of a certificate is accepted from the process with the plugins; its other
  // members are those of this process.
  if (evaluated.certificate) {
    if (!assigned || !assigned->certificate) return fail(no_process_of_ours);
    assigned->certificate->output = evaluated.certificate->output;
    evaluated.certificate = std::move(assigned->certificate);
  }
  return evaluated;
}

}  // namespace nonio::batch
