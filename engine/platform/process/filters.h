// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/filter.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace nonio::process {

// Which system calls a process may make, as the kernel takes it (seccomp). Made by make_filters
// when Nonio is built, so that nothing can go wrong with them in a run.

/// For the process that loads plugins; for the work of one command; for a process that evaluates,
/// in addition to the first.
extern const std::span<const sock_filter> loading_filter, visit_filter, computing_filter;

constexpr std::size_t most_filter_steps = 512;

/// Placeholders in a filter for the processes that are known when it is loaded; no process has such
/// a number.
constexpr std::uint32_t own_process = 0x7FFFFFF1, parent_process = 0x7FFFFFF2;

}  // namespace nonio::process
