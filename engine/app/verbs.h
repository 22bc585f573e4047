// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common.h"

/// The verbs of the program. `common` is filled before one of them is run.
namespace nonio::app {

Verb ack_verb(Common& common);
Verb apply_verb(Common& common);
Verb certificates_verb(Common& common);
Verb compare_verb(Common& common);
Verb controllers_verb(Common& common);
Verb diff_verb(Common& common);
Verb event_verb(Common& common);
Verb explain_verb(Common& common);
Verb forget_verb(Common& common);
Verb import_verb(Common& common);
Verb live_verb(Common& common);
Verb merge_verb(Common& common);
Verb model_verb(Common& common);
Verb morning_verb(Common& common);
Verb new_verb(Common& common);
Verb night_verb(Common& common);
Verb open_verb(Common& common);
Verb plan_verb(Common& common);
Verb plugin_verb(Common& common);
Verb plugins_verb(Common& common);
Verb query_verb(Common& common);
Verb get_verb(Common& common);
Verb history_verb(Common& common);
Verb release_verb(Common& common);
Verb restamp_verb(Common& common);
Verb run_verb(Common& common);
Verb schema_verb(Common& common);
Verb show_verb(Common& common);
Verb simulate_verb(Common& common);
Verb status_verb(Common& common);
Verb template_verb(Common& common);
Verb verify_verb(Common& common);
Verb version_verb(Common& common);
/// What they print is made from the whole table; the program outlives the verb.
Verb help_verb(const Program& program);
Verb completion_verb(const Program& program);
/// Below `plan`.
Verb plan_rotary_verb(Common& common);
Verb plan_table_verb(Common& common);
Verb sign_probe_verb(Common& common);

}  // namespace nonio::app
