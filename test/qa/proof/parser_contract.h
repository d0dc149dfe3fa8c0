/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The contract of the parser's functions. proof_parser.c proves that the parser keeps it. stubs.c,
 * which replaces the parser in the driver's proofs, assumes only this contract. */

#ifndef PARSER_CONTRACT_H
#define PARSER_CONTRACT_H

#include "proof.h"

/* True if the members are equal that only init and await may change. */
bool same_expectations(const tmini_parser_t *before, const tmini_parser_t *after);

/* The contract of tmini_parser_next(), which has returned `type`. */
bool next_keeps_its_word(const tmini_parser_t *before, const tmini_parser_t *after,
                         tmini_frame_type_t type);

/* The contract of tmini_parser_skip_all() and tmini_parser_abandon(). */
bool skip_keeps_its_word(const tmini_parser_t *before, const tmini_parser_t *after);

#endif
