# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The library's core, from bytes to scans.
tmini_add_unit_test(test_names SOURCES test_names.c LIBRARIES tmini_test_rows)
tmini_add_unit_test(test_ring SOURCES test_ring.c LIBRARIES tmini_test_rows tmini_test_support)
tmini_add_unit_test(test_parser SOURCES test_parser.c
    LIBRARIES tmini_test_rows tmini_test_receiver)
tmini_add_unit_test(test_packet SOURCES test_packet.c
    LIBRARIES tmini_test_rows tmini_test_receiver)
tmini_add_unit_test(test_reply SOURCES test_reply.c LIBRARIES tmini_test_rows)
tmini_add_unit_test(test_ct SOURCES test_ct.c LIBRARIES tmini_test_rows)
tmini_add_unit_test(test_builder SOURCES test_builder.c
    LIBRARIES tmini_test_rows tmini_test_receiver)
tmini_add_unit_test(test_decoder SOURCES test_decoder.c
    LIBRARIES tmini_test_rows tmini_test_receiver)

# Optional modules.
tmini_add_unit_test(test_sectors SOURCES test_sectors.c
    LIBRARIES tmini_test_rows tmini_test_receiver)
tmini_add_unit_test(test_ranges SOURCES test_ranges.c LIBRARIES tmini_test_rows)
tmini_add_unit_test(test_mount SOURCES test_mount.c LIBRARIES tmini_test_rows)
tmini_add_unit_test(test_cartesian SOURCES test_cartesian.c)
tmini_add_unit_test(test_fields SOURCES test_fields.c
    LIBRARIES tmini_test_rows tmini_test_support)
tmini_add_unit_test(test_isolated SOURCES test_isolated.c LIBRARIES tmini_test_rows)
tmini_add_unit_test(test_time SOURCES test_time.c LIBRARIES tmini_test_rows)
tmini_add_unit_test(test_units SOURCES test_units.c)
