// SPDX-License-Identifier: Apache-2.0
#include "platform/process/stop.h"

#include <atomic>

namespace nonio::process {
namespace {

std::atomic<bool> stop_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free);

}  // namespace

void request_stop() { stop_requested = true; }

bool is_stop_requested() { return stop_requested; }

}  // namespace nonio::process
