# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The library's core, from bytes to scans.
tmini_add_unit_test(test_status SOURCES test_status.c)
tmini_add_unit_test(test_ring SOURCES test_ring.c)
tmini_add_unit_test(test_parser SOURCES test_parser.c LIBRARIES tmini_test_receiver)
tmini_add_unit_test(test_packet SOURCES test_packet.c LIBRARIES tmini_test_receiver)
tmini_add_unit_test(test_reply SOURCES test_reply.c)
tmini_add_unit_test(test_turn SOURCES test_turn.c)
tmini_add_unit_test(test_scan SOURCES test_scan.c LIBRARIES tmini_test_receiver)
