// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/filter.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace nonio::process {

// Seccomp programs. make_filters generates them at build time, so that their generation cannot fail
// during a run.

/// Filters for the process that loads plugins, for a process that runs one command, and for a
/// process that evaluates (in addition to the first filter).
extern const std::span<const sock_filter> loading_filter, visit_filter, computing_filter;

constexpr std::size_t most_filter_steps = 512;

/// Placeholders for the ids of this process and its parent, which are inserted when the filter is
/// installed. No process has such an id.
constexpr std::uint32_t own_process = 0x7FFFFFF1, parent_process = 0x7FFFFFF2;

}  // namespace nonio::process
