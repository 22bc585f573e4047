# SPDX-License-Identifier: Apache-2.0
# What the products of the engine do without a process around it, one folder for each.
add_executable(test_engine
  batch/campaign_state_test.cpp batch/earlier_results_test.cpp batch/run_plan_test.cpp batch/store_test.cpp
  platform/storage/files_test.cpp
  campaign/config/causes_test.cpp campaign/config/formula_test.cpp campaign/config/keys_test.cpp campaign/config/machines_test.cpp campaign/config/manifest_test.cpp campaign/config/schema_test.cpp
  campaign/config/secrets_test.cpp campaign/config/site_logs_test.cpp campaign/config/upgrade_test.cpp campaign/config/words_test.cpp
  live/campaign_index_test.cpp live/difference_test.cpp live/events_test.cpp live/guard_test.cpp live/session_test.cpp
  campaign/modelling/model_edit_test.cpp
  campaign/evaluation/decision_test.cpp campaign/evaluation/record_test.cpp
  campaign/loader/plugins_test.cpp campaign/reading/long_series_test.cpp campaign/reading/turned_test.cpp
  laboratory/store/store_test.cpp
  laboratory/assessment/changes_test.cpp laboratory/assessment/curves_test.cpp laboratory/assessment/fits_test.cpp laboratory/assessment/kept_test.cpp
  laboratory/assessment/history_so_far_test.cpp laboratory/assessment/line_causes_test.cpp laboratory/assessment/lines_test.cpp laboratory/assessment/proposals_test.cpp laboratory/assessment/series_test.cpp laboratory/assessment/site_tables_test.cpp laboratory/assessment/targets_test.cpp
  certificates/recomputed_test.cpp certificates/register_file_test.cpp certificates/register_processes_test.cpp
  certificates/register_test.cpp certificates/users_test.cpp
  simulation/simulate_test.cpp)
target_compile_definitions(test_engine PRIVATE NONIO_WORDS="${PROJECT_SOURCE_DIR}/templates/words"
  NONIO_TEST_PLUGINS="${CMAKE_BINARY_DIR}/${NONIO_PLUGIN_SUBDIR}")
target_include_directories(test_engine PRIVATE ${CMAKE_CURRENT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/engine ${PROJECT_SOURCE_DIR}/tests/support/builders)
add_dependencies(test_engine methods)
target_link_libraries(test_engine PRIVATE nonio_engine nonio_warnings GTest::gtest_main)
nonio_tests(test_engine)

# Measures: python3 bench/history_store.py
add_executable(bench_history ${PROJECT_SOURCE_DIR}/bench/history.cpp)
target_include_directories(bench_history PRIVATE ${PROJECT_SOURCE_DIR}/engine)
target_link_libraries(bench_history PRIVATE nonio_engine nonio_warnings)

# Measures: what each stage of a campaign costs, see docs/dev/performance.md.
add_executable(bench_campaign ${PROJECT_SOURCE_DIR}/bench/campaign.cpp)
target_include_directories(bench_campaign PRIVATE ${PROJECT_SOURCE_DIR}/engine)
target_link_libraries(bench_campaign PRIVATE nonio_engine nonio_warnings)

# Measures: memory of the plan of ten million campaigns, see docs/dev/scale.md.
add_executable(bench_plan_memory ${PROJECT_SOURCE_DIR}/bench/plan_memory.cpp)
target_include_directories(bench_plan_memory PRIVATE ${PROJECT_SOURCE_DIR}/engine)
target_link_libraries(bench_plan_memory PRIVATE nonio_engine nonio_warnings)

# The same tests on a server of their own, and what only a server can do.
add_executable(test_history_server laboratory/store/store_test.cpp laboratory/store/server_test.cpp)
target_compile_definitions(test_history_server PRIVATE NONIO_TEST_POSTGRESQL)
target_include_directories(test_history_server PRIVATE ${PROJECT_SOURCE_DIR}/engine)
target_link_libraries(test_history_server PRIVATE nonio_engine nonio_warnings GTest::gtest_main)
set_property(TARGET test_history_server PROPERTY NONIO_RUN_BY ${PROJECT_SOURCE_DIR}/tests/support/with_postgresql)
add_test(NAME history.postgresql COMMAND ${PROJECT_SOURCE_DIR}/tests/support/with_postgresql $<TARGET_FILE:test_history_server>)
set_tests_properties(history.postgresql PROPERTIES TIMEOUT 300 SKIP_RETURN_CODE 77)

# The register likewise, on one that loses nothing that it has confirmed.
add_executable(test_register_server
  certificates/register_processes_test.cpp certificates/register_server_test.cpp certificates/register_test.cpp)
target_compile_definitions(test_register_server PRIVATE NONIO_TEST_POSTGRESQL)
target_include_directories(test_register_server PRIVATE ${CMAKE_CURRENT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/engine)
target_link_libraries(test_register_server PRIVATE nonio_engine nonio_warnings GTest::gtest_main)
set_property(TARGET test_register_server PROPERTY NONIO_RUN_BY ${PROJECT_SOURCE_DIR}/tests/support/with_postgresql --durable)
add_test(NAME register.postgresql
  COMMAND ${PROJECT_SOURCE_DIR}/tests/support/with_postgresql --durable $<TARGET_FILE:test_register_server>)
set_tests_properties(register.postgresql PROPERTIES TIMEOUT 300 SKIP_RETURN_CODE 77)

nonio_by_hand(bench_history bench_campaign bench_plan_memory test_history_server test_register_server TESTS history.postgresql register.postgresql)
