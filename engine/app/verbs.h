// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common.h"

/// The commands. `common` contains the values of the common arguments when a command runs.
namespace nonio::app {

Verb new_verb(Common& common);
Verb import_verb(Common& common);
Verb check_verb(Common& common);
Verb run_verb(Common& common);
/// Returns plan, merge, cancel and unlock, which are subcommands of `run`.
std::vector<Verb> run_parts(Common& common);
Verb status_verb(Common& common);
Verb show_verb(Common& common);
Verb export_verb(Common& common);
Verb serve_verb(Common& common);
Verb machine_list_verb(Common& common);
Verb history_verb(Common& common);
Verb event_verb(Common& common);
Verb ack_verb(Common& common);
Verb remove_verb(Common& common);
/// Returns the commands list, withdraw and audit of the certificate register.
std::vector<Verb> register_verbs(Common& common);
Verb approve_verb(Common& common);
Verb send_verb(Common& common);
Verb verify_verb(Common& common);
Verb extend_verb(Common& common);
Verb model_verb(Common& common);
Verb compare_verb(Common& common);
Verb explain_verb(Common& common);
Verb simulate_verb(Common& common);
Verb controls_verb(Common& common);
Verb diff_verb(Common& common);
Verb predict_verb(Common& common);
Verb insert_verb(Common& common);
Verb probe_verb(Common& common);
Verb session_verb(Common& common);
Verb plan_verb(Common& common);
Verb plan_rotary_verb(Common& common);
Verb plan_table_verb(Common& common);
Verb plugin_verb(Common& common);
Verb plugin_list_verb(Common& common);
Verb schema_verb(Common& common);
Verb upgrade_verb(Common& common);
Verb backup_verb(Common& common);
Verb restore_verb(Common& common);
Verb version_verb(Common& common);
/// `program` must outlive the commands, which print its table of commands.
Verb help_verb(const Program& program);
Verb completion_verb(const Program& program);

/// Prints the history of a machine, or of all machines if `machine` is empty. Returns the exit
/// status.
int show_machine(const std::string& out, const std::string& machine, const Common& common);
/// Opens the report of a campaign on the desktop; of a run, that of the first campaign with status
/// `attention`. Returns the exit status.
int open_document(const std::string& folder, const std::string& out, const Common& common);
int check_templates(const std::string& site, const Common& common);

struct WorklistWish {
  std::string out, since, customer, language, site, page;
};
/// Prints the actions that the last run requires, one per line, or the page `wish.page`. Returns
/// exit status 1 if action is required.
int print_worklist(const WorklistWish& wish, const Common& common);

}  // namespace nonio::app
