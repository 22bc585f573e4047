// SPDX-License-Identifier: Apache-2.0
#include "read_apart.h"

#include <utility>
#include <vector>

#include "nonio/host/stop.h"

namespace nonio::host {

Expected<std::string> bytes_apart(const std::string& what, double seconds,
                                  const std::function<std::string(SignsOfLife&)>& read) {
  auto started = Watched::start([&](SignsOfLife& signs, const Watched::Send& send) {
    Parcel parcel;
    parcel.add(read(signs));
    send(parcel);
  });
  if (!started) {  // no process to be had is no reason to read nothing
    SignsOfLife alone{};
    return read(alone);
  }
  std::vector<Watched> children;
  children.push_back(std::move(*started));
  Watched& child = children.front();
  std::optional<std::string> bytes;
  while (!child.ended()) {
    if (is_stop_requested()) return fail("interrupted");
    if (child.is_silent(seconds)) return fail("cannot read " + what + ": " + no_answer(seconds));
    wait_for_parcels(children);
    for (Parcel& parcel : child.take()) bytes = parcel.text();
  }
  if (bytes) return std::move(*bytes);
  return fail("cannot read " + what + ": the process that reads it ended: " + child.end().words);
}

}  // namespace nonio::host
