# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The library's core, from bytes to scans.
tmini_add_unit_test(test_names LIBRARIES tmini_test_rows)
tmini_add_unit_test(test_ring LIBRARIES tmini_test_rows tmini_test_support)
tmini_add_unit_test(test_parser LIBRARIES tmini_test_rows tmini_test_receiver)
tmini_add_unit_test(test_packet LIBRARIES tmini_test_rows tmini_test_receiver)
tmini_add_unit_test(test_reply LIBRARIES tmini_test_rows)
tmini_add_unit_test(test_ct LIBRARIES tmini_test_rows)
tmini_add_unit_test(test_builder LIBRARIES tmini_test_rows tmini_test_receiver)
tmini_add_unit_test(test_decoder LIBRARIES tmini_test_rows tmini_test_receiver)

# Optional modules.
tmini_add_unit_test(test_sectors LIBRARIES tmini_test_rows tmini_test_receiver)
tmini_add_unit_test(test_ranges LIBRARIES tmini_test_rows)
tmini_add_unit_test(test_mount LIBRARIES tmini_test_rows)
tmini_add_unit_test(test_cartesian)
tmini_add_unit_test(test_fields LIBRARIES tmini_test_rows tmini_test_support)
tmini_add_unit_test(test_isolated LIBRARIES tmini_test_rows)
tmini_add_unit_test(test_time LIBRARIES tmini_test_rows)
tmini_add_unit_test(test_units)
