// SPDX-License-Identifier: Apache-2.0
#include "batch/survey/known_numbers.h"

#include <algorithm>

#include "batch/state/read_apart.h"
#include "certificates/register_place.h"

namespace nonio::batch {
namespace fs = std::filesystem;

namespace {

/// Returns an error if the register is in an output folder inside the site, because it would be
/// lost with this folder.
Expected<void> check_register_place(const RunOptions& options, const reading::Context& context) {
  NONIO_TRY(const auto place, certificates::register_place(options.site, context.site.numbering));
  std::error_code error;
  const auto is_below = [](const fs::path& one, const fs::path& folder) {
    const fs::path way = one.lexically_relative(folder);
    return !way.empty() && *way.begin() != "..";
  };
  const fs::path out = fs::weakly_canonical(options.out, error);
  if (is_below(place.file, out) && is_below(out, fs::weakly_canonical(options.site, error)))
    return fail("the register of certificates " + place.name +
                " would lie in the output folder; expected it elsewhere in the site");
  return {};
}

}  // namespace

Expected<std::optional<Known>> known_of(const RunOptions& options, const reading::Context& context,
                                        Look look) {
  const config::Numbering& numbering = context.site.numbering;
  const double patience = std::min(5.0, numbering.patience);
  auto known = read_apart<
      std::pair<std::vector<certificates::RegisterEntry>, std::vector<certificates::WaitingDraft>>>(
      "the register of certificates", context.site.limits.disk_seconds + patience,
      [&](process::SignsOfLife& signs)
          -> Expected<std::pair<std::vector<certificates::RegisterEntry>,
                                std::vector<certificates::WaitingDraft>>> {
        if (!numbering.server) signs.reading((options.site / numbering.register_file).string());
        if (const auto sound = check_register_place(options, context); !sound)
          return fail(sound.error());
        NONIO_TRY(auto numbers, certificates::Register::entries(options.site, numbering, patience));
        if (!numbers.empty() && look == Look::first) {
          NONIO_TRY(auto opened, certificates::Register::open(options.site, numbering, patience));
          if (auto sound = opened.check_journal(false); !sound) return fail(sound.error());
        }
        signs.beat();
        NONIO_TRY(auto drafts, certificates::Register::drafts(options.site, numbering, patience));
        return std::pair(std::move(numbers), std::move(drafts));
      });
  if (!known && storage::is_locked(known.error())) return std::nullopt;
  if (!known) return fail(known.error());
  return Known{std::move(known->first), std::move(known->second)};
}

std::uint64_t issued_so_far(const std::vector<certificates::RegisterEntry>& numbers) {
  std::uint64_t last = 0;
  for (const certificates::RegisterEntry& e : numbers) last = std::max(last, e.order);
  return last;
}

}  // namespace nonio::batch
