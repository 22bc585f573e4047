// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace nonio::process {

/// Requests that a run, or a command that waits, ends soon. Safe in a signal handler.
void request_stop();
bool is_stop_requested();

}  // namespace nonio::process
