// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace nonio::process {

/// What became of a child process.
struct ChildEnd {
  bool well = false;  ///< it exited with 0
  std::string words;  ///< else: "signal 11 (Segmentation fault)", "exit status 3"
  bool overdue = false;
};

/// From the status of waitpid.
ChildEnd child_end(int wait_status);

/// Kills a child with its process group and takes its status. One that waits for a disk in the
/// kernel ends when the disk answers: after two seconds it is left behind.
ChildEnd end_child(pid_t child);

/// Waits up to `seconds`; kills the child's process group if it takes longer.
ChildEnd wait_for_child(pid_t child, double seconds);

std::vector<pid_t> own_children();
/// Ends all but these, and whatever they leave where this process is a subreaper. One that waits
/// for a disk in the kernel is left behind.
void end_children(const std::vector<pid_t>& kept);

/// To be called first in a child: its own process group, ended with its parent, no core file, its
/// standard output joined to the standard error so that results on stdout stay clean.
void init_child();

/// To be called by a child that prints nothing: a reader of the parent's output waits until every
/// process has closed it, also a child that outlives the parent.
void keep_silent();

/// Private memory that the process may have from now on. Without effect under a sanitizer, whose
/// shadow memory is larger than any limit.
void limit_memory(double megabytes);

/// Memory that a worker gives back to the system would only be faulted in again for the next
/// campaign.
void keep_freed_memory();
/// `fork`, tried again for two seconds where the system has no process to give just now.
pid_t fork_patiently();
/// Bytes that the process has from the system for its data.
std::size_t memory_held();
/// Whether that has become noticeably more: more than the tables and reports of a campaign need,
/// far less than would hurt the next one.
bool has_grown(std::size_t at_start);

}  // namespace nonio::process
