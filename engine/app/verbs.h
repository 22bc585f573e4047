// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common.h"

/// The commands of the program. `common` is set before a command is run.
namespace nonio::app {

Verb new_verb(Common& common);
Verb import_verb(Common& common);
Verb check_verb(Common& common);
Verb run_verb(Common& common);
/// Returns the commands below `run`: plan, merge, cancel, unlock.
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
/// Returns the commands about the register: list, withdraw, audit.
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
/// Return the commands `help` and `completion`. They print from the table of commands in `program`,
/// which must outlive them.
Verb help_verb(const Program& program);
Verb completion_verb(const Program& program);

/// Prints the history of a machine, or of all (`machine` empty), on stdout. Returns the exit
/// status.
int show_machine(const std::string& out, const std::string& machine, const Common& common);
/// Opens the report of a campaign, or of the first one of a run with status `attention`, on the
/// desktop. Returns the exit status.
int open_document(const std::string& folder, const std::string& out, const Common& common);
/// Checks the templates of a site, or the installed ones. Returns the exit status.
int check_templates(const std::string& site, const Common& common);

struct WorklistWish {
  std::string out, since, customer, language, site, page;
};
/// Prints the actions that the last run requires, one line each, or the page that `wish` names.
/// Returns the exit status: 1 if action is required.
int print_worklist(const WorklistWish& wish, const Common& common);

}  // namespace nonio::app
