// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "live/calculation.h"
#include "platform/process/channel.h"

/// The process that holds a campaign and its plugins. It has one thread, reads the campaign once,
/// and makes a child for each request: readings are shared, a crash costs one answer, and a request
/// is cancelled by the end of its child.
namespace nonio::live {

/// What travels from the bench process to the server, packed: number of the job, state, text.
/// Job 0: the campaign itself ("opened" with `described`, perhaps "catalogue" later, or "failed").
namespace job_state {
inline constexpr const char* opened = "opened";
inline constexpr const char* catalogue = "catalogue";
inline constexpr const char* running = "running";  ///< text: seconds so far
inline constexpr const char* begun = "begun";      ///< text: what is there before all of it
inline constexpr const char* done = "done";
inline constexpr const char* failed = "failed";
}  // namespace job_state

/// Answers requests until the other side has closed the connection. A request is packed: "do" or
/// "cancel", number of the job, JSON.
[[noreturn]] void run_bench(const BenchWish& wish, process::Handle channel);

}  // namespace nonio::live
