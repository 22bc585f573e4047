// SPDX-License-Identifier: Apache-2.0
#include "batch/state/read_apart.h"

#include <utility>
#include <vector>

#include "platform/process/stop.h"

namespace nonio::batch {

Expected<std::string> bytes_apart(const std::string& what, double seconds,
                                  const std::function<std::string(process::SignsOfLife&)>& read) {
  auto started = process::Watched::start(
      [&](process::SignsOfLife& signs, const process::Watched::Send& send) { send(read(signs)); });
  if (!started) {
    process::SignsOfLife alone{};
    return read(alone);
  }
  std::vector<process::Watched> children;
  children.push_back(std::move(*started));
  process::Watched& child = children.front();
  std::optional<std::string> bytes;
  while (!child.ended()) {
    if (process::is_stop_requested()) return fail("interrupted");
    if (child.is_silent(seconds))
      return fail("cannot read " + what + ": " + process::no_answer(seconds));
    process::wait_for_any(children);
    for (std::string& piece : child.take()) bytes = std::move(piece);
  }
  if (bytes) return std::move(*bytes);
  return fail("cannot read " + what + ": the process that reads it ended: " + child.end().words);
}

}  // namespace nonio::batch
