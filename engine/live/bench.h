// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "live/calculation.h"
#include "platform/process/channel.h"

/// The bench process keeps a campaign and its plugins in memory. It has one thread, reads the
/// campaign once and forks for each request, so that readings are shared, a crash affects one
/// answer, and ending the child cancels a request.
namespace nonio::live {

/// Messages to the server, packed: number of the job, state, text. Job 0 is the campaign: "opened"
/// with `described`, then "catalogue" if `described` lacks the catalogue; or "failed".
namespace job_state {
inline constexpr const char* opened = "opened";
inline constexpr const char* catalogue = "catalogue";
inline constexpr const char* running = "running";  ///< the text is the elapsed time in s
inline constexpr const char* begun = "begun";      ///< the text is the first part of the answer
inline constexpr const char* done = "done";
inline constexpr const char* failed = "failed";
}  // namespace job_state

/// Answers requests until the server has closed the connection. A request is packed: "do" or
/// "cancel", number of the job, JSON.
[[noreturn]] void run_bench(const BenchWish& wish, process::Handle channel);

}  // namespace nonio::live
