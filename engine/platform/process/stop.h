// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace nonio::process {

/// Requests the early end of a run or of a waiting command. Safe in a signal handler.
void request_stop();
bool is_stop_requested();

}  // namespace nonio::process
