// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "live/calculation.h"
#include "platform/process/channel.h"

/// The bench process keeps a campaign and its plugins in memory. It has one thread, reads the
/// campaign once, and makes a child process for each request. So readings are shared, a crash costs
/// one answer, and a request is cancelled by ending its child.
namespace nonio::live {

/// Messages from the bench process to the server, packed: number of the job, state, text. Job 0 is
/// the campaign itself: "opened" with `described`, then "catalogue" if `described` does not contain
/// the catalogue, or "failed".
namespace job_state {
inline constexpr const char* opened = "opened";
inline constexpr const char* catalogue = "catalogue";
inline constexpr const char* running = "running";  ///< state of a job that is still running; text:
                                                   ///< elapsed seconds
inline constexpr const char* begun = "begun";      ///< state of a job with an incomplete answer;
                                                   ///< text: first part of the answer
inline constexpr const char* done = "done";
inline constexpr const char* failed = "failed";
}  // namespace job_state

/// Answers requests until the server has closed the connection. A request is packed: "do" or
/// "cancel", number of the job, JSON.
[[noreturn]] void run_bench(const BenchWish& wish, process::Handle channel);

}  // namespace nonio::live
